#!/usr/bin/python3
"""Makes the pictures of the pages: the tools show the bundled example, headless Chromium photographs it.

usage: scripts/view_pictures.py [BIN [OUTPUT [EXAMPLE]]]     by default build/release/bin, examples/pictures, and what make-example writes
"""
import io
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

from PIL import Image

import headless_page

REPOSITORY = pathlib.Path(__file__).resolve().parents[1]
LARGEST = 150_000  # bytes
COLORS = 256


def save(png, path):
    """Writes the picture with as few colours as it needs to be small."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    colors = COLORS
    while True:
        few = picture.quantize(colors, method=Image.Quantize.MAXCOVERAGE, kmeans=3, dither=Image.Dither.NONE)
        few.save(path, optimize=True)
        if path.stat().st_size <= LARGEST or colors <= 16:
            break
        colors //= 2
    print(f"{path}: {path.stat().st_size // 1000} kB")


def make_pages(tools, folder, example):
    def run(tool, *arguments):
        subprocess.run([tools / tool, *map(str, arguments)], cwd=folder, check=True)

    if example:
        shutil.copytree(example, folder, dirs_exist_ok=True)
    else:
        run("make-example", ".")
    run("vpm-pack", "tool.off", "-o", "tool.vpmp", "--spheres", 1000, "--view", "pack.html", "--quiet")
    run("vpm-graph", "tool.vpmp", "-o", "tool.vpmg", "--levels", "100", "--view", "graph.html", "--quiet")
    run("vpm-normals", "depth.png", "-o", "scene.vpmc", "--intrinsics", "525,525,319.5,239.5", "--depth-scale", 5000,
        "--view", "normals.html", "--quiet")
    run("vpm-query", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--poses", "poses.jsonl", "-o", "results.jsonl",
        "--view", "query.html", "--quiet")
    make_scenes(run, pathlib.Path(folder))
    clouds = []
    for camera in ("left", "right", "back"):
        run("vpm-normals", f"{camera}.png", "-o", f"{camera}.vpmc", "--intrinsics", "262.5,262.5,159.75,119.75", "--depth-scale", 5000, "--camera-pose",
            f"{camera}.txt", "--remove", "link.off@0,0,0.5,0,0,0,1", "--remove-margin", 0.005, "--quiet")
        clouds += ["--cloud", f"{camera}.vpmc"]
    run("vpm-query", "--tool", "tool.vpmg", *clouds, "--register", "--pose", "0.03,0,0.11,0,0,0,1", "--quiet", "-o", "cameras.jsonl", "--view", "cameras.html")


def ring_of_points():
    """Returns a PLY file of points with normals: a floor with a bump under the tool, and a wall behind."""
    rows = []
    for i in range(-60, 61):
        for k in range(-60, 61):
            x, y = 0.005 * i, 0.005 * k
            z, slope = 0.98 - 0.06 * math.exp(-(x * x + y * y) / 0.005), 0.06 / 0.0025 * math.exp(-(x * x + y * y) / 0.005)
            rows.append(f"{x} {y} {z} {slope * x} {slope * y} -1")
            rows.append(f"{x} 0.3 {0.68 + 0.005 * (k / 2 + 30)} 0 -1 0")
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    return f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n{names}end_header\n" + "\n".join(rows) + "\n"


def make_scenes(run, folder):
    """Makes the pages of tools/query/scenes.md: points, solids, and several bodies."""
    box = [(x, y, z) for z in (-.015, .015) for y in (-.1, .1) for x in (-.02, .02)]
    faces = ("021", "123", "456", "576", "014", "154", "263", "367", "042", "246", "135", "375")
    (folder / "jaw.off").write_text("OFF\n8 12 0\n" + "\n".join(" ".join(map(str, corner)) for corner in box) + "\n" +
                                    "\n".join("3 " + " ".join(face) for face in faces) + "\n")
    (folder / "points.ply").write_text(ring_of_points())
    run("vpm-normals", "points.ply", "-o", "points.vpmc", "--quiet")
    jaws = ("--solid", "jaw.off@-0.1,0,0.93,0,0,0,1", "--solid", "jaw.off@0.12,0,0.93,0,0,0,1")
    for name, scene in (("points", ("--cloud", "points.vpmc")), ("solids", jaws), ("several", ("--cloud", "scene.vpmc", *jaws))):
        run("vpm-query", "--tool", "tool.vpmg", *scene, "--pose", "0.01,0,0.94,0.7,0.1,0,0.70710678", "--quiet", "-o",
            f"{name}.jsonl", "--view", f"scene-{name}.html")


# Scripts that each page runs before its picture is taken.
PICTURES = {
    "query": "vpm.setView('contact')",
    "pack": "vpm.setStep(150)",
    "graph": "vpm.setStep(0); vpm.showCell(3)",
    "normals": "vpm.setView('overview')",
    "scene-points": "vpm.setView('overview')",
    "scene-solids": "vpm.setView('overview')",
    "scene-several": "vpm.setView('contact')",
    # Nearer, until the cameras fill the picture.
    "cameras": "vpm.setView('all'); for (let k = 0; k < 22; ++k) document.querySelector('canvas').dispatchEvent(new WheelEvent('wheel', {deltaY: -1}))",
}


def pictures(tools, example=None, quality=2):
    """Yields (name, PNG) of each page. `quality` is how many pixels are drawn for one that is shown, along each side: 2 makes edges smooth,
    which a page leaves out where a processor draws it."""
    with tempfile.TemporaryDirectory() as folder, headless_page.Browser() as browser:
        make_pages(tools, folder, example)
        for name, action in PICTURES.items():
            page = browser.open(f"{folder}/{name}.html", 1120, 630)
            page.evaluate(f"{action}; vpm.setQuality({quality})")
            yield name, page.screenshot()
            if page.faults:
                sys.exit(f"view_pictures.py: {name}: {page.faults}")
            page.close()


def main():
    tools = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else REPOSITORY / "build/release/bin").resolve()
    output = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else REPOSITORY / "examples/pictures")
    if not headless_page.program():
        sys.exit("view_pictures.py: there is no Chromium; install it (Debian: chromium-headless-shell)")
    output.mkdir(parents=True, exist_ok=True)
    for name, png in pictures(tools, sys.argv[3] if len(sys.argv) > 3 else None):
        save(png, output / f"{name}.png")


if __name__ == "__main__":
    main()
