#!/usr/bin/env python3
"""Follows the advice of the tools' messages: what a message tells to do must make that input pass.

    advice_test.py --bin DIR[:DIR...] [--row TEXT]

A row of the tables below is a command line that is refused or warned, a pattern that finds the advice in its messages, a command
line that follows the advice (`{0}` stands for the first group of the pattern: the message's own words), and where it gives one
the volume that comes out then. The second command must succeed, and say the advice no more. Files named out* are removed before
each command. Messages in the sources that advise something and that no row has met are faults too, except those in UNTRIED.

Inputs are made by advice_files.py. Rows about a format that this build does not read are passed over. --row runs only the rows
that hold TEXT. Exit status: 0 if all agree, 1 otherwise.
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import advice_files
from advice_files import MESH_STARTS, SCAN_STARTS, STARTS

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SECONDS = 120
NOT_BUILT = re.compile(r"is not read by this build|this build reads no|this build draws no pages")

CAMERA = "--intrinsics 60,60,31.5,23.5"
POSE = "0,0,0.95,0,0,0,1"
ASK = f"vpm-query --tool small.vpmg --pose {POSE}"
TOOL = "vpm-query --tool small.vpmg --cloud wall.vpmc"
STEPS = f"vpm-query --tool small.vpmg {CAMERA} --quiet"
COUPLED = "vpm-query --tool small.vpmg --cloud wall.vpmc --poses device.txt --stiffness 2e4"
BRICK = 0.008  # m^3, the small cube
WALL = "what the small cube has behind the wall"  # stands for the volume that the sound image gives
POINTS = "the same, of points without a camera"
ROUGH = 0.1  # relative, where a new surface or coarser depths change the answer

# Row: arguments of vpm-pack; advice; arguments that follow it; volume of the solid; relative tolerance.
MESHES = [
    ("cube_mm.off", r"give (--scale \S+)", "cube_mm.off {0}", 1),
    ("tiny.off", r"give (--scale \S+)", "tiny.off {0}", 0.125),
    ("huge.off", "give --scale", "huge.off --scale 1e-31", 1),
    ("open.off", r"give (--repair) to fill", "open.off {0}", 1),
    ("open.off", r"(--repair voxel) for a new surface", "open.off {0}=16", 1, ROUGH),
    ("loose.off", r"give (--weld 0\.001), which joins parts that nearly meet", "loose.off --weld 0.002", 1, ROUGH),
    ("fan.off --repair", r"give (--repair voxel) for a new surface", "fan.off {0}=16", 1, ROUGH),
    ("fan.off --repair", "mend it in a mesh editor", "cube.off --repair", 1),
    ("open.off --repair flood=20", "close it, or give a wider --max-hole", "open.off --repair flood=20 --max-hole 1.2", 1, 0.2),
    ("open.off --repair flood=20", "close it, or give a wider --max-hole", "cube.off --repair flood=40", 1, ROUGH),
    ("open.off --max-hole 1", r"--max-hole belongs to (--repair) (voxel) or (flood)", "open.off --max-hole 1.2 {0} {1}=16", 1,
     ROUGH),
    ("open.off --max-hole 1", r"--max-hole belongs to (--repair) (voxel) or (flood)", "open.off --max-hole 1.2 {0} {2}=20", 1,
     0.2),
    ("cube.off --repair flood --max-hole 50", "is it in metres", "cube.off --repair flood=40 --max-hole 0.05", 1, ROUGH),
    ("moebius.off --repair voxel", r"give (--repair flood)", "moebius.off {0}=40 --max-hole 0.3", 1, ROUGH),
    ("plate.off --repair voxel=8", r"give more voxels \((--repair voxel)=N\)", "plate.off {0}=48", 0.05, ROUGH),
    ("plate.off --repair flood=8 --max-hole 0.3", "give a wider --max-hole, or more voxels",
     "plate.off --repair flood=64 --max-hole 0.3", 0.05, ROUGH),
    ("cube.off --repair flood=20 --max-hole 0.001", "give a wider hole or more voxels",
     "cube.off --repair flood=20 --max-hole 0.2", 1, ROUGH),
    ("cube.off --repair flood=20 --max-hole 0.05", "give a wider hole or more voxels",
     "cube.off --repair flood=40 --max-hole 0.05", 1, ROUGH),
    ("cube.off --repair=all", "is none of (holes), (voxel), voxel=RES, (flood) and", "cube.off --repair={0}", 1),
    ("cube.off --repair voxel=1", r"must lie between (\d+) and", "cube.off --repair voxel={0}", 1, 0.3),
    ("cube.off --weld 2", "must lie between 0 and (0.1)", "cube.off --weld {0}", 1),
    ("cube.off --min-radius 0.6", "give a smaller --min-radius", "cube.off --min-radius 0.3", 1),
    ("cube.off --max-radius 1e-6", "give a larger --max-radius", "cube.off --max-radius 0.1", 1),
    ("small_mm.off --scale 1e-6 --for-scene wall.vpmc", "are both in metres", "small_mm.off --scale 1e-3 --for-scene wall.vpmc",
     BRICK),
    ("small.off --for-scene wall.vpmc --max-radius 0.001", "--max-radius is smaller; allow larger ones",
     "small.off --for-scene wall.vpmc --max-radius 0.1", BRICK),
    ("foil.off", "pack it in parts", "plate.off", 0.05),
    ("inner.off", "turn it over if it is a cavity", "cavity.off", 7 / 8),
    ("far.stl", "move it to the origin before it is saved in such floats", "near.stl", 1),
    ("cut.stl", "save it again, or fetch all of it", "near.stl", 1),
    ("crossing.off", "save triangles in the program that wrote it", "cube.off", 1),
    ("binary.off", "save it as text", "text.off", 1),
    ("robot.urdf", "give one of the files that it names", "$(sed -n 's/.*filename=\"\\([^\"]*\\).*/\\1/p' robot.urdf)", 1),
    ("two.dae", r"--node chooses one", "two.dae --node body", 1),
    ("two.glb --node hand", r"nodes with faces: \w+, (\w+)", "two.glb --node {0}", 0.125),
    ("cube.obj --node hand", "leave --node out", "cube.obj", 1),
    ("cut.glb", "save it again, or as OBJ", "cube.glb", 1),
    ("packed.gltf", "save it without compression, quantization and instancing, or as OBJ, PLY or STL", "cube.glb", 1),
    ("points.obj", "save it with its faces; a cloud of points is for vpm-normals", "cube.obj", 1),
    ("blank.obj", "give the file that was meant, as OBJ, PLY or STL", "cube.obj", 1),
    ("points.xyz", "give a mesh, as OBJ, PLY or STL; a cloud is for vpm-normals, as PLY with normals", "cube.obj", 1),
    ("words.txt", "save it as OBJ, PLY or STL in the program that wrote it", "cube.obj", 1),
    ("cut.glb", "save it again, or as OBJ", "cube.obj", 1),
    ("", "name an OBJ, OFF", "cube.obj", 1),
    ("", "or (-) for a pipe", "{0} < cube.off", 1),
]

# Row: arguments of vpm-normals; advice; arguments that follow it; volume of the small cube; relative tolerance.
SCANS = [
    ("wall.pgm", r"needs --intrinsics: fx,fy,cx,cy in pixels, or a file with them", f"wall.pgm {CAMERA}", WALL),
    ("wall.pgm", r"needs --intrinsics: fx,fy,cx,cy in pixels, or a file with them", "wall.pgm --intrinsics four.txt", WALL),
    ("wall.pgm --intrinsics 60,60", "give four numbers fx,fy,cx,cy, or a file with them", f"wall.pgm {CAMERA}", WALL),
    ("wall.pgm --intrinsics 60,60", "give four numbers fx,fy,cx,cy, or a file with them", "wall.pgm --intrinsics matrix.txt",
     WALL),
    ("wall.pgm --intrinsics larger.json", r"give (--intrinsics \S+)", "wall.pgm {0}", WALL),
    ("wall.pgm --intrinsics 0.9375,1.25,0.5,0.5", r"give (--intrinsics \S+)", "wall.pgm {0}", WALL),
    ("wall.pgm --intrinsics 600,600,319.5,239.5", "are these the intrinsics of this image's size", f"wall.pgm {CAMERA}", WALL),
    ("wall.pgm --intrinsics none.json", "it needs fx, fy, cx and cy", "wall.pgm --intrinsics one.json", WALL),
    ("wall.pgm --intrinsics none.json", r"a matrix (K), (camera_matrix) or (intrinsic_matrix)", "wall.pgm --intrinsics {0}.json",
     WALL),
    ("wall.pgm --intrinsics none.json", r"a matrix (K), (camera_matrix) or (intrinsic_matrix)", "wall.pgm --intrinsics {1}.json",
     WALL),
    ("wall.pgm --intrinsics none.json", r"a matrix (K), (camera_matrix) or (intrinsic_matrix)", "wall.pgm --intrinsics {2}.json",
     WALL),
    ("wall.pgm --intrinsics several.json", "give the numbers of one as --intrinsics fx,fy,cx,cy", f"wall.pgm {CAMERA}", WALL),
    ("wall.pgm --intrinsics five.txt", "neither fx fy cx cy nor a matrix fx 0 cx 0 fy cy 0 0 1",
     "wall.pgm --intrinsics matrix.txt", WALL),
    (f"marked.pgm {CAMERA} --invalid none", r"give (--invalid \S+)", f"marked.pgm {CAMERA} {{0}}", WALL),
    (f"marked.pgm {CAMERA}", r"(--invalid none) takes it for a depth", f"marked.pgm {CAMERA} {{0}}", WALL),
    (f"far.npy {CAMERA}", r"give (--invalid \S+)", f"far.npy {CAMERA} {{0}}", WALL),
    (f"rotated.pgm {CAMERA}", r"give (--decode \w+)", f"rotated.pgm {CAMERA} {{0}}", WALL),
    (f"disparity.pgm {CAMERA}", r"give (--decode \w+)", f"disparity.pgm {CAMERA} {{0}}", WALL, ROUGH),
    (f"swapped.png {CAMERA}", r"give (--decode \w+)", f"swapped.png {CAMERA} {{0}}", WALL),
    (f"wall.npy {CAMERA} --decode rotated", "--decode is for integers of 16 bits", f"wall.npy {CAMERA}", WALL),
    (f"rotated.pgm {CAMERA} --decode turned", "is not swapped, big-endian, (rotated) or disparity", f"rotated.pgm {CAMERA} --decode {{0}}",
     WALL),
    (f"wall.npy {CAMERA} --unit mm", "(--unit) or (--depth-scale) tells it", f"wall.npy {CAMERA} {{0}} m", WALL),
    (f"wall.npy {CAMERA} --unit mm", "(--unit) or (--depth-scale) tells it", f"wall.npy {CAMERA} {{1}} 1", WALL),
    (f"wall.pgm {CAMERA} --depth-scale 1", "(--unit) or (--depth-scale) tells it", f"wall.pgm {CAMERA} {{0}} mm", WALL),
    (f"wall.pgm {CAMERA} --depth-scale 1000 --unit mm", "leave one of them out", f"wall.pgm {CAMERA} --unit mm", WALL),
    (f"wall.pgm {CAMERA} --depth-scale 1000 --unit mm", "leave one of them out", f"wall.pgm {CAMERA} --depth-scale 1000", WALL),
    (f"wall.pgm {CAMERA} --depth-scale 0", "--depth-scale must be finite and greater than 0",
     f"wall.pgm {CAMERA} --depth-scale 1000", WALL),
    (f"wall.pgm {CAMERA} --range 5,1", "give near,far in metres, far greater than near", f"wall.pgm {CAMERA} --range 1,5", WALL),
    (f"wall.pgm {CAMERA} --invalid all", r"such as (\S+), or (none)", f"wall.pgm {CAMERA} --invalid {{0}}", WALL),
    (f"wall.pgm {CAMERA} --invalid all", r"such as (\S+), or (none)", f"wall.pgm {CAMERA} --invalid {{1}}", WALL),
    (f"scale.pfm {CAMERA}", "give (--depth-scale) if depths are not metres", f"scale.pfm {CAMERA} {{0}} 1000", WALL),
    (f"two.exr {CAMERA}", r"its depth: (\S+), \S+; name one of these with (--channel)", f"two.exr {CAMERA} {{1}} {{0}}", WALL),
    (f"two.exr {CAMERA} --channel Z", r"it has (\S+), \S+; name one of these with (--channel)", f"two.exr {CAMERA} {{1}} {{0}}",
     WALL),
    (f"unnamed.exr {CAMERA}", "name the one that is depth with (--channel)", f"unnamed.exr {CAMERA} {{0}} near", WALL),
    (f"wall.png {CAMERA} --channel Z", "--channel is not used", f"wall.png {CAMERA}", WALL),
    (f"wall.png {CAMERA} --flip", "--flip is not used", f"wall.png {CAMERA}", WALL),
    ("away.pcd", r"give (--flip) to turn them", "away.pcd {0}", POINTS),
    ("gl.pcd", r"give (--axes \w+)", "gl.pcd {0}", WALL),
    ("ros.pcd", r"give (--axes \w+)", "ros.pcd {0}", WALL),
    ("grid.pcd --axes ros", r"give (--axes \w+)", "grid.pcd {0}", WALL),
    ("grid.pcd --intrinsics 90,90,31.5,23.5", "leave --intrinsics out to have them recovered", "grid.pcd", WALL),
    ("world.pcd", "need their camera's (--camera-pose), and those of a lidar normals",
     "world.pcd {0} 0,0,0,0,0.25881904510252074,0,0.9659258262890683", None),
    ("lidar.pcd", "need their camera's (--camera-pose), and those of a lidar normals", "lidar_normals.pcd", None),
    ("lidar.pcd --camera-pose 0,0,0.5,0,0,0,1", "points of a lidar need normals",
     "lidar_normals.pcd --camera-pose 0,0,0.5,0,0,0,1", None),
    ("viewpoint.pcd", r"(--camera-pose \S+) leaves the points where they are", "viewpoint.pcd {0}", WALL),
    ("two.pcd", "give tx ty tz qw qx qy qz of a unit quaternion", "<(sed 's/^VIEWPOINT.*/VIEWPOINT 0 0 0 1 0 0 0/' two.pcd)", WALL),
    ("old.pcd", "write version 0.7", "grid.pcd", WALL),
    ("bare.ply", "estimate them first", "points.ply", POINTS),
    ("bare.ply", "or give the depth image", f"wall.pgm {CAMERA}", WALL),
    ("zero.ply", "estimate them first", "points.ply", POINTS),
    ("zero.ply", "or give the depth image", f"wall.pgm {CAMERA}", WALL),
    ("coarse.ply", "write them as double", "double.ply", None),
    ("coarse.ply", "or nearer to the origin", "points.ply", POINTS),
    ("far_point.ply", "leave out those that are far from the others", "points.ply", POINTS),
    *[(f"points.ply {option}", option.split()[0] + " is not used", "points.ply", POINTS)
      for option in (CAMERA, "--invalid 9", "--range 1,5", "--along-ray")],
    ("points.ply --decode swapped", "--decode is not used", "points.ply", POINTS),
    ("points.ply --flip", "leave (--flip) out", "points.ply", POINTS),
    ("grid.pcd --along-ray", "--along-ray is not used", "grid.pcd", None),
    (f"swapped.pgm {CAMERA}", "(--decode big-endian) reads them", f"swapped.pgm {CAMERA} {{0}}", None),
    (f"steps.pgm {CAMERA}", "give (--decode swapped)", f"steps.pgm {CAMERA} {{0}}", None),
    (f"wall.png {CAMERA} --decode big-endian", "--decode big-endian is not used", f"wall.png {CAMERA}", WALL),
    (f"wall.pgm {CAMERA} --decode swapped,big-endian", "exclude each other: leave one of them out",
     f"wall.pgm {CAMERA} --decode big-endian", WALL),
    ("wall.pgm --intrinsics both.json", r"give (--intrinsics [\d.,]*\d), its P", "wall.pgm {0}", None),
    ("wall.pgm --intrinsics region.json", r"give (--intrinsics [\d.,]*\d)", "wall.pgm {0}", WALL),
    ("wall.pgm --intrinsics shape.json", "give the intrinsics of this image", f"wall.pgm {CAMERA}", WALL),
    (f"wall.pgm {CAMERA} --axes opengl", r"(--camera-pose \S+) gives it the others",
     f"wall.pgm {CAMERA} --axes opengl {{0}}", None),
    (f"wall.pgm {CAMERA} --range 100,5000", "all outside of --range, which is in metres", f"wall.pgm {CAMERA} --range 0.1,5", WALL),
    (f"white.pgm {CAMERA}", r"(--invalid), --decode and --unit tell what they mean", f"white.pgm {CAMERA} {{0}} none", None),
    (f"wall.pgm {CAMERA} --depth-scale 0.001", r"if a unit is 0.001 m, give (\d+)", f"wall.pgm {CAMERA} --depth-scale {{0}}", WALL),
    *[(f"{name} {CAMERA}", f"unpack it first{how}", f"<(python3 unpack.py {name}) {CAMERA}", WALL)
      for name, how in [("wall.pgm.gz", ": gunzip"), ("wall.pgm.bz2", ": bunzip2"), ("wall.pgm.xz", ": unxz"), ("wall.zip", "")]],
    (f"wall.zip {CAMERA}", "of an npz, save one array as .npy", f"wall.npy {CAMERA}", WALL),
    ("empty.pgm", "give a depth image or a cloud", f"wall.pgm {CAMERA}", WALL),
    ("cube.off", "give a depth image or a cloud", "points.ply", POINTS),
    ("", "name a file, or (-) for a pipe", f"{{0}} {CAMERA} < wall.pgm", WALL),
    ("", "name a file, or (-) for a pipe", f"wall.pgm {CAMERA}", WALL),
    (f"wall.pgm {CAMERA} --camera-pose two_poses.txt", "give a file with the one of this image, or its numbers",
     f"wall.pgm {CAMERA} --camera-pose one_pose.txt", WALL),
    (f"wall.pgm {CAMERA} --camera-pose two_poses.txt", "give a file with the one of this image, or its numbers",
     f"wall.pgm {CAMERA} --camera-pose 0,0,0,0,0,0,1", WALL),
    (f"wall.pgm {CAMERA} --camera-pose mirror.txt", "give a proper rotation", f"wall.pgm {CAMERA} --camera-pose pose.txt", None),
    (f"wall.pgm {CAMERA} --camera-pose 0,0,0,0,0,0,2", "give x,y,z,w of a unit quaternion",
     f"wall.pgm {CAMERA} --camera-pose 0,0,0,0,0,0,1", WALL),
    (f"wall.pgm {CAMERA} --camera-pose 0,0,0", "expected 7 numbers tx,ty,tz,qx,qy,qz,qw",
     f"wall.pgm {CAMERA} --camera-pose 0,0,0,0,0,0,1", WALL),
    (f"wall.pgm {CAMERA} --window 011", "begins with a zero; write it without", f"wall.pgm {CAMERA} --window 11", WALL),
    (f"wall.pgm {CAMERA} --window 8", "the window must be odd and between 3 and (31)", f"wall.pgm {CAMERA} --window {{0}}", WALL),
    (f"wall.pgm {CAMERA} --method svd", r"not in \{inverse-depth,(pca)\}", f"wall.pgm {CAMERA} --method {{0}}", WALL),
    (f"wall.pgm {CAMERA} --axes maya", r"not in \{(opencv),opengl,ros\}", f"wall.pgm {CAMERA} --axes {{0}}", WALL),
    (f"wall.pgm {CAMERA} --unit km", r"not in \{m,cm,(mm),um,in,ft\}", f"wall.pgm {CAMERA} --unit {{0}}", WALL),
]

# Row: command; advice; command that follows it; volume, if it asks for one; relative tolerance.
COMMANDS = [
    # Outputs
    ("vpm-pack small.off", r"give (-o OUT.vpmp), (--export), (--report) or (--view)",
     "vpm-pack small.off --spheres 5 -o out.vpmp"),
    ("vpm-pack small.off", r"give (-o OUT.vpmp), (--export), (--report) or (--view)",
     "vpm-pack small.off --spheres 5 {1} out.csv"),
    ("vpm-pack small.off", r"give (-o OUT.vpmp), (--export), (--report) or (--view)",
     "vpm-pack small.off --spheres 5 {2} out.json"),
    ("vpm-pack small.off", r"give (-o OUT.vpmp), (--export), (--report) or (--view)",
     "vpm-pack small.off --spheres 5 {3} out.html"),
    (f"vpm-normals wall.pgm {CAMERA}", r"give (-o OUT.vpmc), (--export), (--report) or (--view)",
     f"vpm-normals wall.pgm {CAMERA} -o out.vpmc"),
    (f"vpm-normals wall.pgm {CAMERA}", r"give (-o OUT.vpmc), (--export), (--report) or (--view)",
     f"vpm-normals wall.pgm {CAMERA} {{1}} out.ply"),
    (f"vpm-normals wall.pgm {CAMERA}", r"give (-o OUT.vpmc), (--export), (--report) or (--view)",
     f"vpm-normals wall.pgm {CAMERA} {{3}} out.html"),
    (f"vpm-normals wall.pgm {CAMERA} --export out.xyz", r"must end in (\.ply) or (\.pcd)",
     f"vpm-normals wall.pgm {CAMERA} --export out{{0}} && vpm-normals wall.pgm {CAMERA} --export out{{1}}"),
    ("vpm-pack small.off --spheres 5 --export out.xyz",
     r"must end with (\S+), (\S+), (\S+) \((\S+)\), (\S+), (\S+), (\S+) \((\S+)\), (\S+) or (\S+)",
     "for e in {0} {1} {2} {3} {4} {5} {6} {7} {8} {9}; do vpm-pack small.off --spheres 5 --export out$e || exit; done"),
    (f"{TOOL} --pose {POSE} --spheres-out out.xyz", r"must end in (\S+), (\S+) \(balls\), (\S+) or (\S+)",
     f"for e in {{0}} {{1}} {{2}} {{3}}; do {TOOL} --pose {POSE} --spheres-out out$e || exit; done", WALL),
    ("vpm-pack small.off --spheres 5 -o cube.vpmp", r"name another output", "vpm-pack small.off --spheres 5 -o out.vpmp"),
    ("cp small.off outsmall.off && vpm-pack small.off --spheres 5 --report outsmall.off", r"give (--force) to overwrite it",
     "cp small.off outsmall.off && vpm-pack small.off --spheres 5 --report outsmall.off {0}"),
    ("vpm-pack small.off --spheres 5 --report small.off", r"name another output, or give (--force)",
     "vpm-pack small.off --spheres 5 --report out.json"),
    ("cp small.off out.off && vpm-pack out.off --spheres 5 --report out.off", r"name another output, or give (--force)",
     "cp small.off out.off && vpm-pack out.off --spheres 5 --report out.off {0}"),
    ("vpm-pack small.off --spheres 5 -o out.stl", r"let its name end in (\.vpmp), or give (--force)",
     "vpm-pack small.off --spheres 5 -o out{0}"),
    ("vpm-pack small.off --spheres 5 -o out.stl", r"let its name end in (\.vpmp), or give (--force)",
     "vpm-pack small.off --spheres 5 -o out.stl {1}"),
    ("vpm-graph cube.vpmp -o out.vpmp", r"let its name end in (\.vpmg)", "vpm-graph cube.vpmp -o out{0}"),
    (f"vpm-normals wall.pgm {CAMERA} -o out.pcd", r"let its name end in (\.vpmc)", f"vpm-normals wall.pgm {CAMERA} -o out{{0}}"),
    (f"{TOOL} --pose {POSE} -o out.vpmc", r"name it (\.json) or (\.jsonl), or give (--force)",
     f"for e in {{0}} {{1}} '.vpmc {{2}}'; do {TOOL} --pose {POSE} -o out$e || exit; done"),
    (f"{TOOL} --pose {POSE} --view out.vpmc", r"let its name end in (\.html)", f"{TOOL} --pose {POSE} --view out{{0}}", WALL),
    (f"{TOOL} --pose {POSE} --view out.json", r"or give (--force)", f"{TOOL} --pose {POSE} --view out.json {{0}}", WALL),
    ("vpm-pack small.off --spheres 5 --report out.json --export ./out.json", "name two files",
     "vpm-pack small.off --spheres 5 --report out.json --export ./out.csv"),
    ("vpm-graph cube.vpmp -o - --report -", "only one output can be standard output",
     "vpm-graph cube.vpmp -o - --report out.json | head -c 0; vpm-graph cube.vpmp -o out.vpmg --report -"),
    ("vpm-pack small.off --spheres 5 -o .", "name a file", "vpm-pack small.off --spheres 5 -o out.vpmp"),
    ("vpm-pack small.off --spheres 5 -o outs/a.vpmp", r"there is no folder (\S+)",
     "mkdir -p {0} && vpm-pack small.off --spheres 5 -o outs/a.vpmp && rm -r outs"),
    ("vpm-pack small.off --spheres 5 -o out.vpmp --link hand",
     r"name in (\S+), (\S+) and (\S+); give (--export) with one of these",
     "for e in {0} {1} {2}; do vpm-pack small.off --spheres 5 --link hand {3} out$e || exit; done"),
    # Options and configurations
    ("vpm-pack small.off --spheres 5 -o out.vpmp --report=", r"give one, or leave the option out",
     "vpm-pack small.off --spheres 5 -o out.vpmp --report=out.json"),
    ("vpm-pack small.off --spheres 5 -o out.vpmp --report ''", r"give one, or leave the option out",
     "vpm-pack small.off --spheres 5 -o out.vpmp"),
    ("vpm-pack small.off --spheres 5 -o out.vpmp --grow=true", r"takes no value; leave out (\S+)",
     "c='vpm-pack small.off --spheres 5 -o out.vpmp --grow=true'; ${c%{0}}"),
    ("vpm-graph cube.vpmp -o out.vpmg --levels 010", "begins with a zero; write it without",
     "vpm-graph cube.vpmp -o out.vpmg --levels 10"),
    ("vpm-pack small.off --spheres -5 -o out.vpmp", r"is not a whole number from (\d+) to",
     "vpm-pack small.off --spheres {0} -o out.vpmp"),
    ("vpm-pack small.off --spheres 5 -o out.vpmp --threads -1", r"is not a whole number from \d+ to (\d+)",
     "vpm-pack small.off --spheres 5 -o out.vpmp --threads {0}"),
    ("vpm-graph cube.vpmp -o out.vpmg --epsilon 1mm", "is not a number greater than 0",
     "vpm-graph cube.vpmp -o out.vpmg --epsilon 0.001"),
    ("vpm-graph cube.vpmp", "--output is required", "vpm-graph cube.vpmp --output out.vpmg"),
    ("echo '{\"sphere\": 5}' | vpm-pack small.off -o out.vpmp --config -",
     r"there is no option 'sphere' \(see (vpm-pack --help)\)",
     "{0} | grep -q -- --spheres && echo '{\"spheres\": 5}' | vpm-pack small.off -o out.vpmp --config -"),
    ("echo '{\"grow\": 2}' | vpm-pack small.off --spheres 5 -o out.vpmp --config -", r"must be (true) or false",
     "echo '{\"grow\": {0}}' | vpm-pack small.off --spheres 5 -o out.vpmp --config -"),
    ("echo '[1]' | vpm-pack small.off --spheres 5 -o out.vpmp --config -", "must be a JSON object of options",
     "echo '{}' | vpm-pack small.off --spheres 5 -o out.vpmp --config -"),
    ("echo '{\"spheres\": {\"a\": 1}}' | vpm-pack small.off -o out.vpmp --config -",
     "must be a number, a string, true, false or a list",
     "for v in 5 '\"5\"' '[5]'; do "
     "echo \"{\\\"spheres\\\": $v}\" | vpm-pack small.off -o out.vpmp --config - --force || exit; done"),
    ("echo '{\"grow\": true, \"grow\": true}' | vpm-pack small.off --spheres 5 -o out.vpmp --config -",
     "twice; leave one of them out", "echo '{\"grow\": true}' | vpm-pack small.off --spheres 5 -o out.vpmp --config -"),
    ("vpm-pack small.off --spheres 5 -o out.vpmp --config nosuch.json", "--config: cannot read nosuch.json",
     "vpm-pack small.off --spheres 5 -o out.vpmp"),
    # Devices
    ("vpm-graph cube.vpmp -o out.vpmg --device cuda:999", "use (--device cpu), or leave the option out",
     "vpm-graph cube.vpmp -o out.vpmg {0}"),
    ("vpm-graph cube.vpmp -o out.vpmg --device cuda:999", "use --device cpu, or leave the option out",
     "vpm-graph cube.vpmp -o out.vpmg"),
    (f"{TOOL} --pose {POSE} --device cuda:999", "use (--device cpu), or leave the option out", f"{TOOL} --pose {POSE} {{0}}",
     WALL),
    ("vpm-graph cube.vpmp -o out.vpmg --device gpu", r"not in \{auto,(cpu),", "vpm-graph cube.vpmp -o out.vpmg --device {0}"),
    ("vpm-bench timing --quick --quiet --out out --device cuda", r"use (--device cpu)", None),
    # Files of other kinds, and damaged ones
    ("vpm-graph small.off -o out.vpmg", "needed is a packing .*, which (vpm-pack) writes",
     "{0} small.off -o - --spheres 5 | vpm-graph - -o out.vpmg"),
    ("vpm-query --tool cube.vpmp --cloud wall.vpmc --poses poses.txt", "needed is a tool model .*, which (vpm-graph) writes",
     "{0} cube.vpmp -o - | vpm-query --tool - --cloud wall.vpmc --poses poses.txt", WALL),
    ("vpm-query --tool small.vpmg --cloud wall.pgm --poses poses.txt", "needed is a cloud .*, which (vpm-normals) writes",
     f"{{0}} wall.pgm {CAMERA} -o - | vpm-query --tool small.vpmg --cloud - --poses poses.txt", WALL),
    ("vpm-normals wall.vpmc -o out.vpmc", "it is ready for (vpm-query)",
     f"{{0}} --tool small.vpmg --cloud wall.vpmc --pose {POSE}", WALL),
    ("vpm-pack cube.vpmp -o out.vpmp", "it is ready for (vpm-graph)", "{0} cube.vpmp -o out.vpmg"),
    ("vpm-pack small.vpmg -o out.vpmp", "it is ready for (vpm-query)", f"{{0}} --tool small.vpmg --cloud wall.vpmc --pose {POSE}",
     WALL),
    ("vpm-pack wall.png -o out.vpmp", "give the mesh, or a cloud and images to (vpm-normals)",
     f"{{0}} wall.png {CAMERA} -o out.vpmc"),
    ("vpm-pack grid.pcd -o out.vpmp", "give the mesh, or a cloud and images to (vpm-normals)", "{0} grid.pcd -o out.vpmc"),
    ("head -c 300 cube.vpmp | vpm-graph - -o out.vpmg", "copy or make the file again", "vpm-graph cube.vpmp -o out.vpmg"),
    ("sed 's/$/\\r/' cube.vpmp | vpm-graph - -o out.vpmg", "copy the file as binary", "vpm-graph cube.vpmp -o out.vpmg"),
    ("(head -c 8 cube.vpmp; printf '\\2'; tail -c +10 cube.vpmp) | vpm-graph - -o out.vpmg",
     "use a newer vpm, or make the file again with this one", "vpm-pack small.off --spheres 5 -o - | vpm-graph - -o out.vpmg"),
    *[(f"vpm-pack start{k} -o out.vpmp", re.escape(advice), None) for k, (start, advice) in enumerate(STARTS.items())
      if start not in SCAN_STARTS],
    *[(f"vpm-normals start{k} -o out.vpmc", re.escape(advice), None) for k, (start, advice) in enumerate(STARTS.items())
      if start not in MESH_STARTS],
    *[(f"vpm-pack start{k} -o out.vpmp", "give the mesh, or a cloud and images to vpm-normals", None)
      for k, start in enumerate(STARTS) if start in SCAN_STARTS],
    *[(f"vpm-normals start{k} -o out.vpmc", "give a depth image or a cloud, or the mesh to vpm-pack", None)
      for k, start in enumerate(STARTS) if start in MESH_STARTS],
    # Tool models
    ("vpm-graph cube.vpmp -o out.vpmg --mesh other.off", "pack this mesh, or leave --mesh out",
     "vpm-pack other.off --spheres 5 -o - | vpm-graph - -o out.vpmg --mesh other.off"),
    ("vpm-graph cube.vpmp -o out.vpmg --mesh other.off", "pack this mesh, or leave --mesh out", "vpm-graph cube.vpmp -o out.vpmg"),
    ("vpm-graph - -o out.vpmg --mesh - < cube.vpmp", "only one of the packing and --mesh can be standard input",
     "vpm-graph - -o out.vpmg --mesh small.off < cube.vpmp"),
    ("vpm-pack - --spheres 5 -o out.vpmp --for-scene - < small.off", "only one of the mesh and --for-scene can be standard input",
     "vpm-pack - --spheres 5 -o out.vpmp --for-scene wall.vpmc < small.off"),
    (f"{TOOL} --pose {POSE} --level 33", r"it has (\d+)", f"{TOOL} --pose {POSE} --level {{0}}"),
    (f"vpm-query --tool plain.vpmg --cloud wall.vpmc --pose {POSE} --max-error 5%", r"make it again with vpm-graph (--calibrate)",
     f"vpm-graph cube.vpmp --levels 10 {{0}} -o - | vpm-query --tool - --cloud wall.vpmc --pose {POSE} --max-error 50%"),
    (f"vpm-query --tool single.vpmg --cloud wall.vpmc --pose {POSE} --max-error 5%", r"make it again with vpm-graph (--levels)",
     f"vpm-graph cube.vpmp {{0}} 10 --calibrate -o - | vpm-query --tool - --cloud wall.vpmc --pose {POSE} --max-error 50%"),
    (f"vpm-query --tool single.vpmg --cloud wall.vpmc --pose {POSE} --deadline-us 1e6", r"make it again with vpm-graph (--levels)",
     f"vpm-graph cube.vpmp {{0}} 10 -o - | vpm-query --tool - --cloud wall.vpmc --pose {POSE} --deadline-us 1e6"),
    (f"{TOOL} --pose {POSE} --max-error 1e-6", r"the best has (\S+) (%): allow as much",
     f"{TOOL} --pose {POSE} --max-error {{0}}{{1}}"),
    (f"{TOOL} --pose {POSE} --max-error 0.5%", r"or pack more spheres",
     "vpm-pack small.off --spheres 2000 -o - | vpm-graph - --levels 1000 --calibrate -o out.vpmg && "
     f"vpm-query --tool out.vpmg --cloud wall.vpmc --pose {POSE} --max-error 0.5%",
     WALL, ROUGH),
    (f"{TOOL} --pose {POSE} --max-error 5%%", r"like (\S+) or (\S+)",
     f"for e in 50% 0.5; do {TOOL} --pose {POSE} --max-error $e || exit; done"),
    (f"{TOOL} --pose {POSE} --max-error 120%", "must lie between 0 and 1", f"{TOOL} --pose {POSE} --max-error 50%"),
    (f"{TOOL} --pose {POSE} --max-error 50% --measure paper", "leave (--measure paper) out",
     f"{TOOL} --pose {POSE} --max-error 50%"),
    (f"{TOOL} --pose {POSE} --deadline-us 0", "must be a positive number of microseconds",
     f"{TOOL} --pose {POSE} --deadline-us 1e6"),
    # Pairs of options, and modes
    ("vpm-query --cloud wall.vpmc --poses poses.txt", "--tool is missing: give the .vpmg that (vpm-graph) wrote",
     "{0} cube.vpmp -o out.vpmg && vpm-query --tool out.vpmg --cloud wall.vpmc --poses poses.txt", WALL),
    ("vpm-query --tool small.vpmg --poses poses.txt", "give the .vpmc that (vpm-normals) wrote, or --frames",
     f"{{0}} wall.pgm {CAMERA} -o out.vpmc && vpm-query --tool small.vpmg --cloud out.vpmc --poses poses.txt", WALL),
    ("vpm-query --tool small.vpmg --poses poses.txt", "the .vpmc that vpm-normals wrote, or (--frames)",
     f"{STEPS} {{0}} steps --trajectory poses.txt"),
    (TOOL, "(--pose) or (--poses) is missing: give one of them", f"{TOOL} {{0}} {POSE}", WALL),
    (TOOL, "(--pose) or (--poses) is missing: give one of them", f"{TOOL} {{1}} poses.txt", WALL),
    (f"{TOOL} --stiffness 2e4 --coupling stiffness=500,damping=5", "(--poses) is missing: give the path of the haptic device",
     f"{TOOL} --stiffness 2e4 --coupling stiffness=500,damping=5 {{0}} device.txt"),
    (f"{STEPS} --frames steps", "(--trajectory) is missing: give the path of the tool", f"{STEPS} --frames steps {{0}} still.txt"),
    *[(f"{TOOL} {first} {second}", f"{first.split()[0]} and {second.split()[0]} exclude each other: leave one of them out",
       f"{TOOL} {left} {more}")
      for first, second, more in [
          (f"--pose {POSE}", "--poses poses.txt", ""), ("--level 30", "--max-error 50%", f"--pose {POSE}"),
          ("--level 30", "--for-scene", f"--pose {POSE}"), ("--max-error 50%", "--for-scene", f"--pose {POSE}"),
          ("--level 30", "--deadline-us 1e6", f"--pose {POSE}"), ("--coherent", "--deadline-us 1e6", f"--pose {POSE}")]
      for left in (first, second)],
    *[(f"{STEPS} --frames plain --trajectory still.txt --camera-pose {POSE} --camera-poses camera_path.txt",
       "leave one of them out",
       f"{STEPS} --frames plain --trajectory still.txt {left}") for left in (f"--camera-pose {POSE}",
       "--camera-poses camera_path.txt")],
    (f"{TOOL} --poses poses.txt --window 9", "does not go with poses in a cloud, .*: leave it out", f"{TOOL} --poses poses.txt",
     WALL),
    (f"{TOOL} --poses poses.txt --window 9 --rate 5", "do not go with poses in a cloud, .*: leave them out",
     f"{TOOL} --poses poses.txt", WALL),
    (f"{TOOL} --poses poses.txt --coherent --batch 2", "poses in batches, chosen by (--batch): leave it out",
     f"{TOOL} --poses poses.txt --batch 2", WALL),
    (f"{COUPLED} --coupling stiffness=500,damping=5 --batch 2", "chosen by --coupling without --frames: leave it out",
     f"{COUPLED} --coupling stiffness=500,damping=5"),
    (f"{STEPS} --frames steps --trajectory still.txt --cloud wall.vpmc", "recorded frames, chosen by --frames: leave it out",
     f"{STEPS} --frames steps --trajectory still.txt"),
    (f"{TOOL} --tool single.vpmg --poses poses.txt --coherent", "chosen by more than one --tool: leave it out",
     f"{TOOL} --tool single.vpmg --poses poses.txt"),
    (f"{TOOL} --poses poses.txt --coherent --measure paper", "leave the other measure or device out",
     f"{TOOL} --poses poses.txt --coherent", WALL),
    (f"{TOOL} --poses poses.txt --shadows solid --measure paper", "leave the other measure out",
     f"{TOOL} --poses poses.txt --shadows solid", WALL),
    (f"{TOOL} --poses poses.txt --reuse 0.001", r"is gone: leave it out; a coarser (--level)",
     f"{TOOL} --poses poses.txt {{0}} 30"),
    (f"{TOOL} --poses poses.txt --standby-us 9", "is gone: leave it out", f"{TOOL} --poses poses.txt", WALL),
    ("vpm-query --tool - --cloud - --poses poses.txt",
     "only one of --tool, --cloud, --poses and --trajectory can be standard input",
     "vpm-query --tool small.vpmg --cloud - --poses poses.txt < wall.vpmc", WALL),
    # Couplings
    (COUPLED.replace(" --stiffness 2e4", "") + " --coupling stiffness=500,damping=5",
     r"needs (--stiffness): give the scene's stiffness",
     COUPLED.replace(" --stiffness 2e4", "") + " --coupling stiffness=500,damping=5 {0} 2e4"),
    (f"{COUPLED} --coupling stiffness=500", r"give stiffness=N/m,damping=N s/m and, if wanted, mass=kg,rate=Hz",
     f"{COUPLED} --coupling stiffness=500,damping=5,mass=0.0125,rate=1000"),
    (f"{COUPLED.replace('2e4', '1e7')} --coupling stiffness=500,damping=5",
     r"take (rate=\d+) or more, a larger mass, or less --stiffness",
     f"{COUPLED.replace('2e4', '1e7')} --coupling stiffness=500,damping=5,{{0}}"),
    (f"{COUPLED.replace('2e4', '1e7')} --coupling stiffness=500,damping=5", r"a larger mass, or less --stiffness",
     f"{COUPLED.replace('2e4', '1e7')} --coupling stiffness=500,damping=5,mass=1"),
    (f"{COUPLED.replace('2e4', '1e7')} --coupling stiffness=500,damping=5", r"a larger mass, or less --stiffness",
     f"{COUPLED} --coupling stiffness=500,damping=5"),
    (f"{STEPS} --frames steps --trajectory still.txt --stiffness 2e4 --coupling stiffness=500,damping=5,rate=500 --rate 1000",
     "--rate and the rate of --coupling differ; give one of them",
     f"{STEPS} --frames steps --trajectory still.txt --stiffness 2e4 --coupling stiffness=500,damping=5,rate=500"),
    (f"{STEPS} --frames steps --trajectory still.txt --stiffness 2e4 --coupling stiffness=500,damping=5,rate=500 --rate 1000",
     "--rate and the rate of --coupling differ; give one of them",
     f"{STEPS} --frames steps --trajectory still.txt --stiffness 2e4 --coupling stiffness=500,damping=5 --rate 1000"),
    # Poses
    *[(f"{TOOL} --poses none.txt", "each line gives one: tx ty tz qx qy qz qw, or JSON", f"{TOOL} --poses {name}", WALL)
      for name in ("poses.txt", "pose.jsonl")],
    *[(f"{TOOL} --poses {bad}", r"a pose has 7 \(tx ty tz qx qy qz qw\), 8 \(with a time before them\) or 16 \(4x4, row by row\)",
       f"{TOOL} --poses {good}", WALL) for bad in ("six.txt", "nine.txt") for good in ("poses.txt", "timed.txt",
       "matrix_pose.txt")],
    (f"{TOOL} --poses comma.txt", "number 3 is missing: nothing stands between the commas",
     f"{TOOL} --poses <(sed 's/,,/,/' comma.txt)", WALL),
    (f"{TOOL} --poses long.txt", "give x,y,z,w of a unit quaternion", f"{TOOL} --poses <(sed 's/2$/1/' long.txt)", WALL),
    (f"{TOOL} --poses header_six.txt", r"found 6 numbers where the line of names has (\d)", f"{TOOL} --poses header.txt", WALL),
    (f"{TOOL} --poses split.jsonl", "a line must be one whole pose", f"{TOOL} --poses <(tr -d '\\n' < split.jsonl)", WALL),
    *[(f"{TOOL} --poses nameless.jsonl", 'neither \\"(pose)\\" nor \\"(matrix)\\"',
       f"{TOOL} --poses <(sed 's/place/pose/' nameless.jsonl)",
       WALL)],
    (f"{COUPLED.replace('device.txt', 'back.txt')} --coupling stiffness=500,damping=5", "times must ascend",
     f"{COUPLED.replace('device.txt', '<(sort back.txt)')} --coupling stiffness=500,damping=5"),
    (f"{COUPLED.replace('device.txt', 'some_timed.txt')} --coupling stiffness=500,damping=5",
     "either every pose has a time or none",
     f"{COUPLED.replace('device.txt', 'timed.txt')} --coupling stiffness=500,damping=5"),
    # Scenes and tools that do not meet
    (f"{TOOL} --poses inverted.txt", "it would be there if the poses are inverted", f"{TOOL} --poses poses.txt", WALL),
    (f"vpm-normals wall.pgm {CAMERA} --camera-pose 0,0,-3,0,0,0,1 -o - | "
     "vpm-query --tool small.vpmg --cloud - --pose 0,0,3.95,0,0,0,1",
     "it would be there if the camera's pose is inverted: vpm-normals (--camera-pose) must map the camera's coordinates to the world's",
     f"vpm-normals wall.pgm {CAMERA} {{0}} 0,0,3,0,0,0,1 -o - | vpm-query --tool small.vpmg --cloud - --pose 0,0,3.95,0,0,0,1",
     WALL),
    (f"vpm-normals wall.pgm {CAMERA} --camera-pose 4,0,0,0,0,0,1 -o - | vpm-query --tool small.vpmg --cloud - --poses poses.txt",
     "if the poses are in the camera's frame: leave vpm-normals --camera-pose out",
     f"vpm-normals wall.pgm {CAMERA} -o - | vpm-query --tool small.vpmg --cloud - --poses poses.txt", WALL),
    (f"{TOOL} --poses poses_mm.txt", "are poses and scene in the same frame and unit", f"{TOOL} --poses poses.txt", WALL),
    (f"vpm-query --tool large.vpmg --cloud wall.vpmc --pose {POSE}", "vpm-pack (--scale) and vpm-normals --unit tell them",
     f"vpm-pack small_mm.off {{0}} 0.001 -o - | vpm-graph - -o - | vpm-query --tool - --cloud wall.vpmc --pose {POSE}", WALL,
     ROUGH),
    (f"vpm-normals wall.pgm {CAMERA} --unit um -o - | vpm-query --tool small.vpmg --cloud - --pose {POSE}",
     "vpm-pack --scale and vpm-normals (--unit) tell them",
     f"vpm-normals wall.pgm {CAMERA} {{0}} mm -o - | vpm-query --tool small.vpmg --cloud - --pose {POSE}", WALL),
    # Recordings
    (f"{STEPS} --frames tum --trajectory still.txt", r"(--align-starts) lets both begin together",
     f"{STEPS} --frames tum --trajectory still.txt {{0}}"),
    (f"{STEPS} --frames bare --trajectory still.txt", r"wanted are (\.png), .* or depth.txt with",
     f"{STEPS} --frames steps --trajectory still.txt"),
    (f"{STEPS} --frames named --trajectory still.txt", r'give a list of "time file" lines instead',
     f"{STEPS} --frames named.txt --trajectory still.txt"),
    (f"{STEPS} --frames twice --trajectory still.txt", r'give a list of "time file" lines',
     f"{STEPS} --frames twice.txt --trajectory still.txt"),
    (f"{STEPS} --frames plain --trajectory still.txt --camera-poses camera_two.txt", "give one for each, or times",
     f"{STEPS} --frames plain --trajectory still.txt --camera-poses camera_path.txt"),
    (f"{STEPS} --frames plain --trajectory still.txt --camera-poses camera_two.txt", "give one for each, or times",
     f"{STEPS} --frames plain --trajectory still.txt --camera-poses timed.txt"),
    (f"vpm-query --tool small.vpmg {CAMERA} --frames plain --trajectory still.txt",
     "has no poses of it, and no (--camera-poses) are given",
     f"vpm-query --tool small.vpmg {CAMERA} --frames plain --trajectory still.txt {{0}} camera_path.txt"),
    (f"{STEPS} --frames named.txt --trajectory still.txt --repeat-frames", "leave (--repeat-frames) out, or give more frames",
     f"{STEPS} --frames named.txt --trajectory still.txt"),
    (f"{STEPS} --frames named.txt --trajectory still.txt --repeat-frames", "leave (--repeat-frames) out, or give more frames",
     f"{STEPS} --frames plain --trajectory still.txt --repeat-frames"),
    (f"{STEPS} --frames plain --trajectory ms.txt", "are its times seconds", f"{STEPS} --frames plain --trajectory timed.txt"),
    # Benchmarks, whose suites take minutes: bench.t and the tests of vpm-bench run them.
    ("vpm-bench speed", "the suites are accuracy, extremes", None),
    ("vpm-bench", "name a suite; the suites are", None),
    ("vpm-bench timing --noise-seed 3", "takes no --noise-seed, which is for accuracy; leave it out", None),
    ("vpm-bench extremes --quick --quiet --out outs/today", "correct its name, or make the folder above it", None),
    ("vpm-bench accuracy --quick --data .", "accuracy asks recorded images with --all only; give it, too", None),
    ("vpm-bench accuracy --all --data .", "leave --data away to do without", None),
]

# Texts of the sources that advise something, and that no row can meet here: reason, and the texts.
UNTRIED = [
    ("says how it is, and asks for nothing", [
        "--camera-pose: its rotation is not exact and has been normalised", "--levels: the packing has",
        "is seen from --camera-pose", "no further sphere of at least --min-radius fits",
        "times the volume of the solid, so they overlap or leave it",
    ]),
    ("a help text, a command, or the name of an option that takes the place of another word", [
        "Measure accuracy and speed; write JSON and CSV", "--meshes MESHES", "--data DATA",
        "depend on the machine's speed. Wins over --max-error and --for-scene",
        "replay: or a recording with camera-intrinsics.txt, as for vpm-query --frames",
        "vpm-normals --intrinsics", "vpm-pack --weld", "vpm-pack --repair", "vpm-pack --max-hole",
    ]),
    ("stands in a page of --view: tests/view", [
        "No camera sees the tool's centre at any pose. Poses map the tool to the world (x right, y down, z forward from a camera "
        "without --camera-pose): is one of them inverted, or in millimetres?",
    ]),
    ("for programs that call the library", [
        "make its rotation with rotation_from_matrix or rotation_from_quaternion",
        "make it with rotation_from_matrix or rotation_from_quaternion", "make their queries with the same options",
        "an image has pixels: give its size", "write to metres()", "write to counts()", "repair the mesh",
    ]),
    ("said by a build without a library, or with CUDA", [
        "build with VPM_EXR=ON, or convert the image to a 16-bit PNG", "build it where yaml-cpp is installed, or give the numbers",
        "build it where libtiff is installed, or convert the image to a 16-bit PNG", "save it as OBJ, OFF, PLY or STL",
        "--view: this build draws no pages, because three.js was not found; install it (Debian: libjs-three) and build again",
        "scaling: this build has no CUDA; build with cmake --preset cuda", "levels; make the model anew with vpm-graph",
        "scaling times one CUDA device; use --device cuda or cuda:N, or leave the option out", "use `device` cpu if this persists",
        "); use --device cpu, or leave the option out", "computes on the CPU only; use --device cpu, or leave the option out",
    ]),
    ("needs a file of vpm that no tool writes: tests/formats, tests/graph, tests/model", [
        "must hold one record; make the file again", "chunk TOOL must hold one record; make the file again", "pack the mesh again",
        ", which is no number; pack the mesh again, or leave --mesh out", "choose one of the size of the gaps between them",
    ]),
    ("takes a large input, or many seconds: tests/mesh/broad_phase_test.cpp, tests/faults", [
        "delete doubled or tangled parts, or give `repair` voxel for a new surface",
        "delete doubled or inner parts, or pack the parts one by one", "crop it", "crop it, or take every second one",
        "export: too many spheres for the 32-bit indices of balls; use .points.ply",
        "bytes, the most that is read of a pipe or device; give a file instead",
        "); allow more processes (ulimit -u) or more memory (ulimit -v)", "there is no memory; allow more (ulimit -v)",
    ]),
    ("needs a writer that is not here, or a fault of vpm-pack", [
        "its pixels are deep, with many values each; flatten it first",
        "at most; it is damaged, or store it with less compression",
        "store it with less compression if it is sound", "save the mesh without other properties",
        "save it again with a newer OpenMesh", "Give `repair` voxel", "This is a bug of `pack`: please report it with the mesh",
    ]),
]

# Literals of C++, joined where they stand one after the other.
LITERALS = re.compile(r'"(?:[^"\\\n]|\\.)*"(?:\s*"(?:[^"\\\n]|\\.)*")*')
# A text advises something if it names an option, as the tools or the library write it, or if a part of it begins with a verb
# that asks.
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+|`[a-z_]+`")
ASKS = re.compile(r"(?:^|[;:,] |\bor )(?:[Gg]ive|use|leave|name|make|save|write|allow|take|convert|unpack|export|correct|choose"
                  r"|fetch|copy|close|mend|delete|pack|estimate|build|install|store|turn|move|let|repair|crop|extract|download"
                  r"|flatten) ")


class Tools:
    def __init__(self, bin_folders, folder):
        self.folder = folder
        self.environment = dict(os.environ, LC_ALL="C", PATH=bin_folders + ":" + os.environ["PATH"])
        self.met = {}  # what each refused command said
        self.lacks_formats = False

    def run(self, command):
        for path in self.folder.glob("out*"):
            if path.is_file():
                path.unlink()
        return subprocess.run(["bash", "-o", "pipefail", "-c", command], cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=SECONDS)

    def must(self, command):
        done = self.run(command)
        if done.returncode != 0:
            raise SystemExit(f"{command} fails: {done.stderr}")
        return done.stdout

    def said(self, command):
        """Returns the exit status and messages of a command, which is run once."""
        if command not in self.met:
            done = self.run(command)
            self.met[command] = (done.returncode, done.stderr)
        return self.met[command]


def last_volume(text):
    """Returns the volume in a report of vpm-pack, or in the last line of vpm-query."""
    try:
        return json.loads(text)["volume_mesh"]
    except (ValueError, KeyError):
        return json.loads(text.splitlines()[-1])["volume"]


def row_faults(tools, command, advice, cure, volume=None, tolerance=1e-3):
    status, said = tools.said(command)
    found = re.search(advice, said)
    if not found:
        if NOT_BUILT.search(said):
            tools.lacks_formats = True
        else:
            yield f"{command}\n  exit status {status}, no advice '{advice}' in: {said}"
        return
    if cure is None:
        return
    cure = re.sub(r"\{(\d)\}", lambda place: found[int(place[1]) + 1], cure)
    done = tools.run(cure)
    if NOT_BUILT.search(done.stderr):
        tools.lacks_formats = True
    elif done.returncode != 0 or re.search(advice, done.stderr):
        yield f"{command}\n  says: {said}  but {cure}\n  exit status {done.returncode}: {done.stderr}"
    elif volume is not None and not abs(last_volume(done.stdout) - volume) <= tolerance * volume:
        yield f"{cure}\n  volume {last_volume(done.stdout)}, expected {volume}"


def rows(volumes):
    """Returns all rows as commands, with numbers for the volumes."""
    for arguments, advice, cured, volume, *tolerance in MESHES:
        yield (f"vpm-pack -o out.vpmp --spheres 20 {arguments}", advice, f"vpm-pack --spheres 20 --report - {cured}", volume,
        *tolerance)
    for arguments, advice, cured, volume, *tolerance in SCANS:
        yield (f"vpm-normals -o out.vpmc {arguments}", advice, f"vpm-normals -o - {cured} | {ASK} --cloud -", volumes.get(volume),
               *tolerance)
    for command, advice, cure, *rest in COMMANDS:
        yield (command, advice, cure, *(volumes.get(x, x) for x in rest))


def advice_in_sources():
    """Returns the texts in the sources that advise something, but for help texts and tables."""
    for path in sorted(p for folder in ("libvpm", "tools") for p in (SOURCE / folder).rglob("*") if p.suffix in (".cpp", ".cu",
    ".h")):
        code = re.sub(r"^\s*#.*$|(?<![:\"])//.*$", "", path.read_text(), flags=re.MULTILINE)
        code = re.sub(r"add_(?:option|flag)\w*\([^;]*;", "", code)
        for literal in LITERALS.findall(code):
            text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', literal)).replace('\\"', '"').strip()
            if " " in text and "|" not in text and (OPTION.search(text) or ASKS.search(text)):
                yield path.name, text


def pattern_of(text):
    """Returns a pattern that finds a text of the sources in a message of the tools."""
    parts = re.split(r"(`[a-z_]+`|%[-+.0-9]*z?[a-z])", text)
    return "".join(r"[-\w =]+" if part.startswith("`") else ".*" if part.startswith("%") else re.escape(part) for part in parts)


def untried_faults(said):
    """Yields advice in the sources that no message in `said` has, and names in UNTRIED that no source has."""
    excused = {text for _, texts in UNTRIED for text in texts}
    found = list(advice_in_sources())
    for name, text in found:
        if text not in excused and not re.search(pattern_of(text), said):
            yield f"{name}: no row meets: {text}"
    for text in excused - {text for _, text in found}:
        yield f"UNTRIED: no source says: {text}"


def make_inputs(tools):
    """Makes tool models and clouds; returns the volumes that sound inputs give."""
    advice_files.write(tools.folder)
    tools.must("vpm-pack small.off -o cube.vpmp --spheres 40 && vpm-graph cube.vpmp -o small.vpmg --levels 10,30 --calibrate")
    tools.must("vpm-graph cube.vpmp -o plain.vpmg --levels 10,30 && vpm-graph cube.vpmp -o single.vpmg --calibrate")
    tools.must("vpm-pack small_mm.off -o - --spheres 20 | vpm-graph - -o large.vpmg")
    return {WALL: last_volume(tools.must(f"vpm-normals wall.pgm {CAMERA} -o wall.vpmc && {ASK} --cloud wall.vpmc")),
            POINTS: last_volume(tools.must(f"vpm-normals points.ply -o points.vpmc && {ASK} --cloud points.vpmc"))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("--row", help="run only rows that hold this text")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tools = Tools(options.bin, pathlib.Path(folder))
        volumes = make_inputs(tools)
        chosen = [row for row in rows(volumes) if not options.row or options.row in str(row)]
        faults = [fault for row in chosen for fault in row_faults(tools, *row)]
        if not options.row and not tools.lacks_formats:
            faults += untried_faults("\n".join(said for _, said in tools.met.values()))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
