#!/usr/bin/env python3
"""Packs and exports meshes of real links through a URDF that is written here, and asks what they share.

    robot_links_test.py --bin DIR[:DIR...] MESHES

MESHES is the folder of the shared meshes. Each link must have exactly as many spheres as asked, and so must the robot, in each format;
every vertex and many places of every triangle must lie in a sphere of --outer. Exit status: 0 if all holds, 1 otherwise, 77 (skipped)
where the meshes are not there.
"""
import argparse
import collections
import csv
import itertools
import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

SKIPPED = 77
# Link: file, scale to metres, place and turn about z in the link's frame.
LINKS = {"plate": ("plate_holes.STL", 1e-3, (-0.1, -0.15, 0.02), 0.5), "forearm": ("franka_fer_link5.stl", 1, (0, 0, 0.3), 0),
         "hand": ("featuretype.STL", 0.0254, (0.05, 0, 0), -1.2)}
PER_LINK, IN_ALL = 12, 50


def urdf(meshes):
    links = "".join(f'<link name="{name}"><collision><origin xyz="{x} {y} {z}" rpy="0 0 {turn}"/><geometry><mesh filename="{meshes}/{file}" '
                    f'scale="{scale} {scale} {scale}"/></geometry></collision></link>' for name, (file, scale, (x, y, z), turn) in LINKS.items())
    joints = "".join(f'<joint name="to_{child}" type="continuous"><parent link="{parent}"/><child link="{child}"/></joint>'
                     for parent, child in itertools.pairwise(LINKS))
    return f'<robot name="real">{links}{joints}</robot>'


def triangles_of(path):
    """Yields the corners of the triangles of a binary STL file."""
    data = path.read_bytes()
    for at in range(84, 84 + 50 * struct.unpack_from("<I", data, 80)[0], 50):
        numbers = struct.unpack_from("<12f", data, at)
        yield numbers[3:6], numbers[6:9], numbers[9:12]


def places_on(meshes, link):
    """Yields places on the surface of a link, in its frame: corners, the middles of edges and of triangles, and thirds of the edges."""
    file, scale, origin, turn = LINKS[link]
    cosine, sine = math.cos(turn), math.sin(turn)
    for corners in triangles_of(meshes / file):
        for weights in ((1, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0.5), (0.5, 0, 0.5), (1 / 3, 1 / 3, 1 / 3), (2 / 3, 1 / 3, 0), (0.2, 0.2, 0.6)):
            x, y, z = (scale * sum(w * corner[k] for w, corner in zip(weights, corners)) for k in range(3))
            yield cosine * x - sine * y + origin[0], sine * x + cosine * y + origin[1], z + origin[2]


def spheres_of(path):
    spheres = collections.defaultdict(list)
    for row in csv.DictReader(path.open()):
        spheres[row["link"]].append(tuple(float(row[key]) for key in "xyzr"))
    return spheres


def faults_of_poses(folder, meshes, run):
    """Yields what is wrong where a link slides and another turns: what they share must be what their meshes share at these poses."""
    mesh, slide, turn = meshes / LINKS["forearm"][0], 0.05, 0.7
    links = "".join(f'<link name="{name}">{geometry}</link>' for name, geometry in (
        ("first", f'<collision><geometry><mesh filename="{mesh}"/></geometry></collision>'), ("between", ""),
        ("last", f'<collision><origin xyz="0 0 0.1"/><geometry><mesh filename="{mesh}"/></geometry></collision>')))
    (folder / "two.urdf").write_text(f"""<robot name="two">{links}
<joint name="slide" type="prismatic"><parent link="first"/><child link="between"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>
<joint name="turn" type="continuous"><parent link="between"/><child link="last"/><axis xyz="0 0 1"/></joint></robot>""")
    (folder / "none.srdf").write_text('<robot name="two"/>')
    (folder / "joints.jsonl").write_text(json.dumps({"slide": slide, "turn": turn}))
    run("vpm-query", "--urdf", "two.urdf", "--joints", "joints.jsonl", "--srdf", "none.srdf", "-o", "robot.jsonl", "--quiet")
    poses = [[0, 0, 0, 0, 0, 0, 1], [slide, 0, 0.1, 0, 0, math.sin(turn / 2), math.cos(turn / 2)]]
    (folder / "two.json").write_text(json.dumps({"parts": [
        {"name": name, "mesh": str(mesh), "pose": pose} for name, pose in zip(("first", "last"), poses)]}))
    run("vpm-query", "--pairs", "two.json", "-o", "pairs.jsonl", "--quiet")
    robot, pairs = (json.loads((folder / name).read_text()) for name in ("robot.jsonl", "pairs.jsonl"))
    if not 1e-4 < pairs["volume"] or abs(robot["self_volume"] - pairs["volume"]) > 1e-9 * pairs["volume"]:
        yield f"links share {robot['self_volume']} m³, their meshes {pairs['volume']} m³"


def faults_in(folder, meshes, run):
    """Yields what is wrong."""
    (folder / "real.urdf").write_text(urdf(meshes))
    run("vpm-pack", "--urdf", "real.urdf", "--spheres", PER_LINK, "--outer", "--export", "outer.csv", "--report", "outer.json", "--quiet")
    spheres, report = spheres_of(folder / "outer.csv"), json.loads((folder / "outer.json").read_text())
    for link in report["links"]:
        of_link = spheres[link["link"]]
        if not len(of_link) == link["spheres"] == PER_LINK or not link["certified"] or link["quality"]["coverage"] != 1:
            yield f"--spheres {PER_LINK} --outer: {len(of_link)} spheres in the file, and the report tells {link}"
        for place in places_on(meshes, link["link"]):
            if all(math.dist(place, s[:3]) > s[3] for s in of_link):
                yield f"{link['link']}: {place} lies in no sphere"
                break
    yield from faults_of_poses(folder, meshes, run)
    formats = {"csv": 0, "yml": "radius", "xrdf": "radius", "srdf": "radius=", "urdf": "<sphere radius="}
    run("vpm-pack", "--urdf", "real.urdf", "--robot-spheres", IN_ALL, *(word for name in formats for word in ("--export", f"all.{name}")),
        "--report", "all.json", "--quiet")
    counts = {name: (folder / f"all.{name}").read_text().count(word) for name, word in formats.items() if word}
    counts["csv"] = sum(map(len, spheres_of(folder / "all.csv").values()))
    report = json.loads((folder / "all.json").read_text())
    if set(counts.values()) != {IN_ALL} or sum(link["spheres"] for link in report["links"]) != IN_ALL:
        yield f"--robot-spheres {IN_ALL}: the files have {counts}, and the report tells {report}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("meshes", type=pathlib.Path)
    options = parser.parse_args()
    meshes = options.meshes.resolve()
    if not meshes.is_dir():
        print("skipped: the shared meshes are not here")
        return SKIPPED
    environment = dict(os.environ, PATH=options.bin + ":" + os.environ["PATH"])
    with tempfile.TemporaryDirectory() as folder:
        found = list(faults_in(pathlib.Path(folder), meshes, lambda *command: subprocess.run(
            [str(word) for word in command], cwd=folder, env=environment, check=True)))
    print("\n".join(found))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
