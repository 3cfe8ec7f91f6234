#!/usr/bin/python3
"""Draws the results of `vpm-bench accuracy`: volume against the truth, and the errors of each case.

usage: plot_accuracy.py FOLDER    (reads accuracy.csv and accuracy.json, writes accuracy.png)
"""
import csv
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from plot_folder import draw_folder

LINES = {("paper", "none"): ("C1", "-"), ("paper", "kinect"): ("C1", ":"),
         ("refined", "none"): ("C0", "-"), ("refined", "kinect"): ("C0", ":")}


def draw_paths(axes, rows):
    cases = list(dict.fromkeys((r["shape"], r["scene"]) for r in rows if r["group"] == "paper"))
    for axis, (shape, scene) in zip(axes, cases):
        of_case = [r for r in rows if (r["group"], r["shape"], r["scene"]) == ("paper", shape, scene)]
        for (measure, noise), (colour, style) in LINES.items():
            line = [r for r in of_case if r["measure"] == measure and r["noise"] == noise]
            deep = [1000 * (float(r["z"]) - float(line[0]["z"])) for r in line]
            if measure == "paper" and noise == "none":
                axis.plot(deep, [1e6 * float(r["volume_true"]) for r in line], "k-", lw=4, alpha=0.25,
                          label="truth")
            label = f"{measure}, {'Kinect noise' if noise == 'kinect' else 'clean'}"
            axis.plot(deep, [1e6 * float(r["volume"]) for r in line], colour + style, lw=1.2, label=label)
        axis.set_title(f"{shape} into {scene}", fontsize=10)
        axis.set_xlabel("z, mm")
        axis.set_ylabel("volume, ml")
    axes[0].legend(fontsize=7)


def draw_errors(axis, results):
    cases = list(dict.fromkeys((r["group"], r["shape"], r["scene"]) for r in results))
    for k, ((measure, noise), (colour, style)) in enumerate(LINES.items()):
        chosen = {(r["group"], r["shape"], r["scene"]): r for r in results
                  if r["measure"] == measure and r["noise"] == noise}
        at = np.arange(len(cases)) + 0.2 * (k - 1.5)
        mean = [100 * chosen[c]["volume_mean"] for c in cases]
        worst = [100 * chosen[c]["volume_worst"] for c in cases]
        axis.bar(at, mean, 0.18, color=colour, alpha=0.9 if style == "-" else 0.5,
                 label=f"{measure}, {noise}: mean (tick: worst)")
        axis.plot(at, worst, "k_", ms=5)
    axis.set_yscale("log")
    axis.set_ylim(1e-3, 200)
    axis.set_ylabel("error, % of the tool")
    axis.set_xticks(range(len(cases)))
    axis.set_xticklabels([f"{shape}\n{scene}" + ("" if group == "paper" else "\nturned")
                          for group, shape, scene in cases], fontsize=7)
    axis.grid(axis="y", alpha=0.3)
    axis.legend(fontsize=7, ncol=4)


def draw_results(folder):
    with (folder / "accuracy.csv").open() as file:
        rows = list(csv.DictReader(file))
    report = json.loads((folder / "accuracy.json").read_text())
    results = [r for r in report["results"] if r["group"] in ("paper", "turned")]  # --all has more
    figure = plt.figure(figsize=(17, 11))
    grid = figure.add_gridspec(3, 3)
    draw_paths([figure.add_subplot(grid[k // 3, k % 3]) for k in range(6)], rows)
    draw_errors(figure.add_subplot(grid[2, :]), results)
    figure.tight_layout()
    figure.savefig(folder / "accuracy.png", dpi=100)
    print(folder / "accuracy.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["accuracy.csv", "accuracy.json"], "vpm-bench accuracy --out FOLDER")
