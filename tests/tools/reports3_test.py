#!/usr/bin/env python3
"""Asks the tools about the third round's inputs after public reports, and compares with the answers below.

    reports3_test.py --bin DIR[:DIR...] DATA

DATA is the folder `reports3` of the shared data, whose README.md tells what each input is and what the right answer would be. Exit
status: 0 if all agree, 1 otherwise, 77 (skipped) if DATA is not there. A tab in --link is asked about in cases/pack_export.t.
"""
import json

from reports_test import BRICK, CAMERA, TOLERANCE, main, mesh_faults, volume_faults

CUBE = """OFF
8 6 0
-.1 -.1 -.1  .1 -.1 -.1  -.1 .1 -.1  .1 .1 -.1
-.1 -.1 .1  .1 -.1 .1  -.1 .1 .1  .1 .1 .1
4 0 2 3 1
4 4 5 7 6
4 0 1 5 4
4 2 6 7 3
4 0 4 6 2
4 1 3 7 5
"""
TWO = [0.0018462, 0.0023952]  # m^3 of the cube behind the tilted wall at the poses of base/two.txt
# Row: folder; mesh; exit status of vpm-pack; text that its messages hold, or "" for none; volume of the solid.
OTHERS = "written-by-others"
MESHES = [
    ("C07", "a.3mf", 0, "left out as no part of the solid: support", BRICK),
    ("C08", "a.3mf", 0, "ParameterModifier", BRICK),
    (OTHERS, "three-mirrored-cube.stl", 0, "the mesh faced inward and was turned", 0.001),
    (OTHERS, "gltf-transform-mirrored-node.glb", 0, "transforms of nodes were applied", 0.001),
    (OTHERS, "gltf-transform-two-instances.glb", 0, "the meshes of 2 nodes are joined", 0.002),
    (OTHERS, "five-sided-prism.ply", 0, "", None),
]
# Row: options of vpm-normals with the input; exit status; text that its messages hold, or "" for none; volumes at two.txt.
CLOUDS = [
    ("A03/000000.png --intrinsics A03/scene_camera.json --depth-scale 10000", 0, "", TWO),
    ("A03/000000.png --intrinsics A03/scene_camera.json", 0, "give --depth-scale 10000", None),
    (f"A17/d.png {CAMERA}", 0, "", TWO),
    ("A28/a.png --intrinsics A28/meta.mat", 1, "this is a MATLAB file; write fx, fy, cx and cy", None),
    (f"A28/a.png {CAMERA}", 0, "", TWO),
]
POSES = ["base/two.txt", "G12/poses.npy", "G24/poses.txt"]


def warnings_of(done):
    return [line for line in done.stderr.splitlines() if ": warning: " in line]


def cloud_faults(tools):
    for row, status, text, volumes in CLOUDS:
        done = tools.run(f"vpm-normals {row} -o c.vpmc --force")
        if done.returncode != status or text not in done.stderr or (not text and done.stderr):
            yield f"{row}: exit status {done.returncode}, expected {status} and '{text}': {done.stderr}"
        elif volumes:
            yield from volume_faults(row, tools.run("vpm-query --tool cube.vpmg --cloud c.vpmc --poses base/two.txt"), volumes)


def pose_faults(tools):
    for poses in POSES:
        done = tools.run(f"vpm-query --tool cube.vpmg --cloud wall.vpmc --poses {poses}")
        if done.returncode != 0 or done.stderr:
            yield f"{poses}: exit status {done.returncode}: {done.stderr}"
        yield from volume_faults(poses, done, TWO)


def finger_faults(tools):
    """C30a: a finger of 15 x 30 x 50 millimetres that is packed without --scale; the cure works."""
    made = "vpm-pack C30a/finger.stl -o finger.vpmp --spheres 60 --quiet --force {} && " \
           "vpm-graph finger.vpmp -o finger.vpmg --quiet --force"
    ask = "vpm-query --tool finger.vpmg --cloud wall.vpmc --poses base/two.txt"
    tools.run(made.format(""))
    said = warnings_of(tools.run(ask))
    if len(said) != 1 or not said[0].endswith("give vpm-pack --scale 0.001"):
        yield f"C30a: {said}"
    tools.must(made.format("--scale 0.001"))
    done = tools.run(ask)
    if warnings_of(done) or any(json.loads(line)["volume"] > 15e-3 * 30e-3 * 50e-3 for line in done.stdout.splitlines()):
        yield f"C30a with --scale 0.001: {done.stdout} {done.stderr}"


def millimetre_faults(tools):
    """G08: poses in millimetres, also where all that is hidden counts as solid; the cure works."""
    for shadows in ("near", "solid"):
        ask = f"vpm-query --tool cube.vpmg --cloud wall.vpmc --shadows {shadows} --poses"
        said = warnings_of(tools.run(f"{ask} G08/poses.txt"))
        if len(said) != 1 or "divided by 1000, if they are millimetres" not in said[0]:
            yield f"G08, --shadows {shadows}: {said}"
        done = tools.run("awk '{print $1/1000, $2/1000, $3/1000, $4, $5, $6, $7}' G08/poses.txt | " + f"{ask} -")
        found = [json.loads(line)["volume"] for line in done.stdout.splitlines()]
        if warnings_of(done) or len(found) != 2 or any(abs(a - b) > TOLERANCE for a, b in zip(found, TWO)):
            yield f"G08 in metres, --shadows {shadows}: {found} {done.stderr}"


def all_faults(tools):
    (tools.folder / "cube.off").write_text(CUBE)
    tools.must("vpm-pack cube.off -o cube.vpmp --spheres 1000 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet")
    tools.must(f"vpm-normals base/tilt.png {CAMERA} -o wall.vpmc")
    yield from (fault for row in MESHES for fault in mesh_faults(tools, *row))
    for faults_of in (cloud_faults, pose_faults, finger_faults, millimetre_faults):
        yield from faults_of(tools)


if __name__ == "__main__":
    main(__doc__, all_faults)
