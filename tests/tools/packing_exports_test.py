#!/usr/bin/env python3
"""Compares what three.js reads of the spheres that vpm-pack exports with the spheres.

    packing_exports_test.py --bin DIR[:DIR...]

Exit status: 0 if all agree, 1 otherwise, 77 (skipped) where node or three.js (Debian: nodejs, libjs-three) is not there.
"""
import argparse
import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

THREE = pathlib.Path("/usr/share/javascript/three")
READER = pathlib.Path(__file__).with_name("three_reads.js")
SKIPPED = 77
CUBE = """OFF
8 6 0
1 2 3
1.5 2 3
1.5 2.5 3
1 2.5 3
1 2 3.5
1.5 2 3.5
1.5 2.5 3.5
1 2.5 3.5
4 3 2 1 0
4 4 5 6 7
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
"""
BALL = (42, 80)  # vertices and triangles
NEAR = 1e-5  # m


def expected(spheres, name):
    points = name.endswith(".points.ply")
    reach = [0 if points else r for *_, r in spheres]
    return {"vertices": len(spheres) * (1 if points else BALL[0]), "triangles": 0 if points else len(spheres) * BALL[1],
            "low": [min(s[k] - r for s, r in zip(spheres, reach)) for k in range(3)],
            "high": [max(s[k] + r for s, r in zip(spheres, reach)) for k in range(3)]}


def agree(found, truth):
    return all(found[key] == truth[key] for key in ("vertices", "triangles")) and all(
        abs(a - b) < NEAR for key in ("low", "high") for a, b in zip(found[key], truth[key]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    options = parser.parse_args()
    if not shutil.which("node") or not (THREE / "examples/js/loaders/GLTFLoader.js").exists():
        print("skipped: node or three.js is not there")
        return SKIPPED
    environment = dict(os.environ, PATH=options.bin + ":" + os.environ["PATH"])
    names = ["all.ply", "all.points.ply", "all.glb"]
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "cube.off").write_text(CUBE)
        for name in ["all.csv", *names]:
            subprocess.run(["vpm-pack", "cube.off", "--spheres", "20", "--quiet", "--export", name], cwd=folder, env=environment,
                           check=True)
        with open(pathlib.Path(folder) / "all.csv") as table:
            spheres = [[float(row[key]) for key in "xyzr"] for row in csv.DictReader(table)]
        done = subprocess.run(["node", READER, THREE, *names], cwd=folder, capture_output=True, text=True, check=False)
    found = dict(line.split(" ", 1) for line in done.stdout.splitlines())
    good = done.returncode == 0
    for name in names:
        read = json.loads(found.get(name, "null"))
        if read is None or not agree(read, expected(spheres, name)):
            print(f"{name}: three.js reads {read}, expected {expected(spheres, name)}\n{done.stderr}")
            good = False
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
