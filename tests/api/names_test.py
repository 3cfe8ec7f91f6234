#!/usr/bin/env python3
"""names_test.py LIBVPM: every parameter or function that a message of LIBVPM names in backquotes is declared in a public header,
so that a program can do what a message tells. Texts of files that no public function reaches are left out."""
import pathlib
import re
import sys

# The tools alone read recordings, write points for other programs and ask whether outputs may be replaced.
WITHOUT_API = ("recording/", "import/cloud_export.cpp", "file/overwrite.cpp")
LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')

libvpm = pathlib.Path(sys.argv[1])


def code_of(path):
    """Returns the file without comments and includes."""
    lines = (line for line in path.read_text().splitlines() if not line.lstrip().startswith(("//", "#")))
    return "\n".join(re.sub(r'^((?:[^"]|"(?:[^"\\]|\\.)*")*?)//.*', r"\1", line) for line in lines)


declared = set()
for header in (libvpm / "include/vpm").glob("*.h"):
    declared |= set(re.findall(r"\b([a-z]\w*)(?= = | = \{|;|\(|\[)", code_of(header)))

named = {}
for path in sorted([*libvpm.rglob("*.cpp"), *libvpm.rglob("*.h"), *libvpm.rglob("*.cu")]):
    place = path.relative_to(libvpm).as_posix()
    if place.startswith(("include/", *WITHOUT_API)):
        continue
    for text in LITERAL.findall(code_of(path)):
        for name in re.findall(r"`([^`]+)`", text):
            named.setdefault(name, place)

faults = [f"{place}: `{name}` is in no public header" for name, place in named.items() if name not in declared]
if len(named) < 15:
    faults.append(f"only {len(named)} names were found: {sorted(named)}")
print("\n".join(faults))
sys.exit(1 if faults else 0)
