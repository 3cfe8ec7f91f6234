#!/usr/bin/env python3
"""Tests that other programs read what vpm-normals --export writes.

    cloud_exports_test.py BIN three.js|PCL

BIN is the folder of the tools. Needs Node.js and three.js, or the tools of PCL, of which Debian has
all; skipped, which is said, without them. Exit status: 0 if all is read as it was written, 1
otherwise, 77 skipped.
"""
import json
import math
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
THREE = [pathlib.Path(folder) / "three" for folder in
         [*os.environ.get("NODE_PATH", "").split(":"), "/usr/share/javascript", "/usr/share/nodejs"] if folder]
PARTS = ["build", "examples/jsm/loaders/PLYLoader.js", "examples/jsm/loaders/PCDLoader.js"]
WIDTH, HEIGHT, FOCAL = 16, 12, 20.0
POSES = ["0,0,0,0,0,0,1", "3,-2,1.5,0.5,-0.5,0.5,-0.5", "500000,5400000,300,0.5,-0.5,0.5,-0.5"]


def skip(why):
    print("skipped: " + why)
    sys.exit(77)


def place_three(folder):
    """Copies the parts of three.js that are used to where node_modules is looked for."""
    found = next((three for three in THREE if all((three / part).exists() for part in PARTS)), None)
    if found is None:
        skip("no three.js (Debian: libjs-three)")
    three = folder / "node_modules/three"
    for part in PARTS:
        (three / part).parent.mkdir(parents=True, exist_ok=True)
        copy = shutil.copytree if (found / part).is_dir() else shutil.copy
        copy(found / part, three / part)
    exports = {".": "./build/three.module.js", "./*": "./*"}
    (three / "package.json").write_text(json.dumps({"name": "three", "type": "module", "exports": exports}))
    shutil.copy(HERE / "three_reads.mjs", folder)


def depth_at(u, v):
    return 1 + 0.02 * u + 0.01 * v


def write_depth(path):
    """Writes a tilted wall as PFM, whose rows go from the bottom up."""
    rows = b"".join(struct.pack("<f", depth_at(u, v)) for v in reversed(range(HEIGHT)) for u in range(WIDTH))
    path.write_bytes(f"Pf\n{WIDTH} {HEIGHT}\n-1.0\n".encode() + rows)


def turned(pose, p):
    """Returns p in the world, about the camera, of a pose tx,ty,tz,qx,qy,qz,qw."""
    x, y, z, w = [float(number) for number in pose.split(",")][3:]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    twice = [2 * c for c in cross([x, y, z], p)]
    return [a + w * b + c for a, b, c in zip(p, twice, cross([x, y, z], twice))]


def points_in(flat):
    return [flat[k:k + 3] for k in range(0, len(flat), 3)]


def check(name, pose, read, note):
    """Compares the points that were read with the wall's. A grid is in the camera's frame."""
    is_grid = name.endswith("grid.pcd")
    positions, normals = points_in(read["positions"]), points_in(read["normals"])
    assert len(positions) == len(normals) == WIDTH * HEIGHT, (name, len(positions), len(normals))
    origin = [float(number) for number in pose.split(",")][:3]
    if "written about" in note:
        origin = [o - float(a) for o, a in
                  zip(origin, note.split("written about ")[1].split(", which")[0].split(","))]
    for k, (p, n) in enumerate(zip(positions, normals)):
        u, v = k % WIDTH, k // WIDTH
        z = depth_at(u, v)
        seen = [(u - 7.5) / FOCAL * z, (v - 5.5) / FOCAL * z, z]
        there = seen if is_grid else [o + s for o, s in zip(origin, turned(pose, seen))]
        assert math.dist(p, there) < 1e-5, (name, k, p, there)
        assert abs(math.hypot(*n) - 1) < 1e-3, (name, k, n)
        facing = sum(a * b for a, b in zip(n, seen if is_grid else turned(pose, seen)))
        assert facing < 0, (name, k, n)


def read_by_three(folder, files):
    """Returns positions and normals of each file as three.js reads them."""
    read = subprocess.run(["node", "three_reads.mjs", *files], cwd=folder, capture_output=True, text=True)
    assert read.returncode == 0, read.stderr
    return json.loads(read.stdout)


def run_pcl(folder, *command):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    said = (done.stdout + done.stderr).replace("Failed to find match for field 'curvature'", "")  # which clouds seldom have
    assert done.returncode == 0 and "Failed" not in said, (command, done.stdout, done.stderr)


def read_by_pcl(folder, files):
    """Returns positions and normals of each file as PCL reads them into points of the type PointNormal."""
    clouds = []
    for file in files:
        if file.endswith(".ply"):
            run_pcl(folder, "pcl_ply2pcd", file, "any.pcd")
        # A motion is applied to PointNormal, others are copied as bytes.
        run_pcl(folder, "pcl_transform_point_cloud", "any.pcd" if file.endswith(".ply") else file, "moved.pcd", "-trans", "0,0,0")
        run_pcl(folder, "pcl_convert_pcd_ascii_binary", "moved.pcd", "text.pcd", "0")
        header, _, rows = (folder / "text.pcd").read_text().partition("DATA ascii\n")
        fields = next(line.split()[1:] for line in header.splitlines() if line.startswith("FIELDS"))
        points = [dict(zip(fields, map(float, row.split()))) for row in rows.splitlines()]
        clouds.append({"positions": [p[c] for p in points for c in "xyz"],
                       "normals": [p["normal_" + c] for p in points for c in "xyz"]})
    return clouds


def main():
    reader = sys.argv[2]
    needed = "node" if reader == "three.js" else "pcl_ply2pcd"
    if shutil.which(needed) is None:
        skip(f"no {needed} (Debian: {'nodejs' if reader == 'three.js' else 'pcl-tools'})")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if reader == "three.js":
            place_three(folder)
        write_depth(folder / "wall.pfm")
        written = []
        for number, pose in enumerate(POSES):
            camera = ["--intrinsics", f"{FOCAL},{FOCAL},7.5,5.5", "--camera-pose", pose]
            for source, options, out in [("wall.pfm", camera, "seen.ply"), ("wall.pfm", camera, "grid.pcd"),
                                         (f"{number}seen.ply", [], "points.pcd"), (f"{number}seen.ply", [], "points.ply")]:
                done = subprocess.run([str(pathlib.Path(sys.argv[1]).resolve() / "vpm-normals"), source, *options,
                                       "--export", f"{number}{out}"], cwd=folder, capture_output=True, text=True)
                assert done.returncode == 0, done.stderr
                written.append((f"{number}{out}", pose, done.stderr))
        read = (read_by_three if reader == "three.js" else read_by_pcl)(folder, [entry[0] for entry in written])
        for (file, pose, note), points in zip(written, read):
            check(file, pose, points, note)
        print(f"{reader} read {len(written)} files as they were written")


if __name__ == "__main__":
    main()
