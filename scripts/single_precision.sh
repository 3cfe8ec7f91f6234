#!/usr/bin/env bash
# single_precision.sh TOOL.vpmg CLOUD.vpmc LEVELS OUT.json: what the refined measure would save, and how much it would differ,
# in single precision. Compiles the query path a second time with float for double and asks both by turns, on one thread,
# without counting points. Needs a release build (BUILD, default build/release). LEVELS are like 1000,17000.
set -euo pipefail
repository=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tool=$1 cloud=$2 levels=$3 out=$4
build=${BUILD:-$repository/build/release}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

python3 "$repository/scripts/single_precision/to_single.py" "$repository" "$work"
from=$work/libvpm_single
sources=("$from"/core/{parallel,parallel_region,pose}.cpp "$from"/cloud/{cloud,kd_tree,padded_image,row_bands,scattered_points}.cpp
  "$from"/model/{tool_model,tool_model_check}.cpp)
for source in "$from"/{device,surface,query}/*.cpp; do
  case $(basename "$source") in depth_frames.cpp | frame_preparation.cpp | frame_slot_unavailable.cpp) ;; *) sources+=("$source") ;; esac
done
c++ -std=c++20 -O3 -DNDEBUG -ffp-contract=off -fno-math-errno -fno-trapping-math -w -DVPM_VERSION='"single"' \
  -I"$work" -I"$repository" "$repository"/{scripts/single_precision/compare,tools/bench/statistics}.cpp "${sources[@]}" \
  -L"$build/lib" -Wl,-rpath,"$build/lib" -lvpm -ltbb -o "$work/compare"
"$build/bin/control-loop" "$tool" "$cloud" device=cpu queries=1 poses="$work/poses.jsonl" path=400 >"$work/log"
"$work/compare" "$tool" "$cloud" "$work/poses.jsonl" "$levels" >"$work/results.json"

python3 - "$work/results.json" "$out" "$(git -C "$repository" rev-parse --short=12 HEAD)" <<'PYTHON'
import json, os, re, sys
results, out, commit = sys.argv[1:]
processor = re.search(r"model name\s*:\s*(.*)", open("/proc/cpuinfo").read())
report = {"command": "scripts/single_precision.sh", "commit": commit,
          "machine": {"cores": os.cpu_count(), "processor": processor.group(1) if processor else "unknown"},
          "results": json.load(open(results))}
json.dump(report, open(out, "w"), indent=2)
for r in report["results"]:
    ratio = r["single"]["median_us"] / r["double"]["median_us"]
    print(f"{r['spheres']:>8} spheres: {ratio:.2f} of the time of double, volume differs by {r['volume_difference']:.1e} of the tool")
PYTHON
