#!/usr/bin/python3
"""Measures what the Python module adds to the C++ library: ten thousand poses at once, and poses one by one.

    PYTHONPATH=BUILD/python python_cost.py BUILD/bin COMMIT > tests/results/python.json

BUILD/bin has the programs, make-example and query-time (`cmake --build BUILD --target query-time`), COMMIT is what they were built of. The
scene and the tool of 1000 spheres are those of the demo. "clear" poses touch nothing, so that what Python adds counts most; "deep" ones
are those of the demo's path that do, whose times differ by more than what Python adds to one. C++ and Python ask the same poses in turn,
on one thread each, and their processor's time counts, so that other programs disturb little. A round's ratio and difference are of
neighbours in time; the figures are medians over the rounds.
Fails if the answers of the two differ.
"""
import json
import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np
import vpm

from thread_scaling import make_demo, report, write_poses

ROUNDS = 11
ASKED = (("clear", "batch", 10_000), ("clear", "singles", 2_000), ("deep", "batch", 10_000))


def make_inputs(run):
    poses = make_demo(run)
    for kind, way, count in ASKED:
        write_poses(f"{kind}.{way}", poses[kind], count)


def in_python(query, scene, poses, way):
    """Returns the seconds of the processor that all poses take, and the sum of their volumes."""
    begin = time.process_time()
    if way == "batch":
        results = query.run_batch(scene, poses)
        return time.process_time() - begin, sum(results.volume.tolist())
    volume = 0.0
    for pose in poses:
        volume += query.run(scene, pose).volume
    return time.process_time() - begin, volume


def measured(query_time):
    vpm.set_thread_count(1)
    scene, query = vpm.Scene(vpm.PointCloud.read("scene.vpmc")), vpm.Query(vpm.Tool.read("tool.vpmg"))
    for kind, way, count in ASKED:
        poses = np.array([json.loads(line) for line in pathlib.Path(f"{kind}.{way}").read_text().splitlines()])
        peer = subprocess.Popen([query_time, "tool.vpmg", "scene.vpmc", f"{kind}.{way}"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        rounds = []
        for _ in range(ROUNDS):
            print(way, file=peer.stdin, flush=True)
            cpp, volume = map(float, peer.stdout.readline().split())
            seconds, sum_of_volumes = in_python(query, scene, poses, way)
            if volume != sum_of_volumes:
                sys.exit(f"{kind}, {way}: C++ finds {volume} m^3 in all, Python {sum_of_volumes}")
            rounds.append((cpp, seconds))
        peer.stdin.close()
        peer.wait()
        ratios = sorted(seconds / cpp for cpp, seconds in rounds)
        median_us = lambda values: 1e6 / count * statistics.median(values)
        yield {"poses": kind, "way": way, "count": count, "rounds": ROUNDS, "cpp_us": median_us(cpp for cpp, _ in rounds),
               "python_us": median_us(seconds for _, seconds in rounds), "added_us": median_us(seconds - cpp for cpp, seconds in rounds),
               "ratio": statistics.median(ratios), "quartiles": [ratios[ROUNDS // 4], ratios[-1 - ROUNDS // 4]]}


if __name__ == "__main__":
    programs = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
    report("python_cost.py", __doc__, make_inputs, lambda run: measured(programs / "query-time"))
