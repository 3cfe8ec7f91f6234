#!/usr/bin/python3
"""Moves every tool into every scene of a folder and checks the results of vpm-query on the way.

usage: walk_into_scenes.py VPM_QUERY FOLDER

FOLDER holds tools (NAME.vpmg with NAME.pack.csv and NAME.graph.json) and scenes (NAME.vpmc with
NAME.ply, its points and normals, and NAME.normals.json). Each tool goes along the normal of a flat place near the middle
of the image, from clear of everything to deep inside. The results of `refined` must keep these promises:
  - every number is finite,
  - the volume is 0 while the tool is clear of every point,
  - it grows: it never falls by more than NOISE of the tool's volume,
  - it does not jump: no step is larger than twice the largest step into a plane, plus NOISE,
  - it ends at the volume behind a plane through that place, less the places that the camera has seen to be
    free (under a table top, say), up to the part that is not flat or not seen there,
  - force and motion oppose each other at the end.
`paper` takes the same path for comparison. Writes real.png, real.json and the poses.
"""
import json
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

POSES = 121
SPARSE = 7  # every so many points are enough to find a flat place
NOISE = 0.01  # of the tool's volume: sensor noise moves single spheres across the surface
CLEAR = 0.02  # metres between tool and surface at the start
FLAT = 0.015  # metres: points this near to the plane count as flat
TYPES = {"float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8", "uchar": "u1",
         "uint8": "u1", "ushort": "<u2", "uint": "<u4", "uint32": "<u4", "int": "<i4", "int32": "<i4"}


def read_ply(path):
    """Returns positions and normals of a PLY file's vertices, ASCII or little-endian."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = [line.split() for line in data[:end].decode().splitlines()]
    binary = next(w[1] for w in header if w[0] == "format") == "binary_little_endian"
    count = next(int(w[2]) for w in header if w[:2] == ["element", "vertex"])
    fields = [(w[2], TYPES[w[1]]) for w in header if w[0] == "property" and w[1] in TYPES]
    if binary:
        table = np.frombuffer(data, dtype=fields, count=count, offset=end)
    else:
        rows = np.array(data[end:].split()[:count * len(fields)], dtype=float)
        table = {name: column for (name, _), column in zip(fields, rows.reshape(count, -1).T)}
    column = lambda *names: np.stack([np.asarray(table[n], dtype=float) for n in names], axis=1)
    return column("x", "y", "z"), column("nx", "ny", "nz")


class View:
    """Holds the directions that the camera, at the origin, has measured. It looks along +z or -z, where
    the points lie."""

    def __init__(self, points, report):
        self.fx, self.fy, self.cx, self.cy = report["intrinsics"]
        self.depth = np.zeros((report["height"], report["width"]))  # 0: nothing measured
        u, v, inside = self.project(points)
        self.depth[v[inside], u[inside]] = np.abs(points[inside, 2])

    def project(self, points):
        away = np.maximum(np.abs(points[:, 2]), 1e-9)
        u = np.round(self.fx * points[:, 0] / away + self.cx).astype(int)
        v = np.round(self.fy * points[:, 1] / away + self.cy).astype(int)
        return u, v, (u >= 0) & (v >= 0) & (u < self.depth.shape[1]) & (v < self.depth.shape[0])

    def measured(self, places):
        """Returns the depth measured in the direction of each place, 0 where none is."""
        u, v, inside = self.project(places)
        return np.where(inside, self.depth[v * inside, u * inside], 0)

    def fraction_flat(self, places, origin, normal):
        """Returns the fraction of the places on a plane with a measured point near the plane in their direction."""
        measured = self.measured(places)
        points = places * (measured / np.abs(places[:, 2]))[:, None]
        return np.mean((measured > 0) & (np.abs((points - origin) @ normal) < FLAT))

    def fraction_clear(self, places):
        """Returns the fraction of the places that lie in front of the measured depth."""
        return np.mean(np.abs(places[:, 2]) < self.measured(places))

    def is_free(self, centers, radii):
        """True for spheres wholly in front of the measured depth, which the camera saw past."""
        return np.abs(centers[:, 2]) + radii < self.measured(centers)


def disc(origin, normal, radius):
    """Returns about 500 places spread over a disc."""
    side = np.cross(normal, [1, 0, 0] if abs(normal[0]) < 0.7 else [0, 1, 0])
    side /= np.linalg.norm(side)
    k = np.arange(500)
    r, a = radius * np.sqrt((k + 0.5) / 500), k * 2.399963  # golden angle
    return origin + np.outer(r * np.cos(a), side) + np.outer(r * np.sin(a), np.cross(normal, side))


def choose_contact(points, normals, reach, view):
    """Returns a flat place near the optical axis whose surroundings, and the way to it, the camera sees:
    (point, normal, fraction that is flat and seen, greatest height of a point near the way)."""
    angle = np.degrees(np.arctan2(np.hypot(points[:, 0], points[:, 1]), np.abs(points[:, 2])))
    central = np.flatnonzero(angle < 20)
    random = np.random.RandomState(1)
    best = None
    for k in random.choice(central, min(300, len(central)), replace=False):
        near = np.linalg.norm(points - points[k], axis=1) < 0.05
        normal = normals[near].mean(axis=0)
        normal /= np.linalg.norm(normal)
        origin = np.median(points[near], axis=0)
        height = (points - origin) @ normal
        aside = np.linalg.norm(points - origin - np.outer(height, normal), axis=1)
        on_way = (aside < reach) & (height > 0) & (height < 2 * reach)
        top = height[on_way].max() if on_way.any() else 0.0
        flat = view.fraction_flat(disc(origin, normal, reach), origin, normal)
        clear = view.fraction_clear(disc(origin + (top + reach) * normal, normal, reach))
        score = flat * clear - 0.005 * angle[k] - 2 * max(top - FLAT, 0)
        if best is None or score > best[0]:
            best = (score, origin, normal, flat * clear, top)
    return best[1:]


def make_poses(tool, contact):
    origin, normal, _, top = contact
    low = (tool["spheres"][:, :3] @ normal - tool["spheres"][:, 3]).min()
    high = (tool["spheres"][:, :3] @ normal + tool["spheres"][:, 3]).max()
    start = top + CLEAR - low            # lowest point of the tool is CLEAR above everything
    end = -low - 0.6 * (high - low)      # and at the end 60 % of its height below the plane
    aside = tool["center"] - (tool["center"] @ normal) * normal
    return [origin - aside + h * normal for h in np.linspace(start, end, POSES)]


def ball_places():
    """Returns 50 places spread over the unit ball, each for an equal part of its volume."""
    k = np.arange(50) + 0.5
    z, a, r = 1 - 2 * k / 50, k * 2.399963, (k * 0.618034 % 1) ** (1 / 3)
    return (r * np.array([np.sqrt(1 - z * z) * np.cos(a), np.sqrt(1 - z * z) * np.sin(a), z])).T


def expected_volume(tool, view, position):
    """Returns the fraction of the tool's spheres behind the measured depth, counted place by place."""
    centers, radius = tool["spheres"][:, :3] + position, tool["spheres"][:, 3]
    places = (centers[:, None] + radius[:, None, None] * ball_places()).reshape(-1, 3)
    inside = ~view.is_free(places, 0)
    return inside.reshape(len(radius), -1).mean(axis=1) @ radius ** 3 / (radius ** 3).sum()


def query(executable, folder, tool, scene, poses_file, measure):
    command = [executable, "--tool", folder / f"{tool}.vpmg", "--cloud", folder / f"{scene}.vpmc",
               "--poses", poses_file, "--measure", measure, "--quiet"]
    output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return [json.loads(line) for line in output.splitlines()]


def check(results, contact, expected):
    """Returns the broken promises of one path."""
    numbers = np.array([[r["volume"], r["volume_fraction"], *r["force"], *r["torque"]] for r in results])
    fraction = numbers[:, 1]
    step = np.diff(fraction)
    complaints = []
    if not np.isfinite(numbers).all():
        complaints.append("not finite")
    if fraction[0] != 0:
        complaints.append(f"{fraction[0]:.4f} before contact")
    if step.min() < -NOISE:
        complaints.append(f"falls by {-step.min():.3f}")
    if step.max() > 2 * np.diff(expected).max() + NOISE:
        complaints.append(f"jumps by {step.max():.3f}")
    allowed = 0.05 + (1 - contact[2])
    if abs(fraction[-1] - expected[-1]) > allowed:
        complaints.append(f"ends at {fraction[-1]:.3f}, expected {expected[-1]:.3f}")
    if np.dot(results[-1]["force"], contact[1]) <= 0:
        complaints.append("the force pulls inwards")
    return complaints


def read_tool(folder, name):
    graph = json.loads((folder / f"{name}.graph.json").read_text())
    spheres = np.loadtxt(folder / f"{name}.pack.csv", delimiter=",", skiprows=1)
    return {"spheres": spheres, "center": np.array(graph["center_of_mass"])}


def draw(folder, curves):
    tools = list(dict.fromkeys(tool for tool, _ in curves))
    figure, axes = plt.subplots(2, len(tools), figsize=(7 * len(tools), 9), squeeze=False)
    for column, tool in enumerate(tools):
        for row, measure in enumerate(("refined", "paper")):
            axis = axes[row][column]
            for (name, scene), curve in curves.items():
                if name != tool:
                    continue
                line, = axis.plot(curve["below"], curve[measure], lw=1, label=scene)
                axis.plot(curve["below"], curve["expected"], "--", lw=0.5, color=line.get_color())
            axis.set_title(f"{tool}, {measure} (dashed: expected)")
            axis.set_xlabel("lowest point below the surface, mm")
            axis.set_ylabel("volume, fraction of the tool")
            axis.set_ylim(-0.05, 1.05)
    axes[0][0].legend(fontsize=6, ncol=2)
    figure.tight_layout()
    figure.savefig(folder / "real.png", dpi=100)


def main():
    executable, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    tools = {p.stem: read_tool(folder, p.stem) for p in sorted(folder.glob("*.vpmg"))}
    curves, report, failed = {}, [], 0
    print(f"{'tool':18} {'scene':20} {'flat':>5} {'end':>6} {'expected':>8} {'paper end':>9} {'jump':>6} {'paper':>6}")
    for scene in sorted(p.stem for p in folder.glob("*.vpmc")):
        points, normals = read_ply(folder / f"{scene}.ply")
        view = View(points, json.loads((folder / f"{scene}.normals.json").read_text()))
        for name, tool in tools.items():
            reach = np.max(np.linalg.norm(tool["spheres"][:, :3] - tool["center"], axis=1))
            contact = choose_contact(points[::SPARSE], normals[::SPARSE], reach, view)
            positions = make_poses(tool, contact)
            poses_file = folder / f"{name}.{scene}.poses.jsonl"
            poses_file.write_text("".join(
                json.dumps([*map(float, p), 0, 0, 0, 1]) + "\n" for p in positions))
            expected = np.array([expected_volume(tool, view, p) for p in positions])
            found = {m: query(executable, folder, name, scene, poses_file, m) for m in ("refined", "paper")}
            complaints = check(found["refined"], contact, expected)
            failed += bool(complaints)
            fraction = {m: np.array([r["volume_fraction"] for r in found[m]]) for m in found}
            jump = {m: np.abs(np.diff(fraction[m])).max() for m in found}
            low = (tool["spheres"][:, :3] @ contact[1] - tool["spheres"][:, 3]).min()
            curves[name, scene] = {"below": [-1000 * (low + (p - contact[0]) @ contact[1]) for p in positions],
                                   "expected": expected, **fraction}
            report.append({"tool": name, "scene": scene, "contact": list(contact[0]),
                           "normal": list(contact[1]), "flat": contact[2], "end": fraction["refined"][-1],
                           "expected_end": expected[-1], "jump": jump["refined"], "paper_end": fraction["paper"][-1],
                           "paper_jump": jump["paper"], "complaints": complaints})
            print(f"{name:18} {scene:20} {contact[2]:5.2f} {fraction['refined'][-1]:6.3f} {expected[-1]:8.3f}"
                  f" {fraction['paper'][-1]:9.3f} {jump['refined']:6.3f} {jump['paper']:6.3f}"
                  f"  {'; '.join(complaints) or 'good'}", flush=True)
    (folder / "real.json").write_text(json.dumps(report, indent=2) + "\n")
    draw(folder, curves)
    print(f"\n{len(report) - failed} of {len(report)} paths are good; the picture is {folder / 'real.png'}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
