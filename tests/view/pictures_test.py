#!/usr/bin/python3
"""Makes the pictures of the pages again: those that are kept show what the tools show today.

usage: pictures_test.py BIN EXAMPLE     EXAMPLE: what make-example wrote; exit code 77: skipped, no Chromium, no drawing library or no Pillow
"""
import importlib.util
import io
import pathlib
import subprocess
import sys

import matplotlib.image
import numpy

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "scripts"))
import headless_page  # noqa: E402

SQUARE = 10       # pixels: what is compared is the mean colour of squares, since fonts and edges differ between machines
DIFFERENCE = 0.1  # of black and white
NO_PAGES = 3      # exit code of a build that draws no pages
MOST = 0.02       # of all squares may differ as much: a line of text that came, went or moved changes more


def squares(file):
    """Returns the mean colours of the squares that the picture consists of, rows x columns x 3."""
    picture = matplotlib.image.imread(file)[:, :, :3].astype(float)
    rows, columns = (length // SQUARE for length in picture.shape[:2])
    return picture[:rows * SQUARE, :columns * SQUARE].reshape(rows, SQUARE, columns, SQUARE, 3).mean(axis=(1, 3))


def differing(kept, made):
    """Returns the part of all squares that differ, 1 for pictures of different sizes."""
    a, b = squares(kept), squares(made)
    return (numpy.abs(a - b).max(axis=2) > DIFFERENCE).mean() if a.shape == b.shape else 1.0


def main():
    if not headless_page.program() or not importlib.util.find_spec("PIL"):
        print("skipped: needs Chromium and Pillow (Debian: chromium-headless-shell, python3-pil)")
        return 77
    import view_pictures  # which needs Pillow
    kept = REPOSITORY / "examples/pictures"
    try:
        parts = {f"{name}.png": differing(kept / f"{name}.png", io.BytesIO(png))
                 for name, png in view_pictures.pictures(pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], quality=1)}
    except subprocess.CalledProcessError as fault:
        print(fault)
        return 77 if fault.returncode == NO_PAGES else 1
    stale = {name: part for name, part in parts.items() if part > MOST}
    for name, part in stale.items():
        print(f"examples/pictures/{name}: {part:.1%} of it show something else today; make it again: scripts/view_pictures.py")
    return 1 if stale or not parts else 0


if __name__ == "__main__":
    sys.exit(main())
