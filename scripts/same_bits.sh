#!/usr/bin/env bash
# Builds the query path with each compiler and set of flags, replays 2016 queries with each build, and compares the
# bytes with those of the first build and their hash with the recorded one. Compilers that are not installed are skipped
# and named. COMPILERS names them, by default "g++ clang++". Builds go to build/same-bits, or to SAME_BITS_DIR.
# aarch64-linux-gnu-g++ builds against Debian's arm64 packages, unpacked in AARCH64_ROOT by scripts/aarch64_root.sh, and
# qemu-aarch64 runs the result.
set -euo pipefail
repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
trees=${SAME_BITS_DIR:-$repository/build/same-bits}
flag_sets=("-O0" "-O2" "-O3 -march=native")

recorded=$(cat "$repository/tests/query/replay.hash")
mkdir -p "$trees"
compared=0 different=0 first=

replay() {  # compiler, flags
  local name tree run=() cross=()
  if [[ $1 == aarch64-* ]]; then
    cross=(--toolchain "${AARCH64_ROOT:?says where scripts/aarch64_root.sh has unpacked}/toolchain.cmake")
    run=(qemu-aarch64 -L "$AARCH64_ROOT")
  fi
  name=$(printf '%s%s' "$1" "$2" | tr -c 'a-zA-Z0-9\n' '_')
  tree=$trees/$name
  { cmake -S "$repository" -B "$tree" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$1" \
    -DCMAKE_CXX_FLAGS_RELEASE="$2 -DNDEBUG" -DVPM_SOLID=OFF -DVPM_EXR=OFF -DVPM_TESTS=ON -DVPM_CUDA=OFF "${cross[@]}" >"$tree.log" 2>&1 &&
    cmake --build "$tree" --target vpm-replay >>"$tree.log" 2>&1; } || {
    echo "FAILED to build with $1 $2; the log is $tree.log" >&2
    exit 1
  }
  local hash verdict=same
  hash=$("${run[@]}" "$tree/bin/vpm-replay" "$tree.bytes")
  [[ -n $first ]] || first=$tree.bytes
  if ! cmp -s "$first" "$tree.bytes" || [[ $hash != "$recorded" ]]; then
    verdict=DIFFERENT different=$((different + 1))
  fi
  compared=$((compared + 1))
  printf '%-10s %-20s %s %s\n' "$1" "$2" "$hash" "$verdict"
}

for compiler in ${COMPILERS:-g++ clang++}; do
  if ! command -v "$compiler" >/dev/null; then
    printf '%-10s SKIPPED: it is not installed\n' "$compiler"
    continue
  fi
  for flags in "${flag_sets[@]}"; do
    [[ $compiler == aarch64-* && $flags == *native* ]] && flags=-O3  # the building machine's processor does not matter here
    replay "$compiler" "$flags"
  done
done
echo "$compared builds compared, $different different from the first or from tests/query/replay.hash ($recorded)"
[[ $compared -gt 0 && $different -eq 0 ]]
