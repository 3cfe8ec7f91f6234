#!/usr/bin/python3
"""Checks that every result in tests/results can be drawn.

usage: plots_test.py SOURCE    (the repository's root)
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

# accuracy.png is left out: it needs accuracy.csv with every pose, which is not kept.
PICTURES = {"packing": ["packing.png"], "replay": ["replay_profile.png", "replay_frames.png"],
            "scaling": ["scaling.png"], "timing": ["timing.png"], "tradeoff": ["tradeoff.png"]}


def main():
    source = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for suite, pictures in PICTURES.items():
            shutil.copy(source / f"tests/results/{suite}.json", folder)
            subprocess.run([sys.executable, source / f"scripts/plot_{suite}.py", folder], check=True)
            for picture in pictures:
                assert (folder / picture).read_bytes().startswith(b"\x89PNG"), picture


if __name__ == "__main__":
    main()
