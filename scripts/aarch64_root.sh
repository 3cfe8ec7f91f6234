#!/usr/bin/env bash
# aarch64_root.sh FOLDER: unpacks Debian's arm64 packages that the query path needs, and writes a CMake toolchain file
# for aarch64-linux-gnu-g++, for scripts/same_bits.sh. Needs g++-aarch64-linux-gnu and qemu-user, and once before `dpkg
# --add-architecture arm64; apt-get update`.
set -euo pipefail
root=$(mkdir -p "$1" && cd "$1" && pwd)
packages=(libc6 libgcc-s1 libstdc++6 libtbb-dev libtbb12 libtbbmalloc2 libtbbbind-2-5 libpng-dev libpng16-16 zlib1g-dev zlib1g
  libxxhash-dev libxxhash0 libgtest-dev)
headers=(nlohmann-json3-dev libcli11-dev)  # for any architecture

mkdir -p "$root/packages"
cd "$root/packages"
apt-get download "${packages[@]/%/:arm64}" "${headers[@]}"
for package in *.deb; do dpkg -x "$package" "$root"; done
if [[ ! -L $root/lib ]]; then
  cp -a "$root/lib/." "$root/usr/lib/"
  rm -r "${root:?}/lib"
  ln -s usr/lib "$root/lib"
fi

libraries=$root/usr/lib/aarch64-linux-gnu
cat >"$root/toolchain.cmake" <<CMAKE
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH $root)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CXX_FLAGS_INIT "-isystem $root/usr/include -isystem $root/usr/include/aarch64-linux-gnu")
foreach(kind EXE SHARED)
  set(CMAKE_\${kind}_LINKER_FLAGS_INIT "-L$libraries -Wl,-rpath-link,$libraries")
endforeach()
CMAKE
