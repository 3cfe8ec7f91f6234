#!/usr/bin/env python3
"""Asks the tools about the third round's inputs of depth images, intrinsics and poses.

    reports3_depth_test.py --bin DIR[:DIR...] DATA

DATA is the folder `reports3` of the shared data, beside `reports`; its README.md tells what each input is and what the right answer
would be. Exit status: 0 if all agree, 1 otherwise, 77 (skipped) if DATA is not there.
"""
import argparse
import pathlib
import shutil
import sys
import tempfile

from reports_test import CAMERA, SKIPPED, Tools, volume_faults

TWO = [0.0018462, 0.0023952]  # m^3 of the cube behind the wall at the poses of base/two.txt
# Row: options of vpm-normals with the input; exit status; text that its messages hold, or "" for none; volumes at two.txt.
CLOUDS = [
    ("A03/000000.png --intrinsics A03/scene_camera.json --depth-scale 10000", 0, "", TWO),
    ("A03/000000.png --intrinsics A03/scene_camera.json", 0, "give --depth-scale 10000", None),
    (f"A17/d.png {CAMERA}", 0, "", TWO),
    ("A28/a.png --intrinsics A28/meta.mat", 1, "this is a MATLAB file; write fx, fy, cx and cy", None),
    (f"A28/a.png {CAMERA}", 0, "", TWO),
]
POSES = ["base/two.txt", "G12/poses.npy", "G24/poses.txt"]


def faults_of(tools):
    for row, status, text, volumes in CLOUDS:
        done = tools.run(f"vpm-normals {row} -o c.vpmc --force")
        if done.returncode != status or text not in done.stderr or (not text and done.stderr):
            yield f"{row}: exit status {done.returncode}, expected {status} and '{text}': {done.stderr}"
        elif volumes:
            yield from volume_faults(row, tools.run("vpm-query --tool cube.vpmg --cloud c.vpmc --poses base/two.txt"), volumes)
    tools.must(f"vpm-normals base/tilt.png {CAMERA} -o wall.vpmc")
    for poses in POSES:
        done = tools.run(f"vpm-query --tool cube.vpmg --cloud wall.vpmc --poses {poses}")
        if done.returncode != 0 or done.stderr:
            yield f"{poses}: exit status {done.returncode}: {done.stderr}"
        yield from volume_faults(poses, done, TWO)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("data", type=pathlib.Path)
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"skipped: there is no folder {options.data}")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary) / "reports3"
        shutil.copytree(options.data, folder)
        tools = Tools(options.bin, folder)
        cube = options.data.resolve().parent / "reports/base/cube.off"
        tools.must(f"vpm-pack {cube} -o cube.vpmp --spheres 1000 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet")
        faults = list(faults_of(tools))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
