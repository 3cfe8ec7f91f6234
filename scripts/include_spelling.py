#!/usr/bin/env python3
"""Checks that each header of ours is included by one spelling: public ones as <vpm/x.h>, others as "path/from/the/root.h".

Usage: scripts/include_spelling.py [--mend]     exit code 1 if an include is spelt otherwise; --mend rewrites it instead
"""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PUBLIC = "libvpm/include/"
SOURCES = ("examples", "libvpm", "tests", "tools")
ENDINGS = {".h", ".cpp", ".cu", ".cuh"}
INCLUDE = re.compile(r'^(\s*#\s*include\s+)(["<])([^">]+)[">]', re.MULTILINE)


def spelling(name, quote, folder):
    """Returns how a header that is ours is to be included from a file of the folder, or None for one of others."""
    places = [PUBLIC + name, name]
    if quote == '"':
        places.append(f"{folder}/{name}")
    for place in places:
        if (ROOT / place).is_file():
            return f"<{place[len(PUBLIC):]}>" if place.startswith(PUBLIC) else f'"{place}"'
    return None


def main():
    mend = "--mend" in sys.argv[1:]
    faults = []
    for path in sorted(path for folder in SOURCES for path in (ROOT / folder).rglob("*") if path.suffix in ENDINGS):
        folder = str(path.parent.relative_to(ROOT))
        text = path.read_text(encoding="utf-8")

        def mended(match):
            before, quote, name = match.groups()
            now = match.group()[len(before):]
            right = spelling(name, quote, folder) or now
            if right != now:
                faults.append(f"{path.relative_to(ROOT)}: {now} is {right}")
            return before + right

        new = INCLUDE.sub(mended, text)
        if mend and new != text:
            path.write_text(new, encoding="utf-8")
    print(*faults, sep="\n")
    print(f"{len(faults)} includes {'mended' if mend else 'spelt otherwise'}")
    sys.exit(0 if mend or not faults else 1)


if __name__ == "__main__":
    main()
