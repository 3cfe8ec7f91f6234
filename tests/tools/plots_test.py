#!/usr/bin/python3
"""Draws the published results with the plot scripts, and gives them folders that they cannot draw: each answers in a
sentence and an exit code, never by a traceback.

usage: plots_test.py     exit code 77: skipped, no matplotlib
"""
import contextlib
import io
import json
import pathlib
import runpy
import shutil
import sys
import tempfile
import unittest

try:
    import matplotlib  # noqa: F401
except ImportError:
    print("skipped: there is no matplotlib (Debian: python3-matplotlib)")
    sys.exit(77)

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))  # as for a script that is run by its path
SCRIPTS = sorted((ROOT / "scripts").glob("plot_*.py"))
SCRIPTS = [path for path in SCRIPTS if path.name != "plot_folder.py"]
# What is drawn of each file of tests/results; accuracy.png is left out: it needs accuracy.csv with every pose, which is not kept.
PUBLISHED = {"packing": ["packing"], "replay": ["replay_frames", "replay_profile"], "scaling": ["scaling"], "timing": ["timing"],
             "tradeoff": ["tradeoff"]}


def run(script, *arguments):
    """Returns the exit code and what was printed on standard error."""
    sys.argv, printed = [str(script), *map(str, arguments)], io.StringIO()
    try:
        with contextlib.redirect_stderr(printed), contextlib.redirect_stdout(io.StringIO()):
            runpy.run_path(str(script), run_name="__main__")
    except SystemExit as end:
        if isinstance(end.code, str):
            return 1, end.code
        return end.code or 0, printed.getvalue()
    return 0, printed.getvalue()


class Plots(unittest.TestCase):
    def test_draw_what_is_published(self):
        for suite, pictures in PUBLISHED.items():
            with self.subTest(suite), tempfile.TemporaryDirectory() as folder:
                shutil.copy(ROOT / f"tests/results/{suite}.json", folder)
                self.assertEqual(run(ROOT / f"scripts/plot_{suite}.py", folder), (0, ""))
                drawn = sorted(pathlib.Path(folder).glob("*.png"))
                self.assertEqual([picture.stem for picture in drawn], pictures)
                for picture in drawn:
                    self.assertTrue(picture.read_bytes().startswith(b"\x89PNG"), picture.name)

    def test_want_one_folder(self):
        for script in SCRIPTS:
            for arguments in ((), ("--help",), ("a", "b")):
                code, text = run(script, *arguments)
                self.assertEqual(code, 2, script.name)
                self.assertIn(f"usage: {script.name} FOLDER", text)

    def test_name_the_file_that_is_missing_and_who_makes_it(self):
        with tempfile.TemporaryDirectory() as folder:
            for script in SCRIPTS:
                code, text = run(script, folder)
                self.assertEqual(code, 1, script.name)
                self.assertRegex(text, rf"^{script.name}: .* has no \S+.*; make them by (vpm-bench|scripts/demo.sh|two-links)")

    def test_refuse_results_that_they_cannot_draw(self):
        texts = ("", "{}", "[]", "null", json.dumps({"results": [{"part": "spheres"}], "settings": {}}))
        for script in SCRIPTS:
            for text in texts:
                with tempfile.TemporaryDirectory() as folder:
                    for name in ("results.jsonl", "truth.csv", "pack.json", "stats.json", "spheres.csv", "depth.png",
                                 "accuracy.csv", "links.csv", f"{script.stem.removeprefix('plot_')}.json"):
                        (pathlib.Path(folder) / name).write_text(text)
                    code, said = run(script, folder)
                    self.assertEqual(code, 1, f"{script.name}: {text!r}")
                    self.assertIn("make them again by", said)


if __name__ == "__main__":
    unittest.main()
