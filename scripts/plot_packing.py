#!/usr/bin/python3
"""Draws the results of `vpm-bench packing`: the uncovered volume, the gain by growing, the cost per sphere.

usage: plot_packing.py FOLDER    (reads packing.json, writes packing.png)
"""
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from plot_folder import draw_folder

APOLLONIAN = -0.2126  # exponent of what greedy packings leave uncovered


def draw_coverage(axis, rows):
    shapes = list(dict.fromkeys(r["shape"] for r in rows))
    for k, shape in enumerate(shapes):
        line = [r for r in rows if r["shape"] == shape and r["method"] == "vpm-pack"]
        axis.loglog([r["spheres"] for r in line], [1 - r["coverage"] for r in line], f"C{k}-", lw=1.2, label=shape)
    most = max(r["spheres"] for r in rows)
    slope = np.array([most / 100, most])
    axis.loglog(slope, 0.35 * (slope / slope[0]) ** APOLLONIAN, "k-", lw=3, alpha=0.3,
                label=f"N^{APOLLONIAN}")
    axis.set_xlabel("spheres")
    axis.set_ylabel("share of the volume left uncovered")
    axis.grid(alpha=0.3, which="both")
    axis.legend(fontsize=7)


def draw_growth(axis, rows):
    shapes = list(dict.fromkeys(r["shape"] for r in rows))
    counts = list(dict.fromkeys(r["spheres"] for r in rows))
    for k, count in enumerate(counts):
        of = {(r["shape"], r["method"]): r["coverage"] for r in rows if r["spheres"] == count}
        gain = [100 * (of[s, "grown"] - of[s, "greedy"]) for s in shapes]
        axis.bar(np.arange(len(shapes)) + 0.25 * (k - (len(counts) - 1) / 2), gain, 0.23,
                 label=f"{count:.0f} spheres")
    axis.set_xticks(range(len(shapes)))
    axis.set_xticklabels(shapes, rotation=30, ha="right", fontsize=8)
    axis.set_ylabel("coverage that --grow adds, points")
    axis.grid(axis="y", alpha=0.3)
    axis.legend(fontsize=8)


def draw_cost(axis, rows):
    count = np.array([r["spheres"] for r in rows])
    axis.loglog(count, 1e6 * np.array([r["cpu_seconds"] for r in rows]) / count, "C0o-",
                label="CPU µs per sphere")
    axis.loglog(count, [r["memory_mb"] for r in rows], "C1s-", label="peak memory, MB")
    axis.set_xlabel(f"spheres ({rows[0]['shape']})")
    axis.grid(alpha=0.3, which="both")
    axis.legend(fontsize=8)


def draw_results(folder):
    rows = json.loads((folder / "packing.json").read_text())["results"]
    figure, (coverage, growth, cost) = plt.subplots(1, 3, figsize=(17, 5))
    draw_coverage(coverage, [r for r in rows if r["part"] == "coverage"])
    draw_growth(growth, [r for r in rows if r["part"] == "growth"])
    draw_cost(cost, [r for r in rows if r["part"] == "scaling"])
    figure.tight_layout()
    figure.savefig(folder / "packing.png", dpi=110)
    print(folder / "packing.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["packing.json"], "vpm-bench packing --out FOLDER")
