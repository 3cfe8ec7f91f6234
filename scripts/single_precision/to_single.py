"""Writes the sources of the query path again with float for double, in namespace vpm_single, so that one program can hold
both: to_single.py SOURCE_TREE FOLDER"""
import pathlib
import re
import sys

FOLDERS = ("core", "file", "model", "cloud", "device", "surface", "query")
KEPT = {"lanes.h"}  # vectors of both kinds of numbers
NUMBER = re.compile(r"(?<![\w.])((?:\d+\.\d*|\.\d+)(?:e[+-]?\d+)?|\d+e[+-]?\d+|0x[0-9a-fA-F.]+p[+-]?\d+)(?![\w.])")
# Margins above what arithmetic rounds by, for double; in float they would vanish.
MARGIN = re.compile(r"\b1e-(?:9|12)f")
TEXT = re.compile(r'("(?:[^"\\]|\\.)*")')


def code(text):
    text = re.sub(r"\bdouble\b", "float", text)
    text = NUMBER.sub(r"\1f", text)
    text = MARGIN.sub("1e-6f", text)
    return re.sub(r"\bHUGE_VAL\b", "HUGE_VALF", text)


def line(text, keeps_numbers):
    if text.lstrip().startswith("#include"):
        return text.replace("libvpm/", "libvpm_single/")
    parts = TEXT.split(text)
    for k in range(0, len(parts), 2):
        before, slashes, comment = parts[k].partition("//")
        before = re.sub(r"\bvpm\b", "vpm_single", before if keeps_numbers else code(before))
        parts[k] = before + slashes + comment
        if slashes:
            break
    return "".join(parts)


def main():
    source, target = pathlib.Path(sys.argv[1]) / "libvpm", pathlib.Path(sys.argv[2]) / "libvpm_single"
    for folder in FOLDERS:
        for path in sorted((source / folder).glob("*.*")):
            if path.suffix not in (".h", ".cpp"):
                continue
            written = target / folder / path.name
            written.parent.mkdir(parents=True, exist_ok=True)
            lines = path.read_text().split("\n")
            written.write_text("\n".join(line(text, path.name in KEPT) for text in lines))


main()
