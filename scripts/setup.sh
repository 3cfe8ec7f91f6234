# shellcheck shell=bash
# Sourced by the other scripts: installs what is missing and builds the release preset into
# build/release. Needs no root where everything is installed.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck disable=SC2034  # used by the scripts that source this one
bin=$repository/build/release/bin
# Debian's Python, which has Debian's matplotlib; another one may stand before it in the PATH.
python=/usr/bin/python3

packages=(
  g++ cmake ninja-build
  libcli11-dev nlohmann-json3-dev libxxhash-dev libtbb-dev libpng-dev libopenexr-dev
  libopenmesh-dev libopenvdb-dev libblosc-dev libboost-iostreams-dev zlib1g-dev libgtest-dev
  python3 python3-numpy python3-matplotlib python3-jsonschema
)

say() { printf '\n== %s\n' "$*"; }

is_installed() {
  [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

install_missing() {
  local missing=() package as_root=()
  if ! command -v dpkg-query >/dev/null; then
    echo "This is not Debian: install these packages' counterparts yourself: ${packages[*]}" >&2
    return 0
  fi
  for package in "${packages[@]}"; do
    is_installed "$package" || missing+=("$package")
  done
  if [ ${#missing[@]} -eq 0 ]; then
    say "Everything that vpm needs is installed"
    return 0
  fi
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "Missing: ${missing[*]}" >&2
      echo "Run as root: apt-get install --no-install-recommends ${missing[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  say "Installing ${missing[*]}"
  "${as_root[@]}" apt-get update -q
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}"
}

# Where there is nvcc: machine code for this machine's device only, or, without one, what any driver makes machine code of
# when it is first needed. Code for all that CMakeLists.txt names takes nvcc five times as long, or ten.
cuda_options() {
  command -v nvcc >/dev/null || return 0
  if nvidia-smi >/dev/null 2>&1; then echo -DCMAKE_CUDA_ARCHITECTURES=native; else echo -DCMAKE_CUDA_ARCHITECTURES=75-virtual; fi
}

build() {
  local options
  mapfile -t options < <(cuda_options)
  if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  say "Building into build/release (the first time takes some minutes)"
  (cd "$repository" &&
    cmake --preset release -DPython3_EXECUTABLE="$python" "${options[@]}" &&
    cmake --build --preset release --parallel "$(nproc)")
}
