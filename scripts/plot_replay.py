#!/usr/bin/python3
"""Draws the results of `vpm-bench replay` on a recording: the volume along the tool's path for each number of spheres,
and the time of each frame.

usage: plot_replay.py FOLDER    (reads replay.json, writes replay_profile.png and replay_frames.png)
"""
import json

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plot_folder import draw_folder


def thousands(number):
    return f"{number:,}".replace(",", " ")


def profile(streams, path):
    figure, axis = plt.subplots(figsize=(9, 4))
    for r in streams:
        seconds = [k * r["profile_seconds"] for k in range(len(r["profile"]))]
        axis.plot(seconds, [100 * v for v in r["profile"]], lw=1, label=f"{thousands(r['spheres'])} spheres")
    axis.set_xlabel("time along the path, s")
    axis.set_ylabel("volume inside, % of the tool")
    axis.grid(alpha=0.2)
    axis.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    print(path)


def frames(streams, path):
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(9, 6), sharex=True)
    for r in streams:
        top.plot(r["frame_query_us"], lw=1, label=f"{thousands(r['spheres'])} spheres")
        bottom.plot(r["frame_prepare_ms"], lw=1)
    top.set_yscale("log")
    top.set_ylabel("query, mean over the frame, µs")
    top.legend(fontsize=8)
    bottom.set_ylabel("preparation from the file, ms")
    bottom.set_ylim(bottom=0)
    bottom.set_xlabel("frame")
    for axis in (top, bottom):
        axis.grid(alpha=0.2)
    figure.tight_layout()
    figure.savefig(path, dpi=110)
    print(path)


def draw_results(folder):
    report = json.loads((folder / "replay.json").read_text())
    streams = [r for r in report["results"] if r["part"] == "stream"]
    if not streams:
        raise ValueError("no pass over the stream")
    profile(streams, folder / "replay_profile.png")
    frames(streams, folder / "replay_frames.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["replay.json"], "vpm-bench replay --out FOLDER")
