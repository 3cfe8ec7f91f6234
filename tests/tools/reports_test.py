#!/usr/bin/env python3
"""Asks the tools about the small inputs after public reports, and compares with the answers below.

    reports_test.py --bin DIR[:DIR...] DATA

DATA is the folder `reports` of the shared data, whose README.md tells what each input is and what the right answer would be. Exit
status: 0 if all agree, 1 otherwise, 77 (skipped) if DATA is not there.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
SECONDS = 120
CAMERA = "--intrinsics 150,150,79.5,59.5"
PASSES = 0.002  # m^3 of the cube that is behind the wall

BRICK = 0.006  # m^3
# Row: folder; mesh; exit status of vpm-pack; text that its messages hold; volume of the solid.
MESHES = [
    ("M01", "a.off", 0, "", BRICK),
    ("M02", "a.off", 0, "", BRICK),
    ("M06", "a.obj", 0, "1 face of fewer than three corners dropped", BRICK),
    ("M08", "a.obj", 0, "", BRICK),
    ("M09", "a.obj", 0, "", BRICK),
    ("M09b", "a.stl", 0, "", BRICK),
    ("M10", "a.obj", 0, "w other than 1, by which the others were divided", BRICK / 8),
    ("M20", "a.ply", 0, "", BRICK),
    ("M26", "a.stl", 0, "", BRICK),
    ("M29", "a.stl", 0, "the header says 0 triangles, but the file has 12", BRICK),
    ("M33a", "a.stl", 1, "this is a Git LFS pointer, not the file itself; fetch it with: git lfs pull", None),
    ("M33b", "a.obj", 1, "this is a Git LFS pointer, not the file itself; fetch it with: git lfs pull", None),
    ("V09", "brick_mm.obj", 0, "m across: if its unit is the millimetre, give --scale 0.001", None),
    ("V09", "brick_mm.obj --scale 0.001", 0, "", BRICK),
]
# Row: folder; options of vpm-normals with the input; exit status; text that its messages hold; volumes at the poses.
CLOUDS = [
    ("D01", f"a.png {CAMERA}", 0, "hold 65535", [PASSES]),
    ("D01", f"a.png {CAMERA} --invalid 65535", 0, "", [PASSES]),
    ("D06", f"greylayers.exr {CAMERA}", 0, "depth is its channel depth.Z", [PASSES]),
    ("D06", f"greylayers.exr {CAMERA} --channel depth.Z", 0, "", [PASSES]),
    ("D07", f"multi.exr {CAMERA}", 0, "depth is its channel", [PASSES]),
    ("D13", f"ray.exr {CAMERA} --along-ray", 0, "", [PASSES]),
    ("P03", "a.pcd", 0, "VIEWPOINT is taken for the pose", None),
    ("P06b", "a.pcd", 1, "give --axes opengl", None),
    ("P06b", "a.pcd --axes opengl", 0, "intrinsics recovered", [PASSES]),
    ("P14", "a.ply", 1, "normals are zero", None),
    ("P16", "a.ply", 1, "face opposite ways", None),
    ("P16", "a.ply --orient 0,0,0", 0, "normals turned", [PASSES, 0]),
    ("P17", "a.pcd", 0, "give --flip", None),
    ("P17", "a.pcd --flip", 0, "", [PASSES, 0]),
    ("P24", "a.pcd", 0, "fits no pinhole camera", [PASSES]),
    ("V01", "a.ply", 0, "", [0.008, 0.008, 0]),
    ("V03b", "a.ply", 0, "", [0, 0]),
]
# Row: folder; text that vpm-query's messages hold; volumes.
POSES = [("Q03", "", [PASSES]), ("V06", "", None)]
TOLERANCE = 5e-5  # m^3: the packing of the cube has 1000 spheres
NOTHING = 8e-9  # m^3: a millionth of the cube, which may count before it touches


class Tools:
    def __init__(self, bin_folders, folder):
        self.environment = dict(os.environ, LC_ALL="C", PATH=bin_folders + ":" + os.environ["PATH"])
        self.folder = folder

    def run(self, command):
        return subprocess.run(command, shell=True, cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, errors="replace", timeout=SECONDS)

    def must(self, command):
        done = self.run(command)
        if done.returncode != 0:
            raise SystemExit(f"{command} fails: {done.stderr}")


def volume_faults(row, done, volumes):
    found = [json.loads(line)["volume"] for line in done.stdout.splitlines()]
    if volumes is None:
        return
    if len(found) != len(volumes) or any(abs(a - b) > (TOLERANCE if b else NOTHING) for a, b in zip(found, volumes)):
        yield f"{row}: volumes {found}, expected {volumes} {done.stderr}"


def mesh_faults(tools, folder, arguments, status, text, volume):
    row = f"{folder}: vpm-pack {arguments}"
    done = tools.run(f"cd {folder} && vpm-pack {arguments} --spheres 60 --report -")
    more = [line for line in done.stderr.splitlines() if not re.search("spheres fill .* of a solid of", line)]
    if done.returncode != status or text not in done.stderr or (not text and more):
        yield f"{row}: exit status {done.returncode}, expected {status} and '{text}': {done.stderr}"
    elif volume is not None and abs(json.loads(done.stdout)["volume_mesh"] - volume) > 1e-6 * volume:
        yield f"{row}: volume {json.loads(done.stdout)['volume_mesh']}, expected {volume}"


def cloud_faults(tools, folder, arguments, status, text, volumes):
    row = f"{folder}: vpm-normals {arguments}"
    here = f"cd {folder} && "
    done = tools.run(f"{here}vpm-normals {arguments} -o ../c.vpmc --force")
    if done.returncode != status or text not in done.stderr:
        yield f"{row}: exit status {done.returncode}, expected {status} and '{text}': {done.stderr}"
    if done.returncode != 0:
        return
    poses = "--poses poses.txt" if (tools.folder / folder / "poses.txt").exists() else "--pose 0,0,0.95,0,0,0,1"
    yield from volume_faults(row, tools.run(f"{here}vpm-query --tool ../cube.vpmg --cloud ../c.vpmc {poses}"), volumes)


def pose_faults(tools, folder, text, volumes):
    done = tools.run(f"vpm-query --tool cube.vpmg --cloud wall.vpmc --poses {folder}/poses.txt")
    if done.returncode != 0 or text not in done.stderr:
        yield f"{folder}: exit status {done.returncode}, expected '{text}': {done.stderr}"
    yield from volume_faults(folder, done, volumes)


def scale_faults(tools):
    """A tool in millimetres is told from a scene in metres."""
    tools.must("vpm-pack V09/brick_mm.obj -o brick.vpmp --spheres 60 --quiet && vpm-graph brick.vpmp -o brick.vpmg --quiet")
    done = tools.run("vpm-query --tool brick.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1")
    if not re.search(r"the tool is \d+ m across and the scene \d", done.stderr):
        yield f"V09: no warning about the tool's size: {done.stderr}"


def all_faults(tools):
    tools.must("vpm-pack base/cube.off -o cube.vpmp --spheres 1000 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet")
    tools.must(f"vpm-normals base_wall/wall.png -o wall.vpmc {CAMERA}")
    yield from (fault for row in MESHES for fault in mesh_faults(tools, *row))
    yield from (fault for row in CLOUDS for fault in cloud_faults(tools, *row))
    yield from (fault for row in POSES for fault in pose_faults(tools, *row))
    yield from scale_faults(tools)


def main(description, faults_of):
    """Prints the faults that faults_of(tools) finds in a copy of the data, and exits; `tools` run there."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("data", type=pathlib.Path)
    options = parser.parse_args()
    if not options.data.is_dir():
        print(f"skipped: there is no folder {options.data}")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary) / "data"
        shutil.copytree(options.data, folder)
        faults = list(faults_of(Tools(options.bin, folder)))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(__doc__, all_faults)
