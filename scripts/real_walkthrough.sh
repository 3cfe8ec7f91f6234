#!/usr/bin/env bash
# Does the main job on real input: moves each tool along a path into every scene of a data folder.
#
# usage: scripts/real_walkthrough.sh [DATA_FOLDER [OUTPUT_FOLDER]]
#
# DATA_FOLDER (default ../shared/data) holds meshes/bunny.off, meshes/franka_fer_link5.stl and
# depth/ with the RedKitchen sequence, tum_desk_depth.png, two D435 frames (EXR) and a Kinect PCD.
# Checks every result and draws them; exit code 1 if one check fails.
set -euo pipefail
# shellcheck source=scripts/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

data=$(realpath "${1:-$repository/../shared/data}")
out=${2:-$repository/demo-output/real}

install_packages "${packages[@]}" "${picture_packages[@]}"
build_demo
mkdir -p "$out"

say "Tools: vpm-pack, then vpm-graph"
for mesh in bunny.off franka_fer_link5.stl; do
  name=${mesh%.*}
  "$bin/vpm-pack" "$data/meshes/$mesh" -o "$out/$name.vpmp" --spheres 1000 \
    --export "$out/$name.pack.csv" --report "$out/$name.pack.json" --quiet --force
  "$bin/vpm-graph" "$out/$name.vpmp" -o "$out/$name.vpmg" --report "$out/$name.graph.json" \
    --quiet --force
done

say "Scenes: vpm-normals"
scene() {  # name, depth image or cloud, options
  local name=$1 input=$2
  shift 2
  "$bin/vpm-normals" "$data/depth/$input" -o "$out/$name.vpmc" --report "$out/$name.normals.json" \
    --export "$out/$name.ply" --quiet --force "$@"
  echo "$name: $input"
}
for depth in "$data"/depth/redkitchen_seq/frame-*.depth.png; do
  frame=$(basename "$depth" .depth.png)
  scene "redkitchen-${frame#frame-}" "redkitchen_seq/$frame.depth.png" \
    --intrinsics 585,585,320,240 --depth-scale 1000
done
scene tum-desk tum_desk_depth.png --intrinsics 525,525,319.5,239.5 --depth-scale 5000
scene d435-transparent d435_000000080-transparent-depth-img.exr --intrinsics 921,921,642,359
scene d435-opaque d435_000000080-opaque-depth-img.exr --intrinsics 921,921,642,359
scene kinect-pcd kinect_capture0001.pcd

say "Queries: a path of 121 poses into every scene, with both measures"
exec "$python" "$repository/scripts/walk_into_scenes.py" "$bin/vpm-query" "$out"
