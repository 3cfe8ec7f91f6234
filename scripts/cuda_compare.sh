#!/usr/bin/env bash
# cuda_compare.sh BEFORE AFTER OUT.json TOOL.vpmg LEVELS CLOUD.vpmc ...: times two builds on an NVIDIA device, side by side.
# Exit code 1 if they answer a path's poses differently: each field that BEFORE writes must be AFTER's too.
#
# BEFORE and AFTER are made by scripts/bundle.sh of control-loop and vpm-query; LEVELS are like 1000,17000. For each cloud
# and level, the two builds take turns in ROUNDS (5) rounds, in which either begins: ten thousand queries of one tool, ten
# thousand with eight tools and clouds in turn so that caches do not help, and poses in batches of the sizes BATCHES (16384),
# a hundred thousand of the largest. PLACES are the poses (path, clutter; control-loop's at=). Reports the medians of the
# rounds and AFTER's time over BEFORE's, with the range of that ratio over the rounds.
set -euo pipefail
before=$1 after=$2 out=$3 tool=$4 levels=$5
shift 5
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

row() {  # NAME option=value ...: times a row with both builds, in odd rounds the other one first
  local order="before after"
  ((round % 2 == 0)) || order="after before"
  for build in $order; do
    local folder=${!build}
    "$folder/bin/control-loop" "$tool" "$cloud" device=cuda level="$level" "${@:2}" json="$work/$build-$1.json" >/dev/null
  done
}
answers_alike() {  # compares the answers of both builds to the poses of one path
  "$after/bin/control-loop" "$tool" "$cloud" device=cpu level="$level" queries=1 poses="$work/poses.jsonl" path=400 >/dev/null
  for build in before after; do
    local folder=${!build}
    "$folder/bin/vpm-query" --tool "$tool" --cloud "$cloud" --quiet --force --level "$level" --device cuda \
      --poses "$work/poses.jsonl" -o "$work/$build.jsonl"
  done
  python3 - "$work/before.jsonl" "$work/after.jsonl" <<'PYTHON'
import json, sys
before, after = ([json.loads(line) for line in open(path)] for path in sys.argv[1:])
alike = len(before) == len(after) and all(a.get(key) == b[key] for b, a in zip(before, after) for key in b)
sys.exit(not (before and alike))
PYTHON
}

for cloud in "$@"; do
  for level in ${levels//,/ }; do
    answers_alike || { echo "$cloud, $level spheres: the answers differ" >&2; failed=1; }
    for ((round = 0; round < ${ROUNDS:-5}; ++round)); do
      for at in ${PLACES:-path}; do
        name=$(basename "$cloud" .vpmc)-$level
        places=()
        if [[ $at != path ]]; then name+=-$at places=(at="$at"); fi
        row "$name-one-$round" queries=10000 "${places[@]}"
        row "$name-eight-$round" rotate=8 queries=10000 "${places[@]}"
        for size in ${BATCHES:-16384}; do
          row "$name-batch$size-$round" batch="$size" queries=$((16384 + 6 * size)) "${places[@]}"
        done
      done
    done
  done
done

python3 - "$out" "$work" "$failed" <<'PYTHON'
import collections, glob, json, os, statistics, subprocess, sys
out, work, failed = sys.argv[1:]
smi = subprocess.run(["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"], capture_output=True, text=True)
rows = collections.defaultdict(lambda: collections.defaultdict(list))
for path in sorted(glob.glob(f"{work}/after-*.json")):
    name = os.path.basename(path)[len("after-"):].rsplit("-", 1)[0]
    for build in ("before", "after"):
        with open(path.replace("/after-", f"/{build}-")) as file:
            rows[name][build].append(json.load(file))
report = {"command": "scripts/cuda_compare.sh", "device": smi.stdout.strip(), "same_answers": failed == "0", "rows": []}
for name, builds in rows.items():
    figures = {}
    # A batch is told by its poses a second, whose ratio is turned round: a larger one is slower, as with times.
    for key in ["poses_per_second"] if "-batch" in name else ["median_us", "p99_us"]:
        before, after = ([report[key] for report in builds[build]] for build in ("before", "after"))
        ratios = [b / a if key == "poses_per_second" else a / b for b, a in zip(before, after)]
        figures[key] = {"before": statistics.median(before), "after": statistics.median(after),
                        "ratio": statistics.median(ratios), "ratio_range": [min(ratios), max(ratios)]}
    report["rows"].append({"row": name} | figures)
    told = [f"{key} {f['before']:.1f} -> {f['after']:.1f}, time x {f['ratio']:.3f} ({f['ratio_range'][0]:.3f} to {f['ratio_range'][1]:.3f})"
            for key, f in figures.items()]
    print(f"{name:28} " + "; ".join(told))
with open(out, "w") as file:
    json.dump(report, file, indent=2)
print(f"{report['device']}: the answers are {'the same' if report['same_answers'] else 'NOT the same'}")
PYTHON
exit $failed
