#!/usr/bin/env python3
"""Follows the advice of the tools' messages: what a message tells to do must make that input pass.

    advice_test.py --bin DIR[:DIR...] [--row TEXT]

A row of advice_meshes.py, advice_scans.py or advice_commands.py is a command line that is refused or warned, a pattern that
finds the advice in its messages, a command line that follows the advice (`{0}` stands for the first group of the pattern: the
message's own words), and where it gives one the volume that comes out then. The second command must succeed, and say the advice no more. Files named out* are removed before
each command. Messages in the sources that advise something and that no row has met are faults too, except those in UNTRIED.

Inputs are made by advice_files.py. Rows about a format that this build does not read are passed over. --row runs only the rows
that hold TEXT. Exit status: 0 if all agree, 1 otherwise.
"""
import argparse
import json
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

import advice_files
from advice_commands import COMMANDS
from advice_meshes import MESHES
from advice_scans import SCANS
from advice_words import ASK, CAMERA, POINTS, WALL

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SECONDS = 120
NEEDS_SHELL = re.compile(r"[|&;<>()$`*?\[\]{}~#!=\\\n]")  # a command of plain words begins sooner without a shell
NOT_BUILT = re.compile(r"is not read by this build|this build reads no|this build draws no pages")

# Texts of the sources that advise something, and that no row can meet here: reason, and the texts.
UNTRIED = [
    ("says how it is, and asks for nothing", [
        "--camera-pose: its rotation is not exact and has been normalised", "--levels: the packing has",
        "--register: the images disagree by %.2f mm, and disagreed by %.2f mm; they tell %zu of %zu motions of cameras against each other%s",
        "--register: no camera is moved, since one is far from where its pose tells",
        "is seen from --camera-pose", "no further sphere of at least --min-radius fits",
        "times the volume of the solid, so they overlap or leave it",
    ]),
    ("a help text, a command, or the name of an option that takes the place of another word", [
        "input. Or a packing or tool model, whose spheres are written by --export", "chosen by --urdf",
        "Measure accuracy and speed; write JSON and CSV", "--meshes MESHES", "--data DATA",
        "depend on the machine's speed. Wins over --max-error and --for-scene",
        "replay: or a recording with camera-intrinsics.txt, as for vpm-query --frames",
        *(f"vpm-normals --{option}" for option in ("along-ray", "axes", "camera-pose", "channel", "decode", "depth-scale", "flip",
                                                   "intrinsics", "invalid", "range", "unit")),
        "clouds, for vpm-query --frames", "vpm-pack --weld", "vpm-pack --repair", "vpm-pack --max-hole",
    ]),
    ("tells which tool reads a format; a tool that does not says what it wants instead", [
        "give it to vpm-pack", "give it to vpm-normals",
    ]),
    ("for programs that call the library", [
        "make it with `with_force`", "give one for each, or none",
        "make its rotation with rotation_from_matrix or rotation_from_quaternion",
        "make it with rotation_from_matrix or rotation_from_quaternion", "make their queries with the same options",
        "an image has pixels: give its size", "write to metres()", "make it of the depth image", "write to counts()", "repair the mesh", "use the one that it was moved to",
        "leave `deadline_seconds` out, or ask pose by pose", "give a number above 0, in N/m^3",
        "make both with `with_force`, or ask without", "give a closed mesh that is oriented outward",
        "copy them there, or ask a query on their device", "give it `device` cuda", "copy the poses to the host",
        "give 7, or 12 or 16 of a matrix", "`depth_scale` must be finite and greater than 0", "`range` must go from 0 m or more to a farther depth",
    ]),
    ("stands in a transcript: cases/solids.t, resume.t, several_tools.t", [
        "leave that choice out, or add a cloud", "make it again by vpm-graph, without --no-surface",
        "write one for each solid, [[tx,ty,tz,qx,qy,qz,qw], …]",
        "--solid is a file: standard input holds none", ", but --solid is given", 'give one for each, or leave "solids" out',
        "holds lines of a run that was interrupted: give --resume to go on after", "them, or --force to begin anew",
        "give the same options and files, or --force without --resume to begin anew",
        "name the file of the run that was interrupted", "chosen by --frames and more than one --tool", "--poses is given",
        "times and --tool", "times: give one path for all tools, or one for each",
        "--poses has several values; leave all but one out: only several --tool with --frames have a path each",
        "--resume compares files with those of the run before: name one for --", ".part: --resume goes on after them",
        "has ended; --force makes it anew",
        "give times to both, or to none", "give each a pose for every step, or times", "give paths of one recording",
        "give them with the tool's", "give every pose of a path as many, or none", "give them in",
    ]),
    ("stands in a transcript: cases/cameras.t, replay_cameras.t", [
        "--register makes the images of cameras agree: give several --frames",
        "--register does not move clouds that keep their poses", "give the depth images, or --cloud for each camera",
        "--register: no depth image can be used",
    ]),
    ("stands in a transcript: cases/mcap.t", [
        "give its file to vpm-normals, or to vpm-query --frames", "name frames that it connects, or give the poses in a file",
        "`topic` is for recordings in MCAP: leave it out",
        "give `intrinsics` fx,fy,cx,cy of its camera", ": give seconds, such as 12.5, or +12.5 after the first image",
        "give --at +0 for the first, or a time among them", "is for a recording in MCAP: leave it out",
        "--at is for one frame: leave it out, or name a file by --output", "name the poses of one world: FILE:WORLD:FRAME",
    ]),
    ("of recordings of ROS 2 that lie, or that change while they are read: mcap_test.py", ["copy it again"]),
    ("stands in a transcript: cases/pairs.t", [
        "chosen by --pairs", ": leave --unit out", ": give holes, voxel, voxel=RES, flood or flood=RES", 'write {"',
        "write it in quotation marks", "name the part's file", 'write {"parts": ["shaft", "hub"]}',
        "give the volume that the two may share, in the unit's cube", "write it in brackets, [ … ]", 'give each a "name" of its own',
        "give m, cm, mm, um, in or ft", "is a mesh: give the folder of all parts, or a description (assembly.json)", 'write {"id": "',
        "--unit mm", "another --unit",
    ]),
    ("stands in tests/robot, of URDF and SRDF files", [
        "give the SRDF of this robot", "give each a <collision> of its own", "' is seen but has no collision geometry, and is left out: give it a <collision> with the geometry of its <visual>",
        "make it fixed, or a chain of prismatic and revolute joints", 'write <axis xyz="0 0 1"/>',
        'write scale="1 1 1", or "0.001 0.001 0.001" for millimetres', "has a negative scale, and is mirrored; if that is not meant, write it without the sign",
        "fetch it, and write its path or package://PACKAGE/PATH", "correct the name in <mimic>", "let one of them have a value of its own",
        "give links a <collision> with the geometry of their <visual>", "build it where that is installed (Debian: liburdfdom-dev)",
        "write an --export, or call it by a name without /",
    ]),
    ("no solid is so narrow that few spheres fit", ["give --spheres"]),
    ("two runs at once write one file", ["wait for its end, or name another output"]),
    ("an answer of vpm-query --serve: cases/serve.t", [
        'give "cloud" beside it', 'give "cloud", here or in a request before', 'leave "camera_pose" out',
        'write {"pose": [tx,ty,tz,qx,qy,qz,qw]} or {"cloud": "scene.vpmc"}, with an "id" if wanted',
    ]),
    ("of files that are told by their first bytes, and of depths that may be coded: tests/file, tests/recording, tests/import", [
        "save it as CSV", "unpack it first: tar xf", "(SUN3D), or `decode` rotated",
        "and `depth_scale` 10000, which make that",
        ", as 8 bits are that were widened to 16; if so, give the image that they were made of",
    ]),
    ("said by a build without a library, or with CUDA", [
        "install it beside the other libraries of vpm, or build it where OpenVDB is installed",
        "give the .vpmg that vpm-pack and vpm-graph make of it",
        "build with VPM_EXR=ON, or convert the image to a 16-bit PNG", "build it where yaml-cpp is installed, or give the numbers",
        "build it where libtiff is installed, or convert the image to a 16-bit PNG", "save it as OBJ, OFF, PLY or STL",
        "this build draws no pages, because three.js was not found; install it (Debian: libjs-three) and build again",
        "scaling: this build has no CUDA; build with cmake --preset cuda", "leave the device or the other measure out",
        "scaling times one CUDA device; use --device cuda or cuda:N, or leave the option out", "use `device` cpu if this persists",
        "); use --device cpu, or leave the option out", "computes on the CPU only; use --device cpu, or leave the option out",
    ]),
    ("needs a file of vpm that no tool writes: tests/formats, tests/graph, tests/model", [
        "make the tool model again with vpm-graph",
        ": the pieces of its crossing surface do not close, so the model keeps none and cannot be measured against solids; "
        "pack the mesh with --repair voxel for that",
        "must hold one record; make the file again", "chunk TOOL must hold one record; make the file again", "pack the mesh again",
        ", which is no number; pack the mesh again, or leave --mesh out", "choose one of the size of the gaps between them",
    ]),
    ("takes a large input, or many seconds: tests/mesh/broad_phase_test.cpp, tests/faults", [
        "more such warnings; --verbose shows them",
        "the solid has more narrow places than were searched, so some of the smallest spheres could be larger; a higher --spheres searches more",
        "delete doubled or tangled parts, or give `repair` voxel for a new surface",
        "`repair` holes, voxel or flood may close it, or mend it in a mesh editor",
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
        self.done = {}  # how each command ended
        self.met = {}  # what each refused command said
        self.lacks_formats = False

    def run(self, command):
        """Returns how a command ends, which is run once."""
        if command not in self.done:
            self.done[command] = self.run_anew(command)
        return self.done[command]

    def run_anew(self, command):
        for path in self.folder.glob("out*"):
            if path.is_file():
                path.unlink()
        words = ["bash", "-o", "pipefail", "-c", command] if NEEDS_SHELL.search(command) else shlex.split(command)
        return subprocess.run(words, cwd=self.folder, env=self.environment,
                              stdin=subprocess.DEVNULL, capture_output=True, text=True, errors="replace", timeout=SECONDS)

    def must(self, command):
        done = self.run(command)
        if done.returncode != 0:
            raise SystemExit(f"{command} fails: {done.stderr}")
        return done.stdout

    def said(self, command):
        """Returns the exit status and messages of a command."""
        done = self.run(command)
        self.met[command] = done.stderr
        return done.returncode, done.stderr


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
    cure = re.sub(r"\{(\d+)\}", lambda place: found[int(place[1]) + 1], cure)
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
        if path.parent.name == "python":  # says it to programs: tests/python
            continue
        code = re.sub(r"^\s*#.*$|(?<![:\"])//.*$", "", path.read_text(), flags=re.MULTILINE)
        code = re.sub(r"(?:add_(?:option|flag)\w*|show_examples|show_exit_code)\([^;]*;", "", code)
        for literal in LITERALS.findall(code):
            text = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', literal)).replace('\\"', '"').strip()
            if " " in text and "|" not in text and (OPTION.search(text) or ASKS.search(text)):
                yield path.name, text


def pattern_of(text):
    """Returns a pattern that finds a text of the sources in a message of the tools."""
    parts = re.split(r"(`[a-z_]+`|%[-+.0-9]*z?[a-z])", text)
    while parts and (not parts[0] or parts[0][0] in "`%"):  # a pattern that begins with any text takes seconds to fail
        parts.pop(0)
    return "".join(r"[-\w =]+" if part.startswith("`") else ".*" if part.startswith("%") else re.escape(part.replace("%%", "%"))
                   for part in parts)


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
            faults += untried_faults("\n".join(tools.met.values()))
    print("\n".join(faults))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
