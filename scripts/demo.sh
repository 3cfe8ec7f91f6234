#!/usr/bin/env bash
# The main job on an example that is made here: a mesh and a depth image in, penetration volume,
# force and torque out. Leaves its files and a picture in demo-output/.
set -euo pipefail
# shellcheck source=scripts/setup.sh
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_packages "${query_packages[@]}"
install_meanwhile "${packages[@]}" "${picture_packages[@]}"
build_demo

cd "$repository"
out=demo-output
mkdir -p "$out"

say "1. An example: a tool (twisted torus), a depth image of a bowl, a path into the bowl"
"$bin/make-example" "$out"

say "2. vpm-pack fills the tool with 1000 spheres that do not overlap"
"$bin/vpm-pack" "$out/tool.off" -o "$out/tool.vpmp" --spheres 1000 --report "$out/pack.json" --force

say "3. vpm-graph joins them into a tool model"
"$bin/vpm-graph" "$out/tool.vpmp" -o "$out/tool.vpmg" --report "$out/graph.json" --force

say "4. vpm-normals makes points with normals of the depth image"
"$bin/vpm-normals" "$out/depth.png" -o "$out/scene.vpmc" --intrinsics 525,525,319.5,239.5 \
  --depth-scale 5000 --report "$out/normals.json" --force

say "5. vpm-query asks at every pose of the path how much of the tool is inside the bowl's wall"
"$bin/vpm-query" --tool "$out/tool.vpmg" --cloud "$out/scene.vpmc" --poses "$out/poses.jsonl" \
  -o "$out/results.jsonl" --spheres-out "$out/spheres.csv" --stats "$out/stats.json" --force

say "6. What came out"
"$python" scripts/plot_demo.py "$out"

say "7. A page to look at"
if "$bin/vpm-query" --tool "$out/tool.vpmg" --cloud "$out/scene.vpmc" --poses "$out/poses.jsonl" \
  -o /dev/null --view "$out/demo.html" --force; then
  echo "Open $out/demo.html in a browser."
fi
