# shellcheck shell=bash
# Sourced by the other scripts: installs what is missing and builds in build/release. Needs no root where everything is
# installed.

repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck disable=SC2034  # used by the scripts that source this one
bin=$repository/build/release/bin
# Debian's Python, which has Debian's matplotlib; another one may stand before it in the PATH.
python=/usr/bin/python3

# What the library of queries is built with, and all that the demo takes.
query_packages=(g++ cmake ninja-build python3 libcli11-dev nlohmann-json3-dev libxxhash-dev libtbb-dev libpng-dev zlib1g-dev
  liblz4-dev libzstd-dev)
packages=(
  "${query_packages[@]}"
  libopenexr-dev libtiff-dev libyaml-cpp-dev
  libopenmesh-dev libglu1-mesa-dev libassimp-dev libexpat1-dev liburdfdom-dev
  libjs-three
)
# What the demo does without: also voxels, for the headers of OpenVDB and what they need are a quarter of a gigabyte.
test_packages=(
  libgtest-dev pkg-config pybind11-dev libdlpack-dev python3-dev
  libopenvdb-dev libblosc-dev libboost-iostreams-dev
)
# What nothing is built with: pictures and tables of scripts are made by the first, and tests run all of them.
picture_packages=(python3-numpy python3-matplotlib)
test_run_packages=("${picture_packages[@]}" python3-jsonschema python3-pytest python3-venv)

say() { printf '\n== %s\n' "$*"; }

is_installed() {
  [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# Installs those of the packages given that are missing.
install_packages() {
  local missing=() package as_root=()
  if ! command -v dpkg-query >/dev/null; then
    echo "This is not Debian: install these packages' counterparts yourself: $*" >&2
    return 0
  fi
  for package in "$@"; do
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

# Installs all that is missing for programs and tests.
install_missing() {
  install_packages "${packages[@]}" "${test_packages[@]}" "${test_run_packages[@]}"
}

# Installs packages while what follows goes on, until wait_for_packages. Who is not root may be asked for a password, so it is
# done at once then.
install_meanwhile() {
  installing=
  if [ "$(id -u)" -ne 0 ]; then
    install_packages "$@"
    return
  fi
  install_log=$(mktemp)
  install_packages "$@" >"$install_log" 2>&1 </dev/null &
  installing=$!
}

# Waits for the packages of install_meanwhile; shows what was said where they cannot be installed.
wait_for_packages() {
  if [ -z "${installing:-}" ]; then return; fi
  local status=0
  wait "$installing" || status=$?
  installing=
  if [ $status -ne 0 ]; then cat "$install_log" >&2; fi
  rm -f "$install_log"
  return $status
}

# Prints CMake's options for device code where there is nvcc: machine code for this machine's device only, or, without a device,
# PTX, which a driver compiles when it is first needed. All architectures of CMakeLists.txt take nvcc five to ten times as long.
cuda_options() {
  command -v nvcc >/dev/null || return 0
  if nvidia-smi >/dev/null 2>&1; then echo -DCMAKE_CUDA_ARCHITECTURES=native; else echo -DCMAKE_CUDA_ARCHITECTURES=75-virtual; fi
}

# Configures build/release with the options given.
configure() {
  local options=(-DPython3_EXECUTABLE="$python" "$@")
  if command -v ccache >/dev/null; then
    # Sources with precompiled headers are kept, too, of which g++ must name the header in its preprocessed text.
    options+=("-DCMAKE_CXX_COMPILER_LAUNCHER=env;CCACHE_SLOPPINESS=pch_defines,time_macros;ccache")
    if [[ -z ${CXX:-} ]]; then options+=("-DCMAKE_CXX_FLAGS=${CXXFLAGS:-} -fpch-preprocess"); fi
  fi
  # Where there is mold, it links: thirty programs of the tests take a second each otherwise.
  if command -v mold >/dev/null; then options+=(-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=mold -DCMAKE_SHARED_LINKER_FLAGS=-fuse-ld=mold); fi
  (cd "$repository" && cmake --preset release "${options[@]}")
}

# Builds the targets given in build/release, or all.
build_targets() {
  (cd "$repository" && cmake --build --preset release --parallel "$(nproc)" ${1:+--target "$@"})
}

# Options of a build without tests.
alone=(-DVPM_BENCH=OFF -DVPM_TESTS=OFF -DVPM_CUDA=OFF)

# Builds the library of queries in a new build folder, which needs query_packages alone, while install_meanwhile goes on, and
# waits for that. Sets `more` to the options that the rest needs then.
build_queries_meanwhile() {
  more=()
  if [ ! -e "$repository/build/release/build.ninja" ]; then
    configure "${alone[@]}" -DVPM_SOLID=OFF -DVPM_EXR=OFF
    build_targets vpm
    more=(-DVPM_SOLID=ON -DVPM_EXR=ON)
  fi
  wait_for_packages
}

# Builds everything: programs, benchmarks and tests, with device code where there is nvcc, and the Python module where there is
# pybind11.
build() {
  local more device
  say "Building into build/release (the first time takes some minutes)"
  build_queries_meanwhile
  mapfile -t device < <(cuda_options)
  if is_installed pybind11-dev && is_installed libdlpack-dev; then more+=(-DVPM_PYTHON=ON); fi
  configure -DVPM_CUDA=AUTO "${device[@]}" "${more[@]}"
  build_targets
}

# Builds the four tools and the program that makes the demo's example. A new build folder is configured for these alone; one
# that has tests or device code keeps them.
build_demo() {
  local more
  say "Building into build/release (the first time takes some minutes)"
  build_queries_meanwhile
  if [ ${#more[@]} -gt 0 ]; then configure "${alone[@]}" "${more[@]}"; fi
  build_targets demo_programs
}
