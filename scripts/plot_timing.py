#!/usr/bin/python3
"""Draws the results of `vpm-bench timing`: median and quartiles of every stage, 1 and 2 threads.

usage: plot_timing.py FOLDER    (reads timing.json, writes timing.png)
"""
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from plot_folder import draw_folder


def draw_results(folder):
    rows = json.loads((folder / "timing.json").read_text())["results"]
    stages = list(dict.fromkeys((r["stage"], r["spheres"]) for r in rows))
    figure, axis = plt.subplots(figsize=(10, 0.5 * len(stages) + 1.5))
    counts = sorted({r["threads"] for r in rows})
    for k, threads in enumerate(counts):
        shift = 0.4 * (k - (len(counts) - 1) / 2)
        of = {(r["stage"], r["spheres"]): r for r in rows if r["threads"] == threads}
        median = np.array([of[s]["median_ms"] for s in stages])
        low = median - np.array([of[s]["quartile1_ms"] for s in stages])
        high = np.array([of[s]["quartile3_ms"] for s in stages]) - median
        at = np.arange(len(stages)) + shift
        axis.barh(at, median, 0.36, xerr=[low, high], label=f"{threads} thread" + "s" * (threads > 1))
        for y, value in zip(at, median):
            axis.text(value * 1.15, y, f"{value:.3g}", va="center", fontsize=7)
    axis.set_yticks(range(len(stages)))
    axis.set_yticklabels([stage + (f", {n} spheres" if n else "") for stage, n in stages], fontsize=8)
    axis.invert_yaxis()
    axis.set_xscale("log")
    axis.set_xlabel("ms (median, quartiles)")
    axis.legend()
    figure.tight_layout()
    figure.savefig(folder / "timing.png", dpi=110)
    print(folder / "timing.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["timing.json"], "vpm-bench timing --out FOLDER")
