#!/usr/bin/python3
"""Draws what the example two-links (examples/consumer) wrote: the links on their way, and where the energy went.

usage: plot_links.py FOLDER    (reads links.csv, writes links.png)
"""
import csv
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plot_folder import draw_folder

PARTS = [("hand_damped", "damped by the coupling", "#0072b2"), ("contact_damped", "damped by the contact", "#56b4e9"),
         ("held", "held link and coupling's spring", "#b08d57"), ("squeezed", "in the contact", "#cc3311"),
         ("swinging", "swinging link", "#009e73")]


def bar(axis, peg, angle, ends, color, alpha):
    """Draws a bar from ends[0] to ends[1], mm, along the direction at `angle` from hanging."""
    along = (math.sin(angle), -math.cos(angle))
    x, z = ([peg[k] + end * along[k] for end in ends] for k in (0, 1))
    axis.plot(x, z, lw=9, color=color, alpha=alpha, solid_capstyle="round")


def draw_links(axis, steps):
    shown = steps[::max(1, len(steps) // 24)]
    for k, step in enumerate(shown):
        peg, alpha = (1000 * step["peg_x"], 1000 * step["peg_z"]), 0.06 + 0.3 * k / len(shown)
        bar(axis, peg, -math.pi / 2, (0, 94), "#b08d57", alpha / 3)
        bar(axis, peg, step["swing"], (0, 94), "#009e73", alpha)
    axis.plot([1000 * step["peg_x"] for step in steps], [1000 * step["peg_z"] for step in steps], color="k", lw=1)
    axis.set_aspect("equal")
    axis.set_xlabel("x, mm")
    axis.set_ylabel("height, mm")
    axis.set_title("The held link, its peg's way, and the link that hangs on it", fontsize=9)


def draw_energies(axis, steps):
    times = [step["time"] for step in steps]
    axis.stackplot(times, *([1000 * step[name] for step in steps] for name, _, _ in PARTS),
                   labels=[label for _, label, _ in PARTS], colors=[color for _, _, color in PARTS], lw=0)
    axis.plot(times, [1000 * step["given"] for step in steps], "k", lw=1.2, label="given by hand and gravity")
    axis.set_xlabel("time, s")
    axis.set_ylabel("energy, mJ")
    axis.set_title("Where it went", fontsize=9)
    axis.legend(fontsize=7, loc="upper left")
    axis.grid(alpha=0.2)


def draw_results(folder):
    with open(folder / "links.csv", newline="") as file:
        steps = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    if not steps:
        raise ValueError("no steps")
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
    draw_links(left, steps)
    draw_energies(right, steps)
    figure.tight_layout()
    figure.savefig(folder / "links.png", dpi=90)
    print(folder / "links.png")


if __name__ == "__main__":
    draw_folder(draw_results, ["links.csv"], "two-links FOLDER")
