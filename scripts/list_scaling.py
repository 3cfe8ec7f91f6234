#!/usr/bin/env python3
"""Measures how many frames a second `vpm-normals --list` and `vpm-query --list` make with 1, 2, 4 … jobs, each on a core of its own.

    list_scaling.py BIN COMMIT > tests/results/list.json

BIN is the folder of the programs and of make-example, COMMIT what they were built of. The frames are copies of the demo's depth image
of 640 x 480 pixels; in each, the demo's tool of 1000 spheres is asked 100 poses of its path. "again" is the same command once all is
done, which reads and compares all of it. Each figure is the median of three rounds, which measure all in turn.
"""
import os
import pathlib
import shutil
import statistics
import time

from thread_scaling import CAMERA, make_tool, report

ROUNDS, FRAMES, POSES = 3, 128, 100


def make_inputs(run):
    path = make_tool(run)
    pathlib.Path("poses.txt").write_text("\n".join(path[k * len(path) // POSES] for k in range(POSES)) + "\n")
    os.mkdir("frames")
    names = [f"frames/{k:04}.png" for k in range(FRAMES)]
    for name in names:
        shutil.copyfile("depth.png", name)
    pathlib.Path("frames.txt").write_text("\n".join(names) + "\n")
    pathlib.Path("clouds.txt").write_text("\n".join(f"clouds/{name[:-4]}.vpmc" for name in names) + "\n")


def seconds_of(run, jobs, *command):
    begin = time.perf_counter()
    run("taskset", "-c", f"0-{jobs - 1}", *command, "--device", "cpu", "--jobs", jobs, "--threads", jobs, "--quiet")
    return time.perf_counter() - begin


def measured(run):
    normals = ("vpm-normals", "--list", "frames.txt", "-o", "clouds", *CAMERA)
    query = ("vpm-query", "--list", "clouds.txt", "--tool", "tool.vpmg", "--poses", "poses.txt", "-o", "results")
    counts = [2 ** k for k in range(10) if 2 ** k <= len(os.sched_getaffinity(0))]
    rates = {}
    for _ in range(ROUNDS):
        for jobs in counts:
            for folder in ("clouds", "results"):
                shutil.rmtree(folder, ignore_errors=True)
            for name, command in (("vpm-normals", normals), ("vpm-query", query), ("vpm-query, again", query)):
                rates.setdefault((name, jobs), []).append(FRAMES / seconds_of(run, jobs, *command))
    return [{"job": name, "jobs": jobs, "frames_per_second": statistics.median(of), "range": [min(of), max(of)]}
            for (name, jobs), of in rates.items()]


if __name__ == "__main__":
    report("list_scaling.py", __doc__, make_inputs, measured)
