#!/usr/bin/env bash
# cuda_devices_check.sh BUNDLE OUT.json TOOL.vpmg CLOUD.vpmc LEVELS COMMIT: compares one device (cuda:0) with all
# devices of a machine (cuda:all) on batches. BUNDLE is made by scripts/bundle.sh of control-loop, vpm-query and
# cuda_tests; LEVELS are like 1000,17000. Steps: (1) runs the tests of tests/cuda that need several devices; (2)
# compares results byte for byte; (3) times poses per second, in turns, three times each. Exit code 1 if anything
# differs, or if all devices together are slower than 0.9 times their number.
set -euo pipefail
bundle=$1 out=$2 tool=$3 cloud=$4 levels=$5 commit=$6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

tests=pass
"$bundle/bin/cuda_tests" --gtest_brief=1 --gtest_filter='*AllDevices*' >"$work/tests" 2>&1 || tests=FAIL
cat "$work/tests"
"$bundle/bin/control-loop" "$tool" "$cloud" device=cuda:0 queries=1 poses="$work/poses.jsonl" path=20000 >/dev/null
same=()
for measure in refined paper; do
  for level in ${levels//,/ }; do
    for device in cuda:0 cuda:all; do
      "$bundle/bin/vpm-query" --tool "$tool" --cloud "$cloud" --quiet --measure $measure --level "$level" \
        --poses "$work/poses.jsonl" --batch 20000 --device $device -o "$work/$device.jsonl"
    done
    verdict=pass
    cmp "$work/cuda:0.jsonl" "$work/cuda:all.jsonl" || verdict=FAIL
    same+=("$measure:$level=$verdict")
  done
done

for turn in 1 2 3; do
  for level in ${levels//,/ }; do
    for device in cuda:0 cuda:all; do
      "$bundle/bin/control-loop" "$tool" "$cloud" device=$device level="$level" batch=65536 queries=131072 \
        json="$work/batch-$level-$device-$turn.json" >/dev/null
    done
  done
done

python3 - "$out" "$work" "$commit" "$tests" "${same[*]}" <<'PYTHON'
import glob, json, statistics, subprocess, sys
out, work, commit, tests, same = sys.argv[1:]
same = dict(item.split("=") for item in same.split())
devices = subprocess.run(["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"],
                         capture_output=True, text=True).stdout.strip().splitlines()
rate = lambda level, device: statistics.median(
    json.load(open(path))["poses_per_second"] for path in glob.glob(f"{work}/batch-{level}-{device}-*.json"))
levels = sorted({int(path.split("/")[-1].split("-")[1]) for path in glob.glob(f"{work}/batch-*.json")})
rows = [{"spheres": n, "batch": 65536, "poses_per_second_of_one": rate(n, "cuda:0"),
         "poses_per_second_of_all": rate(n, "cuda:all"), "ratio": rate(n, "cuda:all") / rate(n, "cuda:0")} for n in levels]
report = {"command": "scripts/cuda_devices_check.sh", "commit": commit, "devices": devices, "tests": tests,
          "same_bytes_as_one": same, "batch": rows}
json.dump(report, open(out, "w"), indent=2)
print(f"{len(devices)} devices, {devices[0]}, commit {commit}: tests {tests}, same bytes {same}")
for r in rows:
    print(f"{r['spheres']:8} spheres  one {r['poses_per_second_of_one']:9.0f} poses/s  all "
          f"{r['poses_per_second_of_all']:9.0f}  {r['ratio']:.2f} times")
good = tests == "pass" and "FAIL" not in same.values() and all(r["ratio"] >= 0.9 * len(devices) for r in rows)
sys.exit(0 if good else 1)
PYTHON
