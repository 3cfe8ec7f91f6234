"""Merges several rounds of control-loop into one, for scripts/cuda_*.sh."""
import collections
import glob
import json
import statistics
import subprocess


def device():
    """Returns names and drivers of the NVIDIA devices of this machine, as reports tell them."""
    return subprocess.run(["nvidia-smi", "--query-gpu=name,driver_version", "--format=csv,noheader"],
                          capture_output=True, text=True).stdout.strip()


def of_rounds(reports):
    """Returns medians of the rounds' figures, and p99 of each round."""
    merged = dict(reports[0], rounds=len(reports), p99_us_of_rounds=sorted(r["p99_us"] for r in reports),
                  host_slowed=sum(r["host_slowed"] for r in reports),
                  min_us=min(r["min_us"] for r in reports), max_us=max(r["max_us"] for r in reports))
    for key in ("median_us", "p99_us", "p99_steady_us", "prepare_us"):
        if key in merged:
            merged[key] = statistics.median(r[key] for r in reports)
    return merged


def loops_in(folder):
    """Merges FOLDER/loop-WHAT-ROUND.json over the rounds, for each WHAT."""
    reports = collections.defaultdict(list)
    for path in sorted(glob.glob(f"{folder}/loop-*.json")):
        with open(path) as file:
            reports[path.rsplit("-", 1)[0]].append(json.load(file))
    return [of_rounds(of_what) for of_what in reports.values()]


def in_words(loop):
    """Returns the loop's times as text for a line of a table."""
    rounds = loop["p99_us_of_rounds"]
    return (f"median {loop['median_us']:7.1f} us  p99 {loop['p99_us']:7.1f} ({rounds[0]:.1f} to {rounds[-1]:.1f}) us,"
            f" {loop['p99_steady_us']:.1f} while the host keeps its pace")
