#!/usr/bin/env bash
# cuda_report.sh OUT DATA [BUNDLE COMMIT]: measures all results on NVIDIA devices in one call. Builds, packs
# DATA/meshes/bunny.off with a hundred thousand and a million spheres, makes the cloud, checks and times, and replays
# the stream recorded in DATA. Writes cuda.json, cuda_frames.json, cuda_frames_million.json, scaling.json,
# tradeoff.json, replay.json and, with several devices, cuda_devices.json to OUT. On a machine that cannot build, BUNDLE
# is made elsewhere by scripts/bundle.sh of the programs named below, at COMMIT. Takes a quarter of an hour on an H100,
# without the build. Exit code 1 if anything differs from the CPU.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
if [[ $# -ne 2 && $# -ne 4 ]]; then
  echo "usage: cuda_report.sh OUT DATA [BUNDLE COMMIT]" >&2
  exit 2
fi
out=$1 data=$2 bundle=${3:-} commit=${4:-}
nvidia-smi -L 2>/dev/null || { echo "cuda_report.sh: no NVIDIA device, or no driver for it" >&2; exit 3; }
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [[ -z $bundle ]]; then
  # shellcheck source=scripts/setup.sh
  . "$here/setup.sh"
  command -v nvcc >/dev/null || { echo "cuda_report.sh: nvcc is not in the PATH; give a BUNDLE" >&2; exit 3; }
  install_missing
  build
  bundle=$work/bundle
  "$here/bundle.sh" "$repository/build/release" "$bundle" vpm-pack vpm-graph vpm-normals vpm-query vpm-bench control-loop \
    make-example cuda_tests
  commit=$(git -C "$repository" rev-parse --short HEAD)
fi

tool() {  # SPHERES LEVELS
  "$bundle/bin/vpm-pack" "$data/meshes/bunny.off" --spheres "$1" -o "$work/$1.vpmp" --quiet
  "$bundle/bin/vpm-graph" "$work/$1.vpmp" ${2:+--levels "$2"} -o "$work/$1.vpmg" --quiet
}
tool 100000 1000,17000
tool 1000000 ""
mkdir "$work/example"
"$bundle/bin/make-example" "$work/example" tilted-wall >/dev/null
cloud=$work/cloud.vpmc
"$bundle/bin/vpm-normals" "$work/example/depth.png" --intrinsics 525,525,319.5,239.5 --depth-scale 5000 -o "$cloud" --quiet

failed=0
"$here/cuda_check.sh" "$bundle" "$out/cuda.json" "$work/100000.vpmg" "$cloud" 1000,17000,100000 "$commit" || failed=1
ROUNDS=1 "$here/cuda_frames_check.sh" "$bundle" "$out/cuda_frames_million.json" "$work/1000000.vpmg" "$cloud" 1000000 "$commit" || failed=1
if [[ $(nvidia-smi -L | wc -l) -gt 1 ]]; then
  "$here/cuda_devices_check.sh" "$bundle" "$out/cuda_devices.json" "$work/100000.vpmg" "$cloud" 1000,17000,100000 "$commit" || failed=1
fi
"$bundle/bin/vpm-bench" scaling --all --out "$out" || failed=1
"$bundle/bin/vpm-bench" tradeoff --device cuda --out "$out" || failed=1
"$bundle/bin/vpm-bench" replay --device cuda --data "$data" --out "$out" || failed=1
exit $failed
