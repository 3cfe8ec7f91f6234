#!/usr/bin/env bash
# empty_root.sh [--device-code] [COMMAND ...] [--bare COMMAND ...]: runs commands in an empty Debian 12, to show that this repository
# needs nothing that happens to be installed here. By default the two commands of the README.
#
# Makes a root with mmdebstrap, or debootstrap where that is missing or fails, copies the last commit into it and ../shared beside it where
# that exists, and runs each COMMAND (a line of shell) in the copy. --device-code then lends the root this machine's CUDA, where it has
# one, and builds the device code. VPM_CCACHE=FOLDER lends the root a cache of compilers (FOLDER is made), which a COMMAND uses that
# installs ccache. VPM_PACKAGES=FOLDER copies the Debian packages there to /packages in the root. Commands after --bare run in another
# root, which is as the first one was before any command, has the packages of its build/release/packages in /packages, and what it
# has downloaded. Needs root, git, one of the two and the right to mount.
#
# Exit status: 77 where such a root cannot be made here, 1 where a command fails, 0 otherwise. The root is removed in any
# case. Mounts are made in a namespace of their own and so end with its processes, also when these are killed.
set -euo pipefail

cannot() {
  echo "empty_root.sh: an empty Debian cannot be set up here: $*" >&2
  exit 77
}

# Unpacks an empty Debian in a root: by mmdebstrap in half the time, or else by debootstrap.
bootstrap() {
  local root=$1
  if command -v mmdebstrap >/dev/null; then
    if timeout 900 mmdebstrap --variant=apt bookworm "$root"; then return; fi
    echo "mmdebstrap failed; debootstrap is tried"
    find "$root" -mindepth 1 -delete
  fi
  timeout 900 debootstrap --variant=minbase bookworm "$root"
}

# Mounts what programs expect in a root: processes; the kernel's settings, without which glibc takes no memory in large pages; and
# pseudo-terminals, without which tests of what asks whether somebody sits before it are skipped.
mount_in() {
  local root=$1
  mount -t proc proc "$root/proc" || return
  mount -t sysfs -o ro sysfs "$root/sys" || true
  mkdir -p "$root/dev/pts"
  if mount -t devpts -o newinstance,ptmxmode=0666,mode=620 devpts "$root/dev/pts"; then ln -sf pts/ptmx "$root/dev/ptmx"; fi
}

# Fills the root with an empty Debian and the copy. Runs in the namespaces.
fill() {
  local root=$1 repository=$2
  # In memory, where that is plenty: packages unpack faster, and the root is gone at once.
  local available
  available=$(awk '/^MemAvailable:/ { print int($2 / 1048576) }' /proc/meminfo)
  if ((${available:-0} >= 16)); then mount -t tmpfs -o size=10g,mode=755 none "$root" || true; fi
  echo "== Setting up an empty Debian 12 in $root"
  if ! bootstrap "$root" >"$root.log" 2>&1; then
    tail -n 20 "$root.log" >&2
    cannot "no Debian could be unpacked; the end of what was said stands above"
  fi
  chmod 755 "$root"  # as on a machine: other users than root may enter
  mount_in "$root" || cannot "$root/proc cannot be mounted"
  # Packages unpack faster without syncing, for the root does not outlive this script, and without what nobody reads here
  # but vpm's own examples, which debian_packages.sh builds.
  printf '%s\n' force-unsafe-io path-exclude=/usr/share/{doc,man,locale}/'*' 'path-include=/usr/share/doc/vpm/*' >"$root/etc/dpkg/dpkg.cfg.d/fast"
  echo 'Acquire::Retries "3";' >"$root/etc/apt/apt.conf.d/retries"
  if [[ -n ${VPM_CCACHE:-} ]]; then
    mkdir -p "$VPM_CCACHE" "$root/root/.cache/ccache"
    mount --bind "$VPM_CCACHE" "$root/root/.cache/ccache" || cannot "$VPM_CCACHE cannot be mounted"
  fi
  if [[ -n ${VPM_PACKAGES:-} ]]; then
    mkdir "$root/packages"
    cp "$VPM_PACKAGES"/*.deb "$root/packages/"
  fi
  mkdir -p "$root/src/vpm"
  git -c safe.directory='*' -C "$repository" archive HEAD | tar -x -C "$root/src/vpm" || cannot "git has no commit of $repository"
  if [[ -d $repository/../shared ]]; then
    mkdir "$root/src/shared"
    cp -a "$repository/../shared/." "$root/src/shared/"
  fi
}

# Runs a command in the copy, with the environment of a machine that has just been set up.
run() {
  local root=$1 command=$2 network=() name
  for name in http_proxy https_proxy no_proxy; do
    if [[ -n ${!name:-} ]]; then network+=("$name=${!name}"); fi
  done
  echo
  echo "== $command"
  local start=$SECONDS
  env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/root "${network[@]}" \
    chroot "$root" sh -c "cd /src/vpm || exit; $command" || {
    echo "empty_root.sh: in an empty Debian this fails: $command" >&2
    exit 1
  }
  echo "== $command: good, $((SECONDS - start)) s"
}

# Keeps a copy of a root in its folder bare, without what is mounted in it.
keep_bare() {
  mkdir "$1/bare"
  tar -C "$1" --one-file-system --exclude=./bare -cf - . | tar -C "$1/bare" -xf -
}

# Completes the copy by what the commands in the root have left for it.
furnish_bare() {
  local root=$1 folder
  mount_in "$root/bare"
  for folder in var/cache/apt var/lib/apt/lists; do mount --bind "$root/$folder" "$root/bare/$folder"; done
  mkdir -p "$root/bare/packages"
  cp "$root/src/vpm/build/release/packages/"*.deb "$root/bare/packages/"
}

# Builds the device code and its tests, with the CUDA of this machine.
build_device_code() {
  local root=$1 nvcc cuda
  nvcc=$(command -v nvcc || echo /usr/local/cuda/bin/nvcc)
  cuda=$(dirname "$(dirname "$(readlink -f "$nvcc")")")
  if [[ ! -x $cuda/bin/nvcc || ! -d $cuda/nvvm/libdevice ]]; then
    echo "== There is no CUDA here in a folder of its own that the root could be lent: the device code is not built"
    return
  fi
  mkdir -p "$root/usr/local/cuda"
  mount --rbind "$cuda" "$root/usr/local/cuda"
  mount -o remount,bind,ro "$root/usr/local/cuda"
  run "$root" "cmake --preset release -DVPM_CUDA=ON -DCMAKE_CUDA_COMPILER=/usr/local/cuda/bin/nvcc \
-DCMAKE_CUDA_ARCHITECTURES=75-virtual && cmake --build --preset release --target device_code"
}

if [[ ${1:-} == --inside ]]; then  # this script, called by itself
  root=$2 device_code=$3 repository=$4
  shift 4
  fill "$root" "$repository"
  current=$root
  for command in "$@"; do
    if [[ $command == --bare ]]; then keep_bare "$root"; fi
  done
  for command in "$@"; do
    if [[ $command != --bare ]]; then
      run "$current" "$command"
      continue
    fi
    furnish_bare "$root"
    current=$root/bare
  done
  if [[ $device_code == yes ]]; then build_device_code "$root"; fi
  exit
fi

device_code=no
if [[ ${1:-} == --device-code ]]; then
  device_code=yes
  shift
fi
if [[ $# -eq 0 ]]; then set -- scripts/demo.sh scripts/test.sh; fi
[[ $(id -u) -eq 0 ]] || cannot "that takes root"
command -v mmdebstrap debootstrap >/dev/null || cannot "neither mmdebstrap nor debootstrap is installed"
for tool in git unshare; do
  command -v $tool >/dev/null || cannot "$tool is not installed"
done
namespaces=(unshare --mount --pid --fork --kill-child)
"${namespaces[@]}" true 2>/dev/null || cannot "mount namespaces are not allowed"

# Ends what still runs and removes the root. Processes that were killed may need a moment to end.
# shellcheck disable=SC2317  # the trap calls it
clean_up() {
  local attempt
  if [[ -n $child ]]; then kill -KILL "$child" || true; fi
  for attempt in 1 2 3 4 5; do
    if rm -rf --one-file-system "$root" "$root.log" 2>/dev/null; then return; fi
    sleep "$attempt"
  done
  echo "empty_root.sh: cannot remove $root" >&2
}
root=$(mktemp -d "${TMPDIR:-/tmp}/vpm-empty-root.XXXXXX")
child=
trap clean_up EXIT
trap 'exit 129' HUP
trap 'exit 130' INT
trap 'exit 143' TERM
repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"${namespaces[@]}" "${BASH_SOURCE[0]}" --inside "$root" $device_code "$repository" "$@" &  # signals interrupt wait, not a command
child=$!
status=0
wait "$child" || status=$?
child=
exit $status
