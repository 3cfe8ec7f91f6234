#!/usr/bin/python3
"""Explains the results of vpm-query on the path of the demo, and draws them.

usage: plot_demo.py FOLDER
"""
import csv
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from plot_folder import draw_folder

STATES = [("outside", "#a0a0a0"), ("boundary", "#ff8c00"), ("inside", "#c80000")]
ML = 1e6  # millilitres in a cubic metre


def read(folder):
    results = [json.loads(line) for line in (folder / "results.jsonl").open()]
    with (folder / "truth.csv").open() as file:
        truth = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return results, truth


def read_spheres(path):
    with path.open() as file:
        return sorted(csv.DictReader(file), key=lambda row: -float(row["y"]))


def describe(folder, results, truth):
    pack = json.loads((folder / "pack.json").read_text())
    stats = json.loads((folder / "stats.json").read_text())
    tool = pack["volume_mesh"]
    first = next(k for k, r in enumerate(results) if r["volume"] > 0)
    last, true = results[-1], truth[-1]
    errors = [abs(r["volume"] - t["volume"]) / tool for r, t in zip(results, truth)]
    force = np.array(last["force"])
    direction = force / np.linalg.norm(force)
    print(f"""The tool has a volume of {tool * ML:.0f} ml; {pack['spheres']} spheres fill {100 * pack['coverage']:.1f} % of it.
It goes {1000 * true['depth']:.0f} mm along its path, in {len(results)} poses.
Up to pose {first - 1} it touches nothing. At the last pose {last['volume'] * ML:.1f} ml of it, {100 * last['volume_fraction']:.1f} %,
are inside the bowl's wall; the truth is {true['volume'] * ML:.1f} ml.
The force that pushes it out points along ({direction[0]:+.2f}, {direction[1]:+.2f}, {direction[2]:+.2f}), where -z is back to the camera.
Along the path the volume is off by {100 * np.mean(errors):.2f} % of the tool on average, {100 * max(errors):.2f} % at worst.
One query took {stats['query_us']['median'] / 1000:.2f} ms (median).""")


def draw(folder, results, truth):
    figure, (image, curve, spheres) = plt.subplots(1, 3, figsize=(15, 4.6))
    depth = plt.imread(folder / "depth.png") * 65535 / 5000
    shown = image.imshow(np.where(depth > 0, depth, np.nan), cmap="viridis_r")
    figure.colorbar(shown, ax=image, label="depth, m", shrink=0.8)
    image.set_title("what the camera saw")

    along = [1000 * t["depth"] for t in truth]
    curve.plot(along, [t["volume"] * ML for t in truth], "k-", lw=3, alpha=0.3, label="truth")
    curve.plot(along, [r["volume"] * ML for r in results], "C3-", lw=1, label="vpm-query")
    curve.set_xlabel("way into the bowl, mm")
    curve.set_ylabel("penetration volume, ml")
    curve.set_title("volume inside the wall")
    curve.legend()

    # Draws the nearest spheres last, seen from the side: the camera is above, the bowl below.
    for row in read_spheres(folder / "spheres.csv"):
        spheres.add_patch(plt.Circle((float(row["x"]), -float(row["z"])), float(row["r"]),
                                     fc=dict(STATES)[row["state"]], ec="k", lw=0.2))
    for name, colour in STATES:
        spheres.plot([], [], "o", color=colour, label=name)
    angle = np.linspace(-0.6, 0.6, 200)
    spheres.plot(0.3 * np.sin(angle), -(0.7 + 0.3 * np.cos(angle)), "k--", lw=1, label="bowl")
    spheres.set_aspect("equal")
    spheres.set_xlabel("x, m")
    spheres.set_ylabel("-z, m")
    spheres.set_title("the spheres at the last pose")
    spheres.legend(loc="upper right", fontsize=8)
    figure.tight_layout()
    figure.savefig(folder / "demo.png", dpi=110)
    print(f"\nThe picture is {folder / 'demo.png'}; the other files lie beside it.")


def draw_results(folder):
    results, truth = read(folder)
    describe(folder, results, truth)
    draw(folder, results, truth)


if __name__ == "__main__":
    draw_folder(draw_results, ["results.jsonl", "truth.csv", "pack.json", "stats.json", "spheres.csv", "depth.png"], "scripts/demo.sh FOLDER")
