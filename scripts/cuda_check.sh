#!/usr/bin/env bash
# cuda_check.sh BUNDLE OUT.json TOOL.vpmg CLOUD.vpmc LEVELS COMMIT: checks a bundle on a machine with an NVIDIA device,
# and times it. Exit code 1 if anything differs.
#
# BUNDLE is made by scripts/bundle.sh of control-loop, cuda_tests, vpm-bench and
# vpm-query. LEVELS are like 1000,17000. The published results use bunny.off by `vpm-pack --spheres 100000` and
# `vpm-graph --levels 1000,17000`, and the image of `make-example FOLDER tilted-wall` by `vpm-normals --intrinsics
# 525,525,319.5,239.5 --depth-scale 5000`.
#
# Steps: (1) runs every test of tests/cuda; (2) runs small queries under compute-sanitizer's four tools;
# (3) compares the results of CPU and device byte for byte along one path,
# one by one and in batches, and compares the results of vpm-bench's suites; (4) times ten thousand queries
# at each level, with eight tools and clouds taking turns, in ROUNDS (5) rounds, and reports
# medians; (5) times a hundred thousand poses in batches, of one tool and of eight; (6) calls
# scripts/cuda_frames_check.sh, which writes OUT_frames.json.
set -euo pipefail
bundle=$1 out=$2 tool=$3 cloud=$4 levels=$5 commit=$6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
verdict() { if "$@" >"$work/log" 2>&1; then echo pass; else tail -20 "$work/log" >&2; echo FAIL; fi; }

run_tests() { "$bundle/bin/cuda_tests" --gtest_brief=1; }
tests=$(verdict run_tests)
sanitizers=()
sanitize() {  # TOOL PROGRAM NAME
  command -v compute-sanitizer >/dev/null || return 0
  sanitizers+=("$3=$(verdict compute-sanitizer --tool "$1" --error-exitcode 1 \
    "$bundle/bin/$2" --gtest_brief=1 --gtest_filter='*SmallQuery*')")
}
for sanitizer in memcheck racecheck initcheck synccheck; do sanitize $sanitizer cuda_tests $sanitizer; done

"$bundle/bin/control-loop" "$tool" "$cloud" device=cpu queries=1 poses="$work/poses.jsonl" path=400 >/dev/null
query=("$bundle/bin/vpm-query" --tool "$tool" --cloud "$cloud" --quiet --force)
same=()
for level in ${levels//,/ }; do
  ask=("${query[@]}" --level "$level" --poses "$work/poses.jsonl")
  "${ask[@]}" --device cpu -o "$work/cpu.jsonl"
  "${ask[@]}" --device cuda -o "$work/one.jsonl"
  "${ask[@]}" --device cuda --batch 128 -o "$work/many.jsonl"
  same+=("$level=$(verdict bash -c "cmp $work/cpu.jsonl $work/one.jsonl && cmp $work/cpu.jsonl $work/many.jsonl")")
done

suite_answers() {  # SUITE DEVICE: writes a suite's results without times and without parts that only the CPU runs
  "$bundle/bin/vpm-bench" "$1" --quick --quiet --device "$2" --out "$work/$1-$2" >/dev/null
  python3 - "$work/$1-$2/$1.json" >"$work/$1-$2.txt" <<'PYTHON'
import json, re, sys
took = re.compile(r"seconds|_us$|_ms$|_mb$|^ratio$|^change$|^real_time_factor$|^deadline_misses$")
of_time_or_cpu = {"threads", "deadline", "frame", "coherent"}
def answers(value):
    if isinstance(value, dict):
        return {key: answers(item) for key, item in value.items() if not took.search(key)}
    return [answers(item) for item in value] if isinstance(value, list) else value
for result in json.load(open(sys.argv[1]))["results"]:
    if not of_time_or_cpu & {result.get("varied"), result.get("part")} and result.get("threads", 1) == 1:
        print(answers(result))
PYTHON
  [[ -s "$work/$1-$2.txt" ]]
}
for suite in accuracy extremes replay tradeoff; do
  for device in cpu cuda; do suite_answers $suite $device; done
  same+=("suite:$suite=$(verdict cmp "$work/$suite-cpu.txt" "$work/$suite-cuda.txt")")
done

loop=("$bundle/bin/control-loop" "$tool" "$cloud" device=cuda)
for ((round = 0; round < ${ROUNDS:-5}; ++round)); do
  for level in ${levels//,/ }; do
    row() { "${loop[@]}" level="$level" "${@:2}" json="$work/loop-$level-$1-$round.json" >/dev/null; }
    for copies in 1 8; do row $copies rotate=$copies queries=10000; done
  done
done
for level in ${levels//,/ }; do
  row() { "${loop[@]}" level="$level" batch=16384 "${@:2}" json="$work/batch-$level-$1.json" >/dev/null; }
  row one queries=114688
  row tools queries=114688 rotate=8
done

python3 - "$out" "$work" "$commit" "$tests" "${sanitizers[*]}" "${same[*]}" "$(dirname "$0")" <<'PYTHON'
import glob, json, sys
out, work, commit, tests, sanitizers, same, scripts = sys.argv[1:]
sys.path.insert(0, scripts)
import loop_rounds
pairs = lambda text: dict(item.split("=") for item in text.split())
smi = loop_rounds.device()
report = {
    "command": "scripts/cuda_check.sh", "commit": commit, "device": smi, "tests": tests,
    "compute_sanitizer": pairs(sanitizers), "same_bytes_as_cpu": pairs(same),
    "control_loop": sorted(loop_rounds.loops_in(work), key=lambda r: (r["measure"] != "refined", r["spheres"], r["copies"])),
    "batch": sorted((json.load(open(path)) for path in glob.glob(f"{work}/batch-*.json")), key=lambda r: (r["measure"] != "refined", r["tools"], r["spheres"])),
}
json.dump(report, open(out, "w"), indent=2)
print(f"{smi}, commit {commit}: tests {tests}, compute-sanitizer {sanitizers}, CPU and device the same {same}")
for r in report["control_loop"]:
    print(f"{r['measure']:8} {r['spheres']:8} spheres  {r['copies']} copies  {loop_rounds.in_words(r)}")
for r in report["batch"]:
    print(f"{r['measure']:8} {r['spheres']:8} spheres  batches of {r['batch']}, tools {r['tools']}  {r['poses_per_second']:9.0f} poses/s")
PYTHON
"$(dirname "$0")/cuda_frames_check.sh" "$bundle" "${out%.json}_frames.json" "$tool" "$cloud" "$levels" "$commit" || failed=1
[[ "$tests ${sanitizers[*]} ${same[*]}" != *FAIL* ]] || failed=1
exit $failed
