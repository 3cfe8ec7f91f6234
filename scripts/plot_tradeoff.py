#!/usr/bin/python3
"""Draws the results of `vpm-bench tradeoff`: time against error, both logarithmic.

usage: plot_tradeoff.py FOLDER    (reads tradeoff.json, writes tradeoff.png)
"""
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plot_folder import draw_folder

COLORS = {("refined", "none"): "tab:blue", ("refined", "kinect"): "tab:cyan",
          ("paper", "none"): "tab:red", ("paper", "kinect"): "tab:orange"}
MARKS = {"normals": "s", "stride": "^"}
NOISE = {"none": "no noise", "kinect": "Kinect noise"}


def point(row):
    return row["mean_us"], max(100 * row["volume_mean"], 1e-4)


def draw_results(folder):
    report = json.loads((folder / "tradeoff.json").read_text())
    rows = [r for r in report["results"] if "mean_us" in r]
    if not rows:
        raise ValueError("no times")
    figure, axis = plt.subplots(figsize=(8, 5.5))
    for (measure, noise), color in COLORS.items():
        curve = sorted((r for r in rows if (r["varied"], r["measure"], r["noise"])
                        == ("spheres", measure, noise)), key=lambda r: r["spheres"])
        axis.plot(*zip(*map(point, curve)), "o-", color=color, label=f"{measure}, {NOISE[noise]}")
        for row in curve:
            axis.annotate(f"{row['spheres']:,}".replace(",", " "), point(row), fontsize=7, color=color,
                          xytext=(4, 4), textcoords="offset points")
            if measure == "refined" and row["spheres"] == report["settings"]["knee"][noise]:
                axis.plot(*point(row), "o", ms=14, mfc="none", color=color)
    for varied, mark in MARKS.items():
        points = [point(r) for r in rows if r["varied"] == varied]
        axis.plot(*zip(*points), mark, ms=4, mfc="none", color="0.4", label=f"{varied} varied")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("time of a query, 1 thread, µs")
    axis.set_ylabel("mean volume error, % of the tool")
    axis.grid(True, which="both", alpha=0.2)
    axis.legend(fontsize=8, loc="center right")
    axis.set_title("Spheres of the level beside the points; circled: the knee", fontsize=9)
    figure.tight_layout()
    figure.savefig(folder / "tradeoff.png", dpi=110)
    print(folder / "tradeoff.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["tradeoff.json"], "vpm-bench tradeoff --out FOLDER")
