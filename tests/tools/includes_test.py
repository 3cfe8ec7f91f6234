#!/usr/bin/env python3
"""Checks that the programs include no more of libvpm's inside than the table of tools/README.md says, and no less.

    includes_test.py TOOLS
"""
import pathlib
import re
import sys

tools = pathlib.Path(sys.argv[1])
table = [line.split("|")[2] for line in (tools / "README.md").read_text().splitlines() if line.startswith("| ")][1:]
named = {name for cell in table for name in re.findall(r"`([a-z_/.]+)`", cell)}
included = {name for folder in ("common", "graph", "normals", "pack", "query") for path in (tools / folder).iterdir()
            if path.suffix in (".h", ".cpp") for name in re.findall(r'#include "libvpm/([^"]+)"', path.read_text())}


def covers(name, header):
    return header.startswith(name) if name.endswith("/") else header == name


faults = [f"{header} is included, but not in the table" for header in sorted(included)
          if not any(covers(name, header) for name in named)]
faults += [f"{name} is in the table, but not included" for name in sorted(named)
           if not any(covers(name, header) for header in included)]
print("\n".join(faults))
sys.exit(1 if faults or not named else 0)
