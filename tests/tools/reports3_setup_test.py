#!/usr/bin/env python3
"""Asks vpm-query about setups in wrong units after public reports: it must lead to the cure, and the cure must work.

    reports3_setup_test.py --bin DIR[:DIR...] DATA

DATA is the folder `reports3` of the shared data, beside which `reports` lies. Exit status: 0 if all agree, 1 otherwise, 77 (skipped)
if DATA is not there.
"""
import argparse
import json
import pathlib
import shutil
import sys
import tempfile

from reports_test import CAMERA, SKIPPED, TOLERANCE, Tools

VOLUMES = [0.0018462, 0.0023952]  # m^3 of the cube behind the tilted wall, at the two poses


def warnings_of(done):
    return [line for line in done.stderr.splitlines() if ": warning: " in line]


def finger_faults(tools):
    """C30a: a finger of 15 x 30 x 50 millimetres that is packed without --scale."""
    made = "vpm-pack reports3/C30a/finger.stl -o finger.vpmp --spheres 60 --quiet --force {} && " \
           "vpm-graph finger.vpmp -o finger.vpmg --quiet --force"
    ask = "vpm-query --tool finger.vpmg --cloud wall.vpmc --poses reports3/base/two.txt"
    tools.run(made.format(""))
    said = warnings_of(tools.run(ask))
    if len(said) != 1 or not said[0].endswith("give vpm-pack --scale 0.001"):
        yield f"C30a: {said}"
    tools.must(made.format("--scale 0.001"))
    done = tools.run(ask)
    if warnings_of(done) or any(json.loads(line)["volume"] > 15e-3 * 30e-3 * 50e-3 for line in done.stdout.splitlines()):
        yield f"C30a with --scale 0.001: {done.stdout} {done.stderr}"


def pose_faults(tools):
    """G08: poses in millimetres, also where all that is hidden counts as solid."""
    for shadows in ("near", "solid"):
        ask = f"vpm-query --tool cube.vpmg --cloud wall.vpmc --shadows {shadows} --poses"
        said = warnings_of(tools.run(f"{ask} reports3/G08/poses.txt"))
        if len(said) != 1 or "divided by 1000, if they are millimetres" not in said[0]:
            yield f"G08, --shadows {shadows}: {said}"
        done = tools.run("awk '{print $1/1000, $2/1000, $3/1000, $4, $5, $6, $7}' reports3/G08/poses.txt | " + f"{ask} -")
        found = [json.loads(line)["volume"] for line in done.stdout.splitlines()]
        if warnings_of(done) or len(found) != 2 or any(abs(a - b) > TOLERANCE for a, b in zip(found, VOLUMES)):
            yield f"G08 in metres, --shadows {shadows}: {found} {done.stderr}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("data", type=pathlib.Path)
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"skipped: there is no folder {options.data}")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        shutil.copytree(options.data, folder / "reports3")
        tools = Tools(options.bin, folder)
        cube = options.data.parent / "reports/base/cube.off"
        tools.must(f"vpm-pack {cube} -o cube.vpmp --spheres 1000 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet")
        tools.must(f"vpm-normals reports3/base/tilt.png -o wall.vpmc {CAMERA}")
        faults = [*finger_faults(tools), *pose_faults(tools)]
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
