#!/usr/bin/env bash
# cuda_frames_check.sh BUNDLE OUT.json TOOL.vpmg CLOUD.vpmc LEVELS COMMIT: times depth images that are prepared on an
# NVIDIA device. BUNDLE is made by scripts/bundle.sh of control-loop; CLOUD has a camera. Times a thousand queries at each level, each in a new image, from the
# image in the frames' memory to the result, or in the image before while the new one is made. Reports medians of ROUNDS
# (5) rounds, since a machine or its bus may be slow for a while. scripts/cuda_check.sh calls it.
set -euo pipefail
bundle=$1 out=$2 tool=$3 cloud=$4 levels=$5 commit=$6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

loop=("$bundle/bin/control-loop" "$tool" "$cloud" device=cuda rotate=8 queries=1000)
for ((round = 0; round < ${ROUNDS:-5}; ++round)); do
  for level in ${levels//,/ }; do
    row() { "${loop[@]}" level="$level" "${@:2}" json="$work/loop-$level-$1-$round.json" >/dev/null; }
    row none
    for behind in 0 1; do row $behind frames=counts behind=$behind; done
  done
done

python3 - "$out" "$work" "$commit" "$(dirname "$0")" <<'PYTHON'
import json, subprocess, sys
out, work, commit, scripts = sys.argv[1:]
sys.path.insert(0, scripts)
import loop_rounds
smi = subprocess.run(["nvidia-smi", "--query-gpu=name,driver_version,pcie.link.gen.max,pcie.link.width.max",
                      "--format=csv,noheader"], capture_output=True, text=True).stdout.strip().split(", ")
report = {
    "command": "scripts/cuda_frames_check.sh", "commit": commit, "device": ", ".join(smi[:2]),
    "bus": f"PCIe {smi[2]} x{smi[3]}",
    "control_loop": sorted(loop_rounds.loops_in(work),
                           key=lambda r: [r["spheres"], "frames" in r] +
                                         [r.get(key, "") for key in ("behind", "frames")]),
}
json.dump(report, open(out, "w"), indent=2)
print(f"{report['device']}, {report['bus']}, commit {commit}")
for r in report["control_loop"]:
    what = r["frames"] + (", one behind" if r["behind"] else "") if "frames" in r else "prepared"
    print(f"{r['spheres']:8} spheres  {what:18} {loop_rounds.in_words(r)}")
PYTHON
