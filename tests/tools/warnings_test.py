#!/usr/bin/env python3
"""warnings_test.py CASES: warnings in the transcripts of CASES are short: one sentence with its cure, at most 200 characters
behind the names of program and file. What is more stands in a page."""
import pathlib
import re
import sys

MOST = 200
# Lists places where a mesh crosses itself, with their coordinates.
LISTS = re.compile("the mesh intersects itself")

warnings, faults = 0, []
for case in sorted(pathlib.Path(sys.argv[1]).glob("*.t")):
    for number, line in enumerate(case.read_text().splitlines(), 1):
        found = re.match(r"(?:2> )?vpm-\w+: warning: (.*)$", line)
        if not found:
            continue
        warnings += 1
        text = re.sub(r"^\S+\.\w+: ", "", found.group(1))
        if len(text) > MOST and not LISTS.search(text):
            faults.append(f"{case.name}:{number}: {len(text)} characters: {text}")
        if len(line) > 300:
            faults.append(f"{case.name}:{number}: {len(line)} columns")
if warnings < 50:
    faults.append(f"only {warnings} warnings were found")
print("\n".join(faults))
sys.exit(1 if faults else 0)
