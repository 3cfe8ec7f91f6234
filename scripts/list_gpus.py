#!/usr/bin/env python3
"""Measures how many frames a second `vpm-query --list` makes on 1, 2, 4 … GPUs with 1, 2 and 4 jobs on each, and on all cores without.

    list_gpus.py BIN COMMIT DEMO > tests/results/list_gpus.json

BIN is the folder of vpm-query, COMMIT what it was built of, DEMO what scripts/demo.sh leaves. Each frame is the demo's scene, in which the
demo's tool of 1000 spheres is asked 1000 poses of its path. The frames are counted that come in 3 s, from 0.5 s after the first; how long
that took is told beside. Each figure is the mean of two rounds, which measure all in turn; two GPUs take 90 s. Fails if answers are not
the same bytes everywhere.
"""
import os
import pathlib
import shutil
import statistics
import subprocess
import sys
import time

from thread_scaling import report

ROUNDS, FRAMES, POSES = 2, 10_000, 1000
SETTLING, COUNTING, ENDING = 0.5, 3, 0.5  # seconds


def gpus():
    told = subprocess.run(["nvidia-smi", "--query-gpu=name", "--format=csv,noheader"], check=True, capture_output=True, text=True)
    return told.stdout.splitlines()


def make_inputs(run, demo):
    for name in ("tool.vpmg", "scene.vpmc"):
        shutil.copyfile(demo / name, name)
    path = (demo / "poses.jsonl").read_text().splitlines()
    pathlib.Path("poses.txt").write_text("\n".join(path[k * len(path) // POSES] for k in range(POSES)) + "\n")
    pathlib.Path("frames.txt").write_text("".join(f'{{"cloud":"scene.vpmc","output":"out/{k}.jsonl"}}\n' for k in range(FRAMES)))
    run("vpm-query", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--poses", "poses.txt", "-o", "whole.jsonl", "--device", "cpu")


def rate_of(run, count, jobs):
    """Returns the frames a second on so many GPUs, or on the cores if there are none, and the seconds until the first came."""
    frames = lambda: len(list(pathlib.Path("out").glob("[0-9]*.jsonl")))
    begin = time.perf_counter()
    with run("env", "CUDA_VISIBLE_DEVICES=" + ",".join(map(str, range(count))), "vpm-query", "--list", "frames.txt", "--tool", "tool.vpmg",
             "--poses", "poses.txt", "-o", "out", "--jobs", jobs, "--quiet", "--device", "cuda" if count else "cpu",
             by=subprocess.Popen) as listed:
        while frames() == 0 and listed.poll() is None:
            time.sleep(0.01)
        first = time.perf_counter() - begin
        time.sleep(SETTLING)
        before, begin = frames(), time.perf_counter()
        time.sleep(COUNTING)
        rate = (frames() - before) / (time.perf_counter() - begin)
        if listed.poll() is not None:
            sys.exit("vpm-query --list ended before its frames were counted")
        listed.terminate()
    time.sleep(ENDING)  # of its processes
    if {path.read_bytes() for path in pathlib.Path("out").glob("[0-9]*.jsonl")} != {pathlib.Path("whole.jsonl").read_bytes()}:
        sys.exit(f"{count} GPUs answer otherwise than one core")
    shutil.rmtree("out")
    return rate, first


def measured(run):
    counts = [2 ** k for k in range(10) if 2 ** k <= len(gpus())]
    ways = [(0, len(os.sched_getaffinity(0)))] + [(count, count * jobs) for count in counts for jobs in (1, 2, 4)]
    told = [[rate_of(run, *way) for way in ways] for _ in range(ROUNDS)]
    for (count, jobs), of in zip(ways, zip(*told)):
        rates, firsts = zip(*of)
        yield {"gpus": count, "jobs": jobs, "frames_per_second": statistics.mean(rates), "range": [min(rates), max(rates)],
               "seconds_to_first": statistics.mean(firsts)}


if __name__ == "__main__":
    report("list_gpus.py", __doc__, make_inputs, measured, "DEMO", machine=lambda: {"gpu": gpus()[0]})
