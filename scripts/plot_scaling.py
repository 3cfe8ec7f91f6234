#!/usr/bin/python3
"""Draws the results of `vpm-bench scaling` on a device: time of a query against the number of spheres, split into
boundary and flood, and along the path of the tool, both logarithmic (figures 7 and 9 of the paper).

usage: plot_scaling.py FOLDER    (reads scaling.json, writes scaling.png)
"""
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plot_folder import draw_folder

# Maps a measure to its label, its color, and the fields with the times of its boundary and its flood.
MEASURES = {
    "refined": ("refined", "tab:blue", lambda r: r["refined_median_us"] - r["refined_flood_us"],
                lambda r: r["refined_flood_us"]),
}


def draw_levels(axis, rows):
    spheres = [r["spheres"] for r in rows]
    for name, (label, color, boundary, flood) in MEASURES.items():
        if f"{name}_median_us" not in rows[0]:
            continue
        axis.plot(spheres, [r[f"{name}_median_us"] for r in rows], "o-", color=color, label=label)
        axis.plot(spheres, [boundary(r) for r in rows], "--", lw=1, color=color)
        axis.plot(spheres, [flood(r) for r in rows], ":", color=color)
    axis.plot([], [], "--", lw=1, color="0.4", label="until the boundary is known")
    axis.plot([], [], ":", color="0.4", label="flood and sums")
    axis.set_xscale("log")
    axis.set_xlabel("spheres")
    axis.set_ylabel("time of a query, µs (median)")
    axis.set_title("From the call to the result; the parts by the device's clock", fontsize=9)


def draw_path(axis, frames):
    for name, (label, color, _, _) in MEASURES.items():
        if f"{name}_us" in frames[0]:
            axis.plot([r["frame"] for r in frames], [r[f"{name}_us"] for r in frames], color=color, label=label)
    inside = axis.twinx()
    inside.plot([r["frame"] for r in frames], [100 * r["volume_fraction"] for r in frames], color="0.6", lw=1)
    inside.set_ylabel("% of the tool inside (grey)")
    inside.set_ylim(0, 25)
    axis.set_xlabel("frame of the path")
    axis.set_title(f"{frames[0]['spheres']:,} spheres along the path".replace(",", " "), fontsize=9)


def draw_results(folder):
    report = json.loads((folder / "scaling.json").read_text())
    rows = [r for r in report["results"] if r["part"] == "spheres"]
    frames = [r for r in report["results"] if r["part"] == "frame"]
    last = frames[-1]["spheres"]
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.5), sharey=True)
    draw_levels(axes[0], rows)
    draw_path(axes[1], [r for r in frames if r["spheres"] == last])
    for axis in axes:
        axis.set_yscale("log")
        axis.grid(True, which="both", alpha=0.2)
    axes[0].legend(fontsize=7, ncol=2, loc=(0.02, 0.13))
    figure.suptitle(report["settings"]["device"].split(",")[0], fontsize=10)
    figure.tight_layout()
    figure.savefig(folder / "scaling.png", dpi=110)
    print(folder / "scaling.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["scaling.json"], "vpm-bench scaling --out FOLDER")
