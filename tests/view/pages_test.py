#!/usr/bin/python3
"""Opens the pages that the tools write with --view in headless Chromium: what they show is what the results say.

usage: pages_test.py BIN EXAMPLE     EXAMPLE: what make-example wrote; exit code 77: skipped, no Chromium or no drawing library
"""
import io
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import headless_page  # noqa: E402

BIN, EXAMPLE, FOLDER, BROWSER = pathlib.Path(), pathlib.Path(), pathlib.Path(), None
NAME = "<script>alert(1)</script>.vpmg"  # of a file, as a page must show it
OPEN_MESH = "OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 4\n"
WINDOW = (820, 460)  # pixels, which the processor draws: the time of this test is theirs; up to a width of 800 a page is a phone's
PHONE = (390, 844)
HALVES = (240, 320)  # rows and columns of the demo's image, of which every second is taken
HALF_INTRINSICS = ("--intrinsics", "262.5,262.5,159.75,119.75", "--depth-scale", "5000")


def run(tool, *arguments, code=0):
    done = subprocess.run([str(BIN / tool), *map(str, arguments)], cwd=FOLDER, capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{tool} {arguments}: exit code {done.returncode}: {done.stderr}")
    return done


def refused(name, mesh):
    """Gives vpm-pack a mesh that it refuses, and returns what it says; the page of the mesh is NAME.html."""
    (FOLDER / f"{name}.off").write_text(mesh)
    return run("vpm-pack", f"{name}.off", "-o", f"{name}.vpmp", "--view", f"{name}.html", code=1).stderr


def results(name):
    return [json.loads(line) for line in (FOLDER / name).read_text().splitlines()]


def pixels(png):
    import matplotlib.image
    return matplotlib.image.imread(io.BytesIO(png))[:, :, :3].astype(float)


def scene(page):
    """Returns the picture without panel and bar."""
    box = page.evaluate("(({x, y, width, height}) => [x, y, width, height])"
                        "(document.getElementById('stage').getBoundingClientRect())")
    x, y, width, height = map(round, box)
    return pixels(page.screenshot())[y:y + height, x:x + width]


def share(image, condition):
    red, green, blue = image[:, :, 0], image[:, :, 1], image[:, :, 2]
    return float(numpy.mean(condition(red, green, blue)))


# Areas by colour: hues survive shading.
def surface(r, g, b):
    return (b > 1.12 * r) & (b > g) & (g > r) & (b > 0.3) & (r > 0.18) & (r < 0.75)


def inside(r, g, b):
    return (r > 0.35) & (r > 3 * g) & (r > 3 * b)


def boundary(r, g, b):
    return (r > 0.45) & (g > 0.4 * r) & (g < 0.68 * r) & (b < 0.25 * r)


def out_of_view(r, g, b):
    return (b > 1.05 * r) & (r > 1.05 * g)


def write_depth(name, depth):
    """Writes a 16-bit grey PNG."""
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in depth)
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", depth.shape[1], depth.shape[0], 16, 0, 0, 0, 0)
    (FOLDER / name).write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) +
                                chunk(b"IEND", b""))


def write_points(name, count):
    """Writes a wavy floor 1 m before the camera, as a PLY cloud with normals."""
    side = int(count ** 0.5)
    v, u = numpy.mgrid[0:side, 0:side] / side - 0.5
    columns = [u, v, 1 + 0.01 * numpy.sin(40 * u), 0 * u, 0 * u, 0 * u - 1]
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {side * side}\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) + "end_header\n"
    body = numpy.stack([c.ravel() for c in columns], axis=1).astype("<f4").tobytes()
    (FOLDER / name).write_bytes(header.encode() + body)


def make_demo():
    shutil.copytree(EXAMPLE, FOLDER, dirs_exist_ok=True)
    run("vpm-pack", "tool.off", "-o", "tool.vpmp", "--spheres", 300, "--report", "pack.json", "--export",
        "tool.csv", "--view", "pack.html")
    run("vpm-graph", "tool.vpmp", "-o", "tool.vpmg", "--levels", 50, "--report", "graph.json", "--view", "graph.html")
    import matplotlib.image
    depth = matplotlib.image.imread(FOLDER / "depth.png")[::2, ::2]
    write_depth("depth.png", numpy.rint(depth * 65535))
    run("vpm-normals", "depth.png", "-o", "scene.vpmc", *HALF_INTRINSICS, "--report", "normals.json", "--view",
        "normals.html")
    run("vpm-query", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--poses", "poses.jsonl", "-o", "results.jsonl",
        "--view", "query.html")


class PageTest(unittest.TestCase):
    demo_pages = {}  # for a desk and for a phone

    def open(self, name, width=WINDOW[0], height=WINDOW[1], phone=False):
        page = self.opened(name, width, height, phone)
        self.addCleanup(page.close)
        return page

    def opened(self, name, width, height, phone):
        page = BROWSER.open(FOLDER / name, width, height, phone)
        self.assertEqual(page.faults, [])
        self.assertEqual([url for url in page.requests if not url.startswith(("file:", "data:", "blob:"))], [])
        return page

    def demo(self, phone=False):
        """Returns query.html at its first step and point of view: most of a page's time is taken to open it, so it is opened once."""
        if phone not in self.demo_pages:
            self.demo_pages[phone] = self.opened("query.html", *(PHONE if phone else WINDOW), phone)
            self.demo_pages[phone].evaluate("first = null")
        page = self.demo_pages[phone]
        page.call("Page.bringToFront")  # pages behind others are not drawn
        page.evaluate("first ??= vpm.report().step; vpm.setStep(first); vpm.setView('overview')")
        return page

    def layer(self, page, name):
        return next(layer for layer in page.report()["layers"] if layer["name"] == name)

    def numbers(self, page, body=0):
        return {n["name"]: n["values"] for n in page.report()["numbers"] if n["body"] == body}

    def assert_shows(self, page, result, body=0):
        numbers = self.numbers(page, body)
        for name, key, size in (("volume", "volume", 1), ("of the tool", "volume_fraction", 100),
                                ("boundary spheres", "boundary", 1), ("inside spheres", "inside", 1)):
            self.assertAlmostEqual(numbers[name][0], size * result[key], delta=1e-6 * abs(size * result[key]))
        for name, key in (("seen free", "seen_free"), ("unseen", "unseen"), ("out of view", "out_of_view")):
            self.assertEqual(name in numbers, key in result)
            if key in result:
                self.assertAlmostEqual(numbers[name][0], 100 * result[key], delta=1e-4)
        for shown, true in zip(numbers["force / stiffness"], result["force"]):
            self.assertAlmostEqual(shown, true, delta=1e-6 * abs(true))

    def assert_fits(self, page):
        """Nothing is wider than the window, and each part has a place."""
        self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth - innerWidth"), 0)
        for part in ("scene", "panel", "layers", "numbers"):
            self.assertGreater(page.evaluate(f"document.getElementById('{part}').getBoundingClientRect().height"), 40)


class Query(PageTest):
    def test_shows_the_counts_and_numbers_of_the_results(self):
        page = self.demo()
        lines = results("results.jsonl")
        self.assertEqual(page.report()["steps"], len(lines))
        for step in (0, 60, len(lines) - 1):
            page.evaluate(f"vpm.setStep({step})")
            self.assert_shows(page, lines[step])
            counts = self.layer(page, "spheres by state")["counts"]
            self.assertEqual(counts[1:3], [lines[step]["boundary"], lines[step]["inside"]])
            self.assertEqual(sum(counts), 300)
        depth = json.loads((FOLDER / "normals.json").read_text())
        self.assertEqual(self.layer(page, "measured surface")["count"], HALVES[0] * HALVES[1] - depth["invalid"])

    def test_slider_changes_pose_and_numbers(self):
        page = self.demo()
        before = page.report()["texts"]
        page.evaluate("slider = document.getElementById('slider'); slider.value = 3;"
                      "slider.dispatchEvent(new Event('input'))")
        report = page.report()
        self.assertEqual((report["step"], report["where"]), (3, "pose 3 of 0 to 120"))
        self.assertNotEqual(report["texts"], before)
        self.assertIn("volume0 ", report["texts"][0])
        page.call("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight")
        self.assertEqual(page.report()["step"], 4)

    def test_button_plays_the_path_and_stops(self):
        page = self.demo()
        # The path begins anew after its last pose, so the steps are noted as the page goes through them.
        page.evaluate("vpm.setStep(0); seen = new Set();"
                      "watch = setInterval(() => seen.add(document.getElementById('slider').value), 10)")
        page.evaluate("document.getElementById('play').click()")
        deadline = time.monotonic() + 60
        while page.evaluate("seen.size") < 3 and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertGreaterEqual(page.evaluate("seen.size"), 3)
        page.evaluate("document.getElementById('play').click()")
        stopped = page.report()["step"]
        time.sleep(0.5)
        self.assertEqual(page.report()["step"], stopped)

    def test_screenshots_show_tool_and_surface_on_desks_and_phones(self):
        for phone in (False, True):
            page = self.demo(phone)
            self.assert_fits(page)
            for view in ("overview", "side", "contact"):
                page.evaluate(f"vpm.setView('{view}')")
                image = scene(page)
                self.assertGreater(share(image, inside), 0.002, f"{view} {phone}")
                self.assertGreater(share(image, boundary), 0.0005, f"{view} {phone}")
            page.evaluate("vpm.setView('camera')")
            self.assertGreater(share(scene(page), surface), 0.15)

    def test_software_draws_coarser_while_the_scene_turns(self):
        page = self.demo()
        self.assertTrue(page.report()["bySoftware"])
        page.settle()
        at_rest = page.report()["load"]
        page.mouse("mousePressed", 600, 300)
        for x in (620, 640):
            page.mouse("mouseMoved", x, 300, buttons=1)
            page.settle()
        self.assertLess(page.report()["load"]["triangles"], at_rest["triangles"])
        page.mouse("mouseReleased", 640, 300)
        page.settle()
        self.assertEqual(page.report()["load"], at_rest)

    def test_mouse_and_touch_turn_the_scene(self):
        page = self.demo()
        before = scene(page)
        page.mouse("mousePressed", 600, 300)
        for x in (620, 660, 700):
            page.mouse("mouseMoved", x, 320, buttons=1)
        page.mouse("mouseReleased", 700, 320)
        turned = scene(page)
        self.assertGreater(numpy.abs(turned - before).mean(), 0.005)
        page.call("Input.dispatchMouseEvent", type="mouseWheel", x=600, y=300, deltaX=0, deltaY=-300)
        self.assertGreater(numpy.abs(scene(page) - turned).mean(), 0.005)
        phone = self.demo(phone=True)
        before = scene(phone)
        for kind, x in (("touchStart", 150), ("touchMove", 190), ("touchMove", 240), ("touchEnd", None)):
            points = [] if x is None else [{"x": x, "y": 250}]
            phone.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self.assertGreater(numpy.abs(scene(phone) - before).mean(), 0.005)

    def test_switches_hide_layers(self):
        page = self.demo()
        page.evaluate("vpm.setView('side')")
        self.assertGreater(share(scene(page), inside), 0.002)
        page.evaluate("vpm.setLayer('spheres by state', false)")
        self.addCleanup(page.evaluate, "vpm.setLayer('spheres by state', true); vpm.setLayer('not seen by the camera', false)")
        self.assertLess(share(scene(page), inside), 0.0005)
        without = scene(page)
        page.evaluate("vpm.setLayer('not seen by the camera', true)")
        self.assertGreater(numpy.mean(without - scene(page) > 0.05), 0.01)  # it is darker

    def test_what_is_out_of_view_has_its_own_colour(self):
        for name, x in (("in_view", 0), ("half_in_view", 0.58)):
            run("vpm-query", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--pose", f"{x},0,0.95,0,0,0,1", "-o", f"{name}.jsonl",
                "--view", f"{name}.html", "--quiet")
            page = self.open(f"{name}.html")
            page.evaluate("vpm.setView('side')")
            without = share(scene(page), out_of_view)
            page.evaluate("vpm.setLayer('not seen by the camera', true)")
            shown = share(scene(page), out_of_view) - without
            fraction = results(f"{name}.jsonl")[0]["out_of_view"]
            if name == "in_view":
                self.assertEqual(fraction, 0)
                self.assertLess(shown, 0.001)
            else:
                self.assertGreater(fraction, 0.2)
                self.assertGreater(shown, 0.02)

    def test_names_are_text(self):
        (FOLDER / "scripts").mkdir(exist_ok=True)
        (FOLDER / "scripts" / NAME.replace("/", "_")).write_bytes((FOLDER / "tool.vpmg").read_bytes())
        run("vpm-query", "--tool", "scripts/" + NAME.replace("/", "_"), "--cloud", "scene.vpmc", "--pose",
            "0,0,0.97,0,0,0,1", "-o", "named.jsonl", "--view", "named.html")
        page = self.open("named.html")
        self.assertIn("<script>alert(1)<_script>", page.evaluate("document.getElementById('title').textContent"))
        self.assertEqual(page.evaluate("document.querySelectorAll('h1 script, td script, span script').length"), 0)

    def test_solids_of_the_scene_move_with_the_steps(self):
        (FOLDER / "moves.jsonl").write_text("".join(
            json.dumps({"tool": [0, 0, 1, 0, 0, 0, 1], "solids": [[x, 0, 1, 0, 0, 0, 1]]}) + "\n" for x in (0.3, 0.02)))
        run("vpm-query", "--tool", "tool.vpmg", "--solid", "tool.off", "--poses", "moves.jsonl", "-o", "moves.out",
            "--view", "moves.html", "--quiet")
        page, lines = self.open("moves.html"), results("moves.out")
        self.assertEqual(self.layer(page, "solid tool.off")["count"], self.layer(page, "tool's mesh")["count"])
        places = []
        for step in (0, 1):
            page.evaluate(f"vpm.setStep({step})")
            self.assert_shows(page, lines[step])
            places.append(page.report()["bodies"][1]["center"])
        self.assertAlmostEqual(places[0][0] - places[1][0], 0.28, delta=1e-6)
        blue = lambda r, g, b: (b > 1.1 * r) & (b > g) & (b > 0.25)
        shown = share(scene(page), blue)
        page.evaluate("vpm.setLayer('solid tool.off', false)")
        self.assertGreater(shown, share(scene(page), blue) + 0.003)

    def test_several_tools(self):
        run("vpm-query", "--tool", "tool.vpmg", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--poses",
            "poses.jsonl", "--batch", 50, "-o", "two.jsonl", "--view", "two.html")
        page, lines = self.open("two.html"), results("two.jsonl")
        page.evaluate("vpm.setStep(110)")
        for tool in (0, 1):
            self.assert_shows(page, lines[2 * 110 + tool], tool)

    def test_every_camera_has_its_frustum_and_what_was_removed_from_its_image(self):
        for name, at, removed in (("left", "0,0,0,0,0,0,1", ["--remove", "tool.off@0,0,0.95,0,0,0,1"]), ("right", "0.1,0,0,0,0,0,1", [])):
            run("vpm-normals", "depth.png", "-o", f"{name}.vpmc", *HALF_INTRINSICS, "--camera-pose", at, *removed, "--quiet")
        run("vpm-query", "--tool", "tool.vpmg", "--cloud", "left.vpmc", "--cloud", "right.vpmc", "--pose", "0,0,0.95,0,0,0,1", "-o", "two_cameras.jsonl",
            "--view", "two_cameras.html", "--quiet")
        page = self.open("two_cameras.html")
        names = [layer["name"] for layer in page.report()["layers"]]
        self.assertEqual([name for name in names if name.startswith("camera")], ["camera of left.vpmc", "camera of right.vpmc"])
        self.assertEqual([name for name in names if name.startswith("removed")], ["removed from the image of left.vpmc"])
        self.assertGreater(self.layer(page, "removed from the image of left.vpmc")["count"], 1000)
        page.evaluate("vpm.setView('all')")
        shown = scene(page)
        for name in ("removed from the image of left.vpmc", "camera of left.vpmc", "camera of right.vpmc"):
            page.evaluate(f"vpm.setLayer('{name}', false)")
            without = scene(page)
            self.assertGreater(numpy.mean(numpy.abs(without - shown).max(axis=2) > 0.05), 0.0003, name)
            shown = without
        self.assertEqual(page.report()["faults"], [])

    def test_frames_follow_the_steps(self):
        folder = FOLDER / "frames"
        folder.mkdir(exist_ok=True)
        for k, z in enumerate((5000, 5200, 5400)):
            write_depth(f"frames/frame-{k:06}.depth.png", numpy.full(HALVES, z))
        (FOLDER / "path.txt").write_text("".join(f"{k / 30} 0 0 1 0 0 0 1\n" for k in range(4)))
        run("vpm-normals", "frames", *HALF_INTRINSICS, "--quiet", "-o", "clouds")
        run("vpm-query", "--tool", "tool.vpmg", "--frames", "clouds", "--trajectory", "path.txt", "--rate", 90,
            "--quiet", "-o", "frames.jsonl", "--view", "frames.html")
        page, lines = self.open("frames.html"), results("frames.jsonl")
        self.assertEqual(page.report()["steps"], len(lines))
        for step in (0, len(lines) - 1):
            page.evaluate(f"vpm.setStep({step})")
            self.assert_shows(page, lines[step])
        self.assertEqual(len({line["frame"] for line in lines}), 3)
        self.assertGreater(lines[0]["volume"], lines[-1]["volume"])
        # Steps before the first frame show none.
        run("vpm-query", "--tool", "tool.vpmg", "--frames", "clouds", "--poses", "path.txt", "--rate", 30, "--frame-latency", 0.05, "--quiet",
            "-o", "late.jsonl", "--view", "late.html")
        page = self.open("late.html")
        for step, shown in ((0, False), (3, True), (1, False)):
            page.evaluate(f"vpm.setStep({step})")
            self.assertEqual([self.layer(page, name)["visible"] for name in ("measured surface", "camera")], [shown, shown])

    def test_a_million_points_without_a_camera(self):
        write_points("million.ply", 1_000_000)
        run("vpm-normals", "million.ply", "-o", "floor.vpmc", "--quiet")
        run("vpm-query", "--tool", "tool.vpmg", "--cloud", "floor.vpmc", "--poses", "poses.jsonl", "-o", "floor.jsonl",
            "--view", "floor.html", "--quiet")
        self.assertLess((FOLDER / "floor.html").stat().st_size, 6_000_000)
        page = self.open("floor.html")
        shown = self.layer(page, "measured points")["count"]
        self.assertTrue(200_000 <= shown <= 300_000, shown)
        self.assertIn("one point in 4", page.evaluate("document.getElementById('facts').textContent"))
        page.evaluate("vpm.setView('all')")
        self.assertGreater(share(scene(page), surface), 0.02)

    def test_a_tool_that_no_camera_sees_is_said(self):
        run("vpm-query", "--tool", "tool.vpmg", "--cloud", "scene.vpmc", "--pose", "0,0,-3,0,0,0,1", "-o",
            "behind.jsonl", "--view", "behind.html")
        page = self.open("behind.html")
        notes = page.evaluate("document.getElementById('notes').textContent")
        self.assertIn("No camera sees the tool", notes)
        self.assertIn("touches nothing", notes)
        self.assertTrue(page.evaluate("document.getElementById('bar').hidden"))
        page.evaluate("vpm.setView('contact')")
        page.evaluate("vpm.setView('all')")
        self.assertEqual(page.report()["faults"], [])


    def test_a_recording_shows_the_frame_of_each_step(self):
        recording = pathlib.Path(__file__).resolve().parents[3] / "shared/data/depth/redkitchen_seq"
        if not recording.is_dir():
            self.skipTest("the recording is not there")
        camera = numpy.loadtxt(recording / "frame-000460.pose.txt")
        steps = [(k / 30, camera[:3, :3] @ (0, 0, 1.2 + 0.1 * k) + camera[:3, 3]) for k in range(5)]
        (FOLDER / "kitchen.txt").write_text("".join(f"{t} {x} {y} {z} 0 0 0 1\n" for t, (x, y, z) in steps))
        run("vpm-query", "--tool", "tool.vpmg", "--frames", recording, "--trajectory", "kitchen.txt", "--rate", 100,
            "--intrinsics", "585,585,320,240", "--quiet", "-o", "kitchen.jsonl", "--view", "kitchen.html")
        page, lines = self.open("kitchen.html"), results("kitchen.jsonl")
        self.assertEqual(page.report()["steps"], len(lines))
        page.evaluate(f"vpm.setStep({len(lines) - 1})")
        self.assert_shows(page, lines[-1])
        page.evaluate("vpm.setView('camera')")
        self.assertGreater(share(scene(page), surface), 0.1)


class OtherTools(PageTest):
    def test_a_packing_grows_with_the_slider(self):
        page, report = self.open("pack.html"), json.loads((FOLDER / "pack.json").read_text())
        self.assert_fits(page)
        self.assertAlmostEqual(self.numbers(page, -1)["covered"][0], 100 * report["coverage"], places=3)
        full = scene(page)
        left = self.layer(page, "not covered")["count"]
        page.evaluate("vpm.setStep(0)")
        self.assertEqual(page.report()["where"], "1 of 300 spheres")
        self.assertGreater(self.layer(page, "not covered")["count"], 2 * left)
        self.assertGreater(numpy.abs(scene(page) - full).mean(), 0.01)

    def test_a_refused_mesh_shows_its_defects(self):
        self.assertIn("the mesh is open", refused("open", OPEN_MESH))
        page = self.open("open.html")
        self.assertEqual(self.layer(page, "holes")["count"], 1)
        self.assertIn("the mesh is open", page.evaluate("document.getElementById('notes').textContent"))
        orange = lambda r, g, b: (r > 0.7) & (g > 0.2) & (g < 0.55) & (b < 0.25)
        self.assertGreater(share(scene(page), orange), 0.0003)

    def test_an_edge_of_four_triangles_is_shown(self):
        refused("edge", "OFF\n6 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 -1 0\n0 0 -1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
                        "3 0 4 1\n3 0 1 5\n3 0 5 4\n3 1 4 5\n")
        page = self.open("edge.html")
        self.assertEqual(self.layer(page, "non-manifold edges")["count"], 1)
        self.assertGreater(numpy.std(scene(page)), 0.02)

    def test_other_tools_fit_a_phone(self):
        refused("phone", OPEN_MESH)
        for name in ("pack.html", "graph.html", "normals.html", "phone.html"):
            page = self.open(name, *PHONE, True)
            self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth - innerWidth"), 0, name)
            self.assertGreater(numpy.std(scene(page)), 0.02, name)

    def test_a_scan_tells_which_pixels_have_no_normal(self):
        page, report = self.open("normals.html"), json.loads((FOLDER / "normals.json").read_text())
        facts = page.evaluate("document.getElementById('facts').textContent")
        for name, key in (("points with normals", "points"), ("not measured", "invalid"),
                          ("measured, no normal", "without_normal")):
            self.assertIn(f"{name}{report[key]}", facts)
        self.assertEqual(page.evaluate("document.querySelectorAll('.picture, .chart').length"), 2)
        image = scene(page)
        self.assertGreater(numpy.std(image), 0.05)

    def test_a_graph_has_its_edges_bridges_and_cells(self):
        page, report = self.open("graph.html"), json.loads((FOLDER / "graph.json").read_text())
        smallest = page.evaluate("Math.min(...document.querySelector('#key .ends').textContent.match(/[0-9.]+/g))")
        radii = [1000 * float(row.split(",")[3]) for row in (FOLDER / "tool.csv").read_text().splitlines()[1:]]
        self.assertAlmostEqual(smallest, min(radii), delta=0.001 * min(radii))
        for level, facts in enumerate(report["levels"]):
            page.evaluate(f"vpm.setStep({level})")
            shown = {layer["name"]: layer["count"] for layer in page.report()["layers"] if layer["visible"]}
            self.assertEqual(shown["edges"] + shown.get("bridges", 0), facts["edges"])
            self.assertEqual(shown.get("bridges", 0), facts["bridges"])
            self.assertEqual(shown["spheres by radius"], facts["spheres"])
        page.evaluate("vpm.showCell(0)")
        self.assertGreater(page.report()["cell"]["samples"], 0)
        page.evaluate("vpm.showCell(-1)")
        page.evaluate("vpm.setLayer('solid', false)")
        for x in range(350, 815, 15):  # somewhere on the ring
            page.mouse("mousePressed", x, 220)
            page.mouse("mouseReleased", x, 220)
            if page.report()["cell"]:
                break
        self.assertGreater(page.report()["cell"]["samples"], 0)

    def test_a_million_pixels(self):
        v, u = numpy.mgrid[0:1000, 0:1000]
        write_depth("million.png", (2000 + 200 * numpy.sin(u / 50) * numpy.cos(v / 70)).astype(int))
        run("vpm-normals", "million.png", "-o", "million.vpmc", "--intrinsics", "900,900,499.5,499.5", "--view",
            "million.html", "--quiet")
        self.assertLess((FOLDER / "million.html").stat().st_size, 5_000_000)
        page = self.open("million.html")
        self.assertEqual(self.layer(page, "surface by normal")["count"], 500 * 500)


def main():
    global BIN, EXAMPLE, FOLDER, BROWSER
    BIN, EXAMPLE = (pathlib.Path(sys.argv.pop(1)).resolve() for _ in range(2))
    with tempfile.TemporaryDirectory() as folder:
        FOLDER = pathlib.Path(folder)
        (FOLDER / "cube.off").write_text("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n")
        try:
            run("vpm-pack", "cube.off", "--spheres", 4, "--view", "cube.html")
        except AssertionError:
            done = run("vpm-pack", "cube.off", "--spheres", 4, "--view", "cube.html", code=3)
            print("skipped: this build has no drawing library:", done.stderr)
            return 77
        if not headless_page.program():
            print("skipped: there is no Chromium (Debian: chromium-headless-shell)")
            return 77
        make_demo()
        with headless_page.Browser() as browser:
            BROWSER = browser
            return 0 if unittest.main(exit=False).result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
