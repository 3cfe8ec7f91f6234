#!/usr/bin/python3
"""Writes the tables of README.md and tests/results/README.md from tests/results/*.json, between <!-- NAME --> and
<!-- end NAME -->.

usage: result_tables.py [--check]    (--check: change nothing, exit 1 if a table is out of date)
"""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
NOISE = {"none": "clean", "kinect": "Kinect noise"}
GROUPS = {"paper": "3 solids, a wall and an inverted ball",
          "turned": "4 turned tools, 4 scenes",
          "all": "5 tools straight and turned, 6 scenes"}


def results(suite):
    path = ROOT / "tests" / "results" / f"{suite}.json"
    return json.loads(path.read_text()) if path.exists() else None


def table(head, rows):
    lines = [head, ["---"] * len(head)] + rows
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def source(report):
    devices = report.get("devices")
    device = (f"{len(devices)} x {devices[0]}" if devices else
              report.get("device") or report.get("settings", {}).get("device"))
    if device:
        return f"`{report['command']}`, commit {report['commit'][:7]}, {device}."
    machines = report.get("machines") or [report["machine"]]
    cores = ", ".join(f"{machine['cores']} cores of {machine['processor']}" + (f", {machine['gpu']}" if "gpu" in machine else "")
                      for machine in machines)
    return f"`{report['command']}`, commit {report['commit'][:7]}, {cores}."


def percent(value, digits=3):
    return f"{100 * value:.{digits}f}"


def thousands(number):
    return f"{number:,}".replace(",", " ")


def accuracy(report):
    summary = report["settings"]["summary"]
    group = max((s["group"] for s in summary), key=list(GROUPS).index)  # the largest: it holds the others' cases
    rows = []
    for s in sorted((s for s in summary if s["group"] == group),
                    key=lambda s: (s["cloud"], s["noise"] != "none", s["spheres"], s["measure"] != "paper")):
        rows.append([s["cloud"], NOISE[s["noise"]], s["measure"], thousands(s["spheres"]),
                     percent(s["volume_mean"]), percent(s["volume_worst"], 2), percent(s["jump_worst"], 2),
                     percent(s["torque_worst"], 2), f"{s['direction_mean_degrees']:.2f}",
                     f"{s['direction_worst_degrees']:.1f}"])
    return table([f"{GROUPS[group]}: cloud", "image", "measure", "spheres", "mean", "worst", "jump",
                  "torque, worst", "direction, mean °", "worst °"], rows)


def bounds(report):
    missed = [b for b in report["settings"].get("bounds", []) if not b["holds"]]
    kept = len(report["settings"].get("bounds", [])) - len(missed)
    text = f"{kept} of {kept + len(missed)} bounds hold."
    if missed:
        text += " These do not:\n\n" + table(["what", "measured", "bound"],
                                             [[b["what"], f"{b['value']:.4g}", f"{b['bound']:.4g}"] for b in missed])
    return text


def intervals(report):
    ways = [(cloud, noise) for cloud in ("camera", "points") for noise in NOISE]
    of = {(r["scene"], r["cloud"], r["noise"]): r for r in report["results"] if r["group"] == "intervals"}
    cell = lambda r: f"{100 * r['inside']:.0f} / {percent(r['width_mean'])}" if r else ""
    poses = sum(r["poses"] for r in of.values())
    inside = sum(r["inside"] * r["poses"] for r in of.values()) / poses
    return (table(["scene: truths held / mean width, %"] + [f"{cloud}, {NOISE[noise]}" for cloud, noise in ways],
                  [[scene] + [cell(of.get((scene, *way))) for way in ways] for scene in dict.fromkeys(scene for scene, *_ in of)])
            + f"\n\nAll: {percent(inside, 1)} % of {thousands(poses)} truths held. {bounds(report)}")


def tradeoff(report):
    rows = [r for r in report["results"] if r["varied"] == "spheres"]
    knee = report["settings"]["knee"]
    counts = sorted({r["spheres"] for r in rows})
    lines = []
    for noise in ("none", "kinect"):
        for measure in ("refined", "paper"):
            of = {r["spheres"]: r for r in rows if (r["noise"], r["measure"]) == (noise, measure)}
            bold = lambda n, text: f"**{text}**" if measure == "refined" and n == knee[noise] else text
            lines.append([f"{measure}, {NOISE[noise]}: µs"]
                         + [bold(n, thousands(round(of[n]["mean_us"]))) for n in counts])
            lines.append(["mean error, %"] + [bold(n, percent(of[n]["volume_mean"])) for n in counts])
    text = table(["spheres"] + [thousands(n) for n in counts], lines)
    deadlines = [r for r in report["results"] if r["varied"] == "deadline"]
    for asked in sorted({d["asked_us"] for d in deadlines}):
        of = [d for d in deadlines if d["asked_us"] == asked]
        least = min(d["kept"] / d["queries"] for d in of)
        text += (f"\n\n`--deadline-us {asked:g}`: kept by {100 * least:.2f} % of {thousands(of[0]['queries'])} queries"
                 f" in the worst of {len(of)} scenes, with {thousands(min(d['coarsest'] for d in of))} to "
                 f"{thousands(max(d['finest'] for d in of))} spheres.")
    errors = [r for r in report["results"] if r["varied"] == "max-error"]
    if errors:
        worst = max(e["worst"] / e["asked"] for e in errors)
        text += f" `--max-error`: the worst pose of any scene erred by {worst:.2f} of what was asked."
    return text


def tradeoff_on_device(report):
    rows = {(r["measure"], r["noise"], r["spheres"]): r for r in report["results"] if r["varied"] == "spheres"}
    counts = sorted({n for _, _, n in rows})
    deadlines = [r for r in report["results"] if r["varied"] == "deadline"]
    least = min(d["kept"] / d["queries"] for d in deadlines)
    return (table(["spheres"] + [thousands(n) for n in counts],
                  [[f"{NOISE[noise]}: µs"] + [f"{rows['refined', noise, n]['mean_us']:.0f}" for n in counts] for noise in NOISE])
            + f"\n\n`--deadline-us {min(d['asked_us'] for d in deadlines):g}`: kept by {100 * least:.2f} % of "
              f"{thousands(deadlines[0]['queries'])} queries in the worst of {len({(d['shape'], d['scene']) for d in deadlines})} scenes, "
              f"with {thousands(min(d['coarsest'] for d in deadlines))} spheres at least.")


def timing(report):
    rows = {}
    for r in report["results"]:
        rows.setdefault((r["stage"], r["spheres"]), {})[r["threads"]] = r["median_ms"]
    number = lambda ms: f"{ms:.3g}" if ms < 1000 else f"{ms:.0f}"
    threads = sorted({r["threads"] for r in report["results"]})
    return table(["stage", "spheres"] + [f"ms, {t} thread{'s' if t > 1 else ''}" for t in threads],
                 [[stage, thousands(spheres) if spheres else ""] + [number(of[t]) for t in threads]
                  for (stage, spheres), of in rows.items()])


def for_scene(report):
    rows = []
    for r in (r for r in report["results"] if r["varied"] == "for-scene"):
        fixed = {f["spheres"]: f for f in r["fixed"]}
        cell = lambda f: f"{percent(f['volume_mean'])} / {f['median_us']:.0f}"
        rows.append([f"{r['shape']}, {r['scene']}", NOISE[r["noise"]], f"{1e3 * r['smallest_radius']:.1f}",
                     f"{1e3 * r['largest_radius']:.0f}" if "largest_radius" in r else "∞"]
                    + [cell(fixed[n]) for n in (100, 1000, 10000)]
                    + [f"{r[own]['spheres']}: {cell(r[own])}" for own in ("level", "packing")])
    return table(["tool, scene", "image", "r₀", "r₁", "100", "1000", "10 000", "level for the scene",
                  "packing for the scene"], rows)


def replay(report):
    queries = {(r["what"], r["spheres"], r["threads"]): r for r in report["results"] if r["part"] == "query"}
    names = {"refined": "frame prepared", "refined, cold cloud": "frame not prepared",
             "distance grid": "dense distance grid of the tool, penalty force, no volume",
             "voxel count": "OpenVDB voxel count, volume, no force"}
    rows = []
    for what, name in names.items():
        for spheres in sorted({n for (w, n, _) in queries if w == what}):
            of = [queries[what, spheres, threads] for threads in (1, 2)]
            rows.append([name, thousands(spheres) if spheres else ""]
                        + [f"{r['median_us']:.0f} / {r['p99_us']:.0f}" for r in of])
    text = table(["query, 5 % of the tool inside", "spheres", "µs median / p99, 1 thread", "2 threads"], rows)
    for r in (r for r in report["results"] if r["part"] == "outside"):
        text += (f"\n\nTwice the points ({r['cloud']}, {thousands(r['points'])} to {thousands(r['points_doubled'])}), those"
                 f" added out of reach: {100 * r['change']:+.1f} % of the time.")
    return text


def replay_clutter(report):
    rows = [[r["scene"].replace("redkitchen_seq/", ""), thousands(r["spheres"]), f"{r['median_us']:.0f} / {r['p99_us']:.0f}",
             f"{r['grid_median_us']:.0f} / {r['grid_p99_us']:.0f}",
             f"{r['median_us'] / r['grid_median_us']:.2f} / {r['p99_us'] / r['grid_p99_us']:.2f}"]
            for r in report["results"] if r["part"] == "clutter"]
    return table(["poses in clutter", "spheres", "µs median / p99, one core", "distance grid, no volume", "ratio"], rows)


def replay_coherent(report):
    of = {(r["path"], r["spheres"]): r for r in report["results"] if r["part"] == "coherent"}
    levels = sorted({spheres for _, spheres in of})
    paths = sorted({path for path, _ in of}, reverse=True)
    rows = [[path] + [f"{of[path, n]['ratio']:.2f}" for n in levels]
            + ["the same" if all(of[path, n]["same_bits"] for n in levels) else "others"] for path in paths]
    step = next(iter(of.values()))["step_mm"]
    return (table([f"poses {step:g} mm apart"] + [f"{thousands(n)} spheres" for n in levels] + ["bits"], rows)
            + "\n\nRatios to the time of the same poses alone.")


def replay_frames(report):
    frames = {}
    for r in (r for r in report["results"] if r["part"] == "frame"):
        frames.setdefault(r["what"], {})[r["threads"]] = r
    return table(["frame of 640 x 480", "ms, 1 thread", "2 threads"],
                 [[what] + [f"{of[threads]['median_ms']:.2f}" for threads in (1, 2)] for what, of in frames.items()])


def replay_stream(report):
    rows = [[thousands(r["spheres"]), thousands(r["steps"]), r["frames"]]
            + [f"{r[key]:.0f}" for key in ("p50_us", "p99_us", "p99.9_us", "max_us")]
            + [r["deadline_misses"], f"{r['prepare_ms']:.1f}", f"{r['real_time_factor']:.1f}"]
            for r in report["results"] if r["part"] == "stream"]
    soak = next(r for r in report["results"] if r["part"] == "soak")
    return table([f"{report['settings']['recording']}: spheres", "steps", "frames", "µs: median", "p99", "p99.9", "max",
                  "over 1 ms", "frame from its file, ms", "× real time"], rows) + (
        f"\n\nSoak: {thousands(soak['queries'])} queries over {thousands(soak['frames'])} frames:"
        f" {soak['memory_before_mb']:.0f} MB after the first round, {soak['memory_after_mb']:.0f} MB at the end;"
        f" {soak['rounds_with_other_results']} of {soak['rounds']} rounds with other results.")


def packing(report):
    of = {(r["part"], r["shape"], r["method"], r["spheres"]): r for r in report["results"]}
    shapes = report["settings"]["shapes"]
    counts = [1, 10, 100, 1000, 10000]
    cover = lambda r: f"{r['coverage']:.4f}"[1:] if r else ""
    at = lambda shape, method, n: of.get(("coverage", shape, method, n))
    rows = []
    for shape in shapes:
        own = at(shape, "vpm-pack", 10000)
        rows.append([shape] + [cover(at(shape, "vpm-pack", n)) for n in counts]
                    + [f"{own['seconds']:.1f} / {own['cpu_seconds']:.1f} / {own['memory_mb']:.0f}"])
    return table(["spheres"] + [thousands(n) for n in counts] + ["s / CPU s / MB"], rows)


def packing_growth(report):
    of = {(r["shape"], r["method"], r["spheres"]): r["coverage"] for r in report["results"] if r["part"] == "growth"}
    needed = {}
    for r in (r for r in report["results"] if r["part"] == "needed"):
        needed.setdefault((r["shape"], r["coverage"]), {})[r["method"]] = r["spheres"]
    rows = []
    for shape in report["settings"]["shapes"]:
        gains = [f"{100 * (of[shape, 'grown', n] - of[shape, 'greedy', n]):+.2f}"
                 + ("*" if of[shape, "greedy", n] > 0.995 * of[shape, "largest balls", n] else "")
                 for n in (10, 100, 1000)]
        pairs = [needed.get((shape, share)) for share in (0.5, 0.6, 0.65, 0.7)]
        rows.append([shape] + gains + [f"{p['greedy']} → {p['grown']}" if p else "" for p in pairs])
    return table(["`--grow`, points at"] + ["10", "100", "1000"]
                 + [f"spheres for {share} %" for share in (50, 60, 65, 70)], rows)


def packing_cost(report):
    rows = [r for r in report["results"] if r["part"] == "scaling"]
    line = lambda name, value: [name] + [value(r) for r in rows]
    text = table([f"{rows[0]['shape']}, spheres"] + [thousands(r["spheres"]) for r in rows],
                 [line("coverage", lambda r: f"{r['coverage']:.4f}"[1:]),
                  line("s", lambda r: f"{r['seconds']:.2g}" if r["seconds"] < 10 else f"{r['seconds']:.0f}"),
                  line("CPU s", lambda r: f"{r['cpu_seconds']:.2g}" if r["cpu_seconds"] < 10
                       else f"{r['cpu_seconds']:.0f}"),
                  line("µs per sphere", lambda r: f"{1e6 * r['cpu_seconds'] / r['spheres']:.0f}"),
                  line("MB", lambda r: f"{r['memory_mb']:.0f}")])
    meshes = [r for r in report["results"] if r["part"] == "triangles"]
    return text + "\n\n10 000 spheres in " + ", ".join(
        f"{thousands(int(r['method'].split()[0]))} triangles: {r['cpu_seconds']:.1f} CPU s, {r['memory_mb']:.0f} MB"
        for r in meshes) + ", checks of the mesh and certificate included."


def packing_smooth(report):
    rows = [[r["shape"], thousands(int(r["method"].split()[0])), f"{r['coverage']:.4f}"[1:], f"{r['cpu_seconds']:.2f}",
             f"{r['to_capsule']:.1f}", "yes" if r["certified"] else "no"]
            for r in report["results"] if r["part"] == "smooth"]
    spheres = {r["spheres"] for r in report["results"] if r["part"] == "smooth"}
    return table([f"solid, {' to '.join(thousands(n) for n in sorted(spheres))} spheres", "triangles", "coverage", "CPU s",
                  "× the capsule", "certified"], rows)


def packing_fit(report):
    of = {(r["shape"], r["spheres"], r["method"]): r for r in report["results"] if r["part"] == "fit"}
    shapes, counts = dict.fromkeys(shape for shape, _, _ in of), sorted({spheres for _, spheres, _ in of})
    cell = lambda r: f"{r['protrusion']:.2f} / {r['max_protrusion']:.2f}"
    inside = lambda r: f"{r['coverage']:.2f}"
    return table(["solid"] + [f"{n} inside: covered" for n in counts] + [f"{n} that hold it: outside / reach" for n in counts] + ["proven"],
                 [[shape] + [inside(of[shape, n, "greedy"]) for n in counts] + [cell(of[shape, n, "outer"]) for n in counts]
                  + ["yes" if all(r["certified"] for (name, *_), r in of.items() if name == shape) else "no"] for shape in shapes])


def median_and_p99(r):
    return f"{r['median_us']:.0f} / {r['p99_us']:.0f}"


def cuda(report):
    rates = {(r["spheres"], r["tools"] > 1): r["poses_per_second"] for r in report["batch"] if r["measure"] == "refined"}
    rate = lambda *key: thousands(int(float(f"{rates[key]:.3g}"))) if key in rates else ""
    copies = max(r["copies"] for r in report["control_loop"])
    rotated = [r for r in report["control_loop"] if r["copies"] == copies and r["measure"] == "refined"]
    return table(["spheres", "query, µs median / p99", "batches, poses/s", "of eight tools"],
                 [[thousands(r["spheres"]), median_and_p99(r), rate(r["spheres"], False), rate(r["spheres"], True)]
                  for r in rotated])


def cuda_clutter(report):
    sizes = [b["batch"] for b in report["rows"][0]["batches"]]
    rows = [[r["scene"], thousands(r["spheres"]), median_and_p99(r["single"])]
            + [f"{1e6 / b['poses_per_second']:.1f}" for b in r["batches"]] for r in report["rows"]]
    return table(["poses in clutter", "spheres", "one by one, µs median / p99"] + [f"µs a pose, {thousands(n)} together" for n in sizes], rows)


def cuda_frame_rows(report):
    of = {}
    for r in report["control_loop"]:
        kind = "prepared" if "frames" not in r else "behind" if r["behind"] else "new"
        of.setdefault(r["spheres"], {})[kind] = median_and_p99(r)
    return table(["spheres", "query of a prepared cloud, µs median / p99", "in a new image of counts",
                  "in the image before, while the new one is made"],
                 [[thousands(n)] + [r[kind] for kind in ("prepared", "new", "behind")] for n, r in sorted(of.items())])


def cuda_devices(report):
    count = len(report["devices"])
    rounded = lambda rate: thousands(int(float(f"{rate:.3g}")))
    return table(["spheres", "poses/s of one device", f"of {count}", "ratio"],
                 [[thousands(r["spheres"]), rounded(r["poses_per_second_of_one"]), rounded(r["poses_per_second_of_all"]),
                   f"{r['ratio']:.2f}"] for r in report["batch"]])


def scaling(report):
    rows = [r for r in report["results"] if r["part"] == "spheres"]
    line = lambda name, key, digits=0: [name] + [f"{r[key]:.{digits}f}" for r in rows]
    text = table(["spheres"] + [thousands(r["spheres"]) for r in rows],
                 [line("refined, µs median", "refined_median_us"), line("p99", "refined_p99_us")])
    frames = [r for r in report["results"] if r["part"] == "frame"]
    least_to_most = lambda key, scale, digits: (f"{scale * min(r[key] for r in frames):.{digits}f} to "
                                                f"{scale * max(r[key] for r in frames):.{digits}f}")
    return text + (
        f"\n\nAlong the path, {thousands(frames[0]['spheres'])} spheres, {least_to_most('volume_fraction', 100, 1)} % inside, median of"
        f" {report['settings']['rounds']} rounds for each of {len(frames)} frames: refined {least_to_most('refined_us', 1, 0)} µs.")


def reached(accuracy, timing, replay, packing, cuda, clutter, clutter_on_device):
    """Returns the table of the top page: a handful of numbers, each from the results named."""
    rows = []
    group = lambda **wanted: next(s for s in accuracy["settings"]["summary"]
                                  if s["group"] == "all" and s["cloud"] == "camera" and s["spheres"] == 1000
                                  and all(s[key] == value for key, value in wanted.items()))
    volume = lambda s: f"{percent(s['volume_mean'], 2)} %, at worst {percent(s['volume_worst'], 2)} %"
    rows.append(["error of the volume, of the tool's volume", volume(group(measure="refined", noise="none"))])
    rows.append(["with the noise of a Kinect", volume(group(measure="refined", noise="kinect"))])
    rows.append(["by the measure as printed in 2017", volume(group(measure="paper", noise="none"))])
    noisy = group(measure="refined", noise="kinect")
    rows.append(["error of the force's direction, with that noise",
                 f"{noisy['direction_mean_degrees']:.1f}°, at worst {noisy['direction_worst_degrees']:.1f}°"])
    query = lambda n: next(r for r in replay["results"] if r["part"] == "query" and r["what"] == "refined"
                           and r["spheres"] == n and r["threads"] == 1)
    on_device = lambda n: next(r for r in cuda["control_loop"] if r["measure"] == "refined" and r["spheres"] == n
                               and r["copies"] > 1)
    things = next(r for r in clutter["results"] if r["spheres"] == 1000)
    rows.append(["a query among things on a table, one core", f"{things['median_us']:.0f} µs, one in a hundred {things['p99_us']:.0f}"])
    kitchen = next(r for r in clutter_on_device["rows"] if r["scene"] == "kitchen" and r["spheres"] == 1000)
    rows.append([f"in a recorded kitchen, {clutter_on_device['device'].split(',')[0]}",
                 f"{kitchen['single']['median_us']:.0f} µs, one in a hundred {kitchen['single']['p99_us']:.0f}; in batches"
                 f" {1e6 / kitchen['batches'][-1]['poses_per_second']:.0f} µs a pose"])
    for n in (1000, 100000):
        rows.append([f"a query with {thousands(n)} spheres before a wall, one core", f"{query(n)['median_us']:.0f} µs"])
        rows.append([f"the same on {cuda['device'].split(',')[0]}", f"{on_device(n)['median_us']:.0f} µs"])
    frame = next(r for r in timing["results"] if r["stage"] == "frame, all at once" and r["threads"] == 1)
    rows.append(["from a depth image of 640×480 pixels to a scene ready for queries, one core",
                 f"{frame['median_ms']:.1f} ms"])
    packed = next(r for r in packing["results"] if r["part"] == "coverage" and r["shape"] == "bunny"
                  and r["method"] == "vpm-pack" and r["spheres"] == 10000)
    rows.append(["coverage of the bunny by 10 000 spheres, two cores",
                 f"{percent(packed['coverage'], 0)} % in {packed['seconds']:.1f} s"])
    return table(["with 1000 spheres and a camera at 1 m, unless told otherwise", "median or mean"], rows)


def cameras(report):
    of = {(r["condition"], r["cameras"]): r for r in report["results"]}
    names = {"clean": "clean", "noise": "Kinect noise", "holes": "holes of 3 to 12 pixels",
             "small": "poses wrong by 1 mm and .1°", "large": "poses wrong by 5 mm and .5°",
             "clean, registered": "clean, registered", "noise, registered": "Kinect noise, registered",
             "small, registered": "1 mm and .1°, registered", "large, registered": "5 mm and .5°, registered"}
    counts = sorted({count for _, count in of})
    rows = [[text] + [f"{percent(of[name, count]['volume_mean'])} / {percent(of[name, count]['volume_worst'], 2)}" if (name, count) in of else ""
                      for count in counts]
            + [f"{of[name, counts[-1]]['direction_mean_degrees']:.1f}"] for name, text in names.items()]
    times = [of["clean", count]["query_us"] for count in counts]
    rows.append(["time of a query, times that with one"] + [f"{time / times[0]:.1f}" for time in times] + [""])
    most = table(["mean / worst, % of the tool; cameras"] + [str(count) for count in counts] + [f"direction with {counts[-1]}, mean °"], rows)
    scenes = of["clean", counts[-1]]["scenes"]
    by_scene = table([f"{counts[-1]} cameras, mean / worst"] + list(scenes),
                     [[text] + [f"{percent(of[name, counts[-1]]['scenes'][scene]['volume_mean'])} / "
                                f"{percent(of[name, counts[-1]]['scenes'][scene]['volume_worst'], 2)}" for scene in scenes]
                      for name, text in names.items()])
    ready = [name for name in names if "ready_core_ms" in of.get((name, counts[-1]), {})]
    if not ready:  # a report without these times
        return f"{most}\n\n{by_scene}"
    times = table([f"{counts[-1]} images of 640×480 from raw depth to ready, median, ms"] + [names[name] for name in ready],
                  [[text] + [f"{of[name, counts[-1]][field]:.0f}" for name in ready]
                   for text, field in (("time of a core", "ready_core_ms"), ("on two cores", "ready_two_cores_ms"))])
    return f"{most}\n\n{by_scene}\n\n{times}"


def pairs(report):
    before = {r["pair"]: r for r in report["before"]["results"]}
    us = lambda r, place, what: f"{r['us'][place][what]['median']:.0f}"
    rows = []
    for r in report["results"]:
        old, worst = before[r["pair"]], r["us"]["5 %"]
        change = lambda place, what: f"{us(old, place, what)} → {us(r, place, what)}"
        rows.append([r["pair"], " / ".join(thousands(n) for n in r["triangles"]), f"{r['volume_error']:.0e}",
                     us(r, "0 %", "force"), change("5 %", "volume"), f"{worst['volume']['worst']:.0f}",
                     change("5 %", "force"), f"{worst['force']['worst']:.0f}", change("30 %", "force"),
                     f"{1e-6 * r['bytes']:.1f}", f"{100 * r['volume_error_of_spheres']:.0f} %", us(r, "5 %", "spheres")])
    return table(["µs; before → now", "triangles", "error of the volume", "0 %", "5 %: volume", "worst pose",
                  "5 %: with force", "worst pose", "30 %: with force", "both, MB", "spheres: error of the volume", "spheres: 5 %"], rows)


KINDS = {"walls": "walls", "clutter": "clutter", "recorded": "recorded rooms", "pairs": "pairs of solids"}


def of_peers(report, kind, budget):
    """Returns of each peer the rows of the settings that it has within a budget, one for each scene, and the number of scenes."""
    rows = [r for r in report["results"] if r["kind"] == kind]
    peers = {r["peer"]: [] for r in rows}
    for r in rows:
        if budget in r["within_us"]:
            peers[r["peer"]].append(r)
    return peers, len({r["scene"] for r in rows})


def mean_of(rows, what):
    """Returns the mean over scenes, or None where the peer does not tell."""
    told = [r[what]["mean"] for r in rows if r[what]]
    return sum(told) / len(told) if told else None


def peers(report):
    def told(rows, what):
        if mean_of(rows, what) is None:
            return ""
        return f"{percent(mean_of(rows, what))} / {percent(max(r[what]['worst'] for r in rows if r[what]), 2)}"

    tables = []
    for kind in KINDS:
        for budget in report["settings"]["budgets_us"]:
            by_peer, scenes = of_peers(report, kind, budget)
            rows = []
            for peer, fits in by_peer.items():
                if not fits:
                    rows.append([peer, "none is within"] + [""] * 6)
                    continue
                order = list(dict.fromkeys(r["setting"] for r in report["results"] if r["peer"] == peer))  # coarsest first
                settings = sorted({r["setting"] for r in fits}, key=order.index)
                setting = settings[0] if len(settings) == 1 else f"{settings[0]} to {settings[-1]}"
                jitter = mean_of(fits, "jitter")
                span = lambda key, scale, digits: " to ".join(dict.fromkeys(f"{scale * f(r[key] for r in fits):.{digits}f}" for f in (min, max)))
                memory = span("bytes", 1e-6, 1)
                if any(r["bytes"] < r["bytes_of_view"] for r in fits):
                    memory += f"; {span('bytes_of_view', 1e-6, 0)}"
                rows.append([peer, setting + ("" if len(fits) == scenes else f" (in {len(fits)} of {scenes})"), told(fits, "volume"),
                             told(fits, "force"), told(fits, "torque"), "" if jitter is None else percent(jitter), memory,
                             f"{span('median_us', 1, 0)} [{max(r['p99_us'] for r in fits):.0f}]"])
            if rows:
                tables.append(table([f"{KINDS[kind]}, {scenes} scene{'s' if scenes > 1 else ''}, within {budget:.0f} µs", "setting", "volume", "force", "torque",
                                     "jitter", "MB; of the view", "µs [p99]"], rows))
    return "\n\n".join(tables)


def peers_asked(report):
    rows = []
    for kind in KINDS:
        for budget in report["settings"]["budgets_us"]:
            by_peer, all_scenes = of_peers(report, kind, budget)
            ours = by_peer.get("vpm", [])
            scenes = {r["scene"] for r in ours}
            shells = {peer: [r for r in fits if r["scene"] in scenes] for peer, fits in by_peer.items()
                      if peer.startswith("pointshell") and "denoised" not in peer}
            shells = {peer: fits for peer, fits in shells.items() if len(fits) == len(scenes) and mean_of(fits, "force") is not None}
            if not shells or not ours:
                continue
            peer, fits = min(shells.items(), key=lambda item: mean_of(item[1], "force"))
            number = lambda x: "> 1000" if x > 1000 else f"{x:.0f}" if x >= 10 else f"{x:.2g}"
            ratio = lambda of: "" if of(ours) is None else number(of(fits) / of(ours))
            by_mean = number(mean_of([r["mean_above_ten"] for r in fits], "force") / mean_of(ours, "force"))
            memory = lambda key: f"{sum(r[key] for r in ours) / sum(r[key] for r in fits):.2g}"
            part = "" if len(scenes) == all_scenes else f", {len(scenes)} of {all_scenes} scenes"
            rows.append([f"{KINDS[kind]}, {budget:.0f} µs{part}", f"{peer}: {fits[0]['setting']}", ratio(lambda r: mean_of(r, "volume")), ratio(lambda r: mean_of(r, "force")), by_mean,
                         ratio(lambda r: mean_of(r, "torque")), ratio(lambda r: mean_of(r, "jitter")), memory("bytes"), memory("bytes_of_view")])
    return table(["", "the shell with the least error of forces", "its error of the volume / ours", "force (asked: 10)", "force by the mean above ten contacts", "torque", "jitter / ours (asked: 5)",
                  "our memory / its (asked: .1)", "with a field of the view"], rows)


def threads(report):
    kinds = {"clear": "poses that touch nothing", "deep": "poses in the surface"}
    of = {(r["poses"], r["threads"]): r for r in report["results"]}
    rows = []
    for count in sorted({count for _, count in of}):
        row = [count]
        for kind in kinds:
            rate, one = of[kind, count]["poses_per_second"], of[kind, 1]["poses_per_second"]
            row += [thousands(round(rate)), f"{rate / one / count:.2f}"]
        rows.append(row)
    return table(["threads, each on a core"] + [head for name in kinds.values() for head in (f"{name}, a second", "of N times one thread's")], rows)


def pack_threads(report):
    one = {r["spheres"]: r for r in reversed(report["results"])}  # with the fewest threads
    return table(["spheres", "threads, each on a core", "s", "CPU s", "times as fast", "of as many times"],
                 [[thousands(r["spheres"]), r["threads"], f"{r['seconds']:.1f}", f"{r['cpu_seconds']:.0f}", f"{faster:.1f}",
                   f"{faster / (r['threads'] / one[r['spheres']]['threads']):.2f}"]
                  for r in report["results"] for faster in [one[r["spheres"]]["seconds"] / r["seconds"]]])


def python(report):
    kinds, ways = {"clear": "poses that touch nothing", "deep": "poses in the surface"}, {"batch": "at once", "singles": "one by one"}
    return table(["what is asked", "C++, µs a pose", "Python, µs a pose", "Python over C++, median (quartiles)", "added, µs a pose"],
                 [[f"{kinds[r['poses']]}, {ways[r['way']]}", f"{r['cpp_us']:.1f}", f"{r['python_us']:.1f}",
                   "{:.3f} ({:.3f} to {:.3f})".format(r["ratio"], *r["quartiles"]), f"{r['added_us']:.2f}"] for r in report["results"]])


def over_a_list(report):
    of = {(r["job"], r["jobs"]): r for r in report["results"]}
    counts = sorted({count for _, count in of})
    return table(["frames a second; slowest and fastest round"] + [f"{n} job{'s' if n > 1 else ''}, each on a core" for n in counts],
                 [[job] + ["{:.0f} ({:.0f} to {:.0f})".format(of[job, n]["frames_per_second"], *of[job, n]["range"]) for n in counts]
                  for job in dict.fromkeys(job for job, _ in of)])


def list_on_gpus(report):
    return table(["GPUs", "jobs", "frames a second; slower and faster round", "seconds to the first"],
                 [[row["gpus"] or "none", row["jobs"], "{:.0f} ({:.0f} to {:.0f})".format(row["frames_per_second"], *row["range"]),
                   f"{row['seconds_to_first']:.1f}"] for row in report["results"]])


def fuzz(report):
    rows = [[name, thousands(t["executions"]), f"{t['seconds'] / 60:.0f}", thousands(t["coverage"]), len(t["findings"])]
            for name, t in report["targets"].items()]
    return table(["reader", "executions", "minutes", "edges covered", "findings"], rows)


# Maps each page to its tables: the function that makes it, and the suites whose results it takes.
PAGES = {"README.md": {"reached": (reached, "accuracy", "timing", "replay", "packing", "cuda", "replay_clutter", "cuda_clutter")},
         "tests/results/README.md": {
             "accuracy": (accuracy, "accuracy"), "bounds": (bounds, "accuracy"),
             "bounds solid": (bounds, "accuracy_solid"), "intervals": (intervals, "intervals"),
             "tradeoff": (tradeoff, "tradeoff"), "tradeoff on a device": (tradeoff_on_device, "tradeoff_cuda"),
             "for-scene": (for_scene, "tradeoff"), "timing": (timing, "timing"),
             "packing": (packing, "packing"), "packing growth": (packing_growth, "packing"),
             "packing cost": (packing_cost, "packing"), "packing smooth": (packing_smooth, "packing_smooth"), "packing threads": (pack_threads, "pack_threads"),
             "packing fit": (packing_fit, "packing_fit"),
             "replay": (replay, "replay"), "replay clutter": (replay_clutter, "replay_clutter"),
             "replay coherent": (replay_coherent, "replay"), "replay frames": (replay_frames, "replay"),
             "replay stream": (replay_stream, "replay"), "replay stream on a device": (replay_stream, "replay_cuda"),
             "cuda clutter": (cuda_clutter, "cuda_clutter"), "cuda": (cuda, "cuda"), "cuda devices": (cuda_devices, "cuda_devices"),
             "cuda frames": (cuda_frame_rows, "cuda_frames"), "cuda million": (cuda_frame_rows, "cuda_frames_million"),
             "scaling": (scaling, "scaling"), "threads": (threads, "threads"), "python": (python, "python"),
             "list": (over_a_list, "list"), "list on GPUs": (list_on_gpus, "list_gpus"), "cameras": (cameras, "cameras"), "pairs": (pairs, "solid_pairs"),
             "peers asked": (peers_asked, "peers"), "peers": (peers, "peers"),
             "fuzz": (fuzz, "fuzz")}}


def commits(suites, reports):
    return "Commits: " + ", ".join(f"{suite} {report['commit'][:7]}" for suite, report in zip(suites, reports)) + "."


def filled(page, text):
    """Returns the page's text with every table renewed."""
    for name, (make, *suites) in PAGES[page].items():
        begin, end = f"<!-- {name} -->", f"<!-- end {name} -->"
        reports = [results(suite) for suite in suites]
        if None in reports or begin not in text:
            sys.exit(f"result_tables.py: {page} lacks {begin}, or tests/results one of {', '.join(suites)}")
        before, rest = text.split(begin)
        after = rest.split(end)[1]
        told = source(reports[0]) if len(suites) == 1 else commits(suites, reports)
        text = f"{before}{begin}\n{make(*reports)}\n\n{told}\n{end}{after}"
    return text


def main():
    for page in PAGES:
        path = ROOT / page
        text = path.read_text()
        wanted = filled(page, text)
        if "--check" not in sys.argv:
            path.write_text(wanted)
        elif text != wanted:
            sys.exit(f"{page}: its tables differ from tests/results; run scripts/result_tables.py")


if __name__ == "__main__":
    main()
