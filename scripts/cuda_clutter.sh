#!/usr/bin/env bash
# cuda_clutter.sh BUNDLE OUT.json TOOL.vpmg LEVELS COMMIT CLOUD.vpmc ...: times a bundle in clutter on a machine with an NVIDIA
# device, where poses take very different times. Exit code 1 if the device's answers differ from the CPU's by a byte.
#
# BUNDLE is made by scripts/bundle.sh of control-loop and vpm-query; LEVELS are like 1000,17000; the clouds have cameras. For each
# cloud and level: 400 random poses about points of the cloud on CPU and device; then, in ROUNDS (3) rounds, four thousand queries
# one by one, and poses in batches of the sizes BATCHES. Reports medians of the rounds. The published results use the bunny by
# `vpm-pack bunny.off --scale 1.6047 --spheres 17000` (.25 m) and the recorded images that vpm-bench knows by name.
set -euo pipefail
bundle=$1 out=$2 tool=$3 levels=$4 commit=$5
shift 5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
for cloud in "$@"; do
  for level in ${levels//,/ }; do
    name=$(basename "$cloud" .vpmc)-$level
    loop=("$bundle/bin/control-loop" "$tool" "$cloud" level="$level" at=clutter)
    "${loop[@]}" device=cpu queries=1 poses="$work/poses.jsonl" path=400 >/dev/null
    for device in cpu cuda; do
      "$bundle/bin/vpm-query" --tool "$tool" --cloud "$cloud" --quiet --force --level "$level" --device $device --batch 100 \
        --poses "$work/poses.jsonl" -o "$work/$device.jsonl"
    done
    cmp "$work/cpu.jsonl" "$work/cuda.jsonl" || { echo "$name spheres: the answers differ" >&2; failed=1; }
    for ((round = 0; round < ${ROUNDS:-3}; ++round)); do
      "${loop[@]}" device=cuda queries=4000 json="$work/loop-$name-$round.json" >/dev/null
      for size in ${BATCHES:-4 16 64 256 1024 4096 16384}; do
        "${loop[@]}" device=cuda batch="$size" queries=$((8192 + 2 * size)) json="$work/batch-$name-$size-$round.json" >/dev/null
      done
    done
  done
done

python3 - "$out" "$work" "$commit" "$failed" "$(dirname "$0")" "$levels" "$@" <<'PYTHON'
import glob, json, os, statistics, sys
out, work, commit, failed, scripts, levels, *clouds = sys.argv[1:]
sys.path.insert(0, scripts)
import loop_rounds
def load(pattern):
    return [json.load(open(path)) for path in sorted(glob.glob(f"{work}/{pattern}"))]
report = {"command": "scripts/cuda_clutter.sh", "commit": commit, "device": loop_rounds.device(), "same_bytes_as_cpu": failed == "0", "rows": []}
for cloud in clouds:
    scene = os.path.basename(cloud).removesuffix(".vpmc")
    for level in map(int, levels.split(",")):
        name = f"{scene}-{level}"
        single = loop_rounds.of_rounds(load(f"loop-{name}-*.json"))
        rates = {}
        for batch in load(f"batch-{name}-*.json"):
            rates.setdefault(batch["batch"], []).append(batch["poses_per_second"])
        report["rows"].append({"scene": scene, "spheres": level, "single": single,
                               "batches": [{"batch": size, "poses_per_second": statistics.median(rates[size])} for size in sorted(rates)]})
        print(f"{name:16} {loop_rounds.in_words(single)}; us a pose in batches:",
              *(f"{size}: {1e6 / statistics.median(rates[size]):.1f}" for size in sorted(rates)))
with open(out, "w") as file:
    json.dump(report, file, indent=2)
print(f"{report['device']}: the answers are {'the same' if report['same_bytes_as_cpu'] else 'NOT the same'}")
PYTHON
exit $failed
