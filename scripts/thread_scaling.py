#!/usr/bin/env python3
"""Measures how many poses a second `vpm-query --threads N` answers with 1, 2, 4 … threads, each on a core of its own.

    thread_scaling.py BIN COMMIT > tests/results/threads.json

BIN is the folder of the programs and of make-example, COMMIT what they were built of. The scene and the tool are those of the demo.
"clear" poses touch nothing, "deep" ones are those of the demo's path that do. The time of a run with one pose, which is that of
reading the tool and preparing the scene, is taken off. Each figure is the median of three rounds, which measure all in turn. Fails if
the answers are not the same bytes for any number of threads.
"""
import functools
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROUNDS = 3
CLEAR, DEEP = 400_000, 30_000
CAMERA = ("--intrinsics", "525,525,319.5,239.5", "--depth-scale", "5000")  # of the demo's depth image


def make_tool(run):
    """Makes the demo's example and its tool of 1000 spheres, tool.vpmg. Returns the poses of its path, a line each."""
    run("make-example", ".")
    run("vpm-pack", "tool.off", "-o", "tool.vpmp", "--spheres", "1000", "--quiet")
    run("vpm-graph", "tool.vpmp", "-o", "tool.vpmg", "--quiet")
    return pathlib.Path("poses.jsonl").read_text().splitlines()


def make_demo(run):
    """Makes the demo's scene, scene.vpmc, too. Returns those poses of the path that touch nothing, "clear", and those that do, "deep"."""
    path = make_tool(run)
    run("vpm-normals", "depth.png", "-o", "scene.vpmc", *CAMERA, "--quiet")
    return {"clear": path[:9], "deep": path[len(path) // 3:]}


def write_poses(name, poses, count):
    """Writes so many poses, which begin anew after the last."""
    pathlib.Path(name).write_text("\n".join(poses[k % len(poses)] for k in range(count)) + "\n")


def make_inputs(run):
    poses = make_demo(run)
    write_poses("one", poses["clear"], 1)
    write_poses("clear", poses["clear"], CLEAR)
    write_poses("deep", poses["deep"], DEEP)


def seconds_of(run, poses, threads):
    begin = time.perf_counter()
    run("taskset", "-c", f"0-{threads - 1}", "vpm-query", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--poses", poses,
        "--threads", threads, "--device", "cpu", "--quiet", "-o", f"{poses}.{threads}", "--force")
    return time.perf_counter() - begin


def measured(run):
    counts = [2 ** k for k in range(10) if 2 ** k <= len(os.sched_getaffinity(0))]
    seconds = {}
    for _ in range(ROUNDS):
        for poses in ("one", "clear", "deep"):
            for threads in counts:
                seconds.setdefault((poses, threads), []).append(seconds_of(run, poses, threads))
                if pathlib.Path(f"{poses}.{threads}").read_bytes() != pathlib.Path(f"{poses}.1").read_bytes():
                    sys.exit(f"{threads} threads answer otherwise than one")
    for poses, count in (("clear", CLEAR), ("deep", DEEP)):
        for threads in counts:
            start = statistics.median(seconds["one", threads])
            rates = sorted(count / (s - start) for s in seconds[poses, threads])
            yield {"poses": poses, "threads": threads, "poses_per_second": statistics.median(rates), "range": [rates[0], rates[-1]]}


def processor():
    return next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name"))


def report(script, usage, make_inputs, measured, *folders, machine=dict):
    """Runs `measured` on the inputs in a new folder, with the programs of BIN, and prints its rows with command, commit and machine.

    Inputs are made of `folders`, which the command names after COMMIT; machine() tells what the machine has but a processor.
    """
    if len(sys.argv) != 3 + len(folders):
        sys.exit(usage)
    programs, *given = (pathlib.Path(path).resolve() for path in [sys.argv[1], *sys.argv[3:]])
    environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        checked = functools.partial(subprocess.run, check=True)
        run = lambda *command, by=checked: by([str(word) for word in command], env=environment, stdout=sys.stderr)
        make_inputs(run, *given)
        results = list(measured(run))
        os.chdir("/")
    json.dump({"command": " ".join(["scripts/" + script, "BIN", "COMMIT", *folders]), "commit": sys.argv[2],
               "machine": {"cores": len(os.sched_getaffinity(0)), "processor": processor()} | machine(), "results": results},
              sys.stdout, indent=1)
    print()


if __name__ == "__main__":
    report("thread_scaling.py", __doc__, make_inputs, measured)
