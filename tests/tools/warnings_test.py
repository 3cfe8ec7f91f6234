#!/usr/bin/env python3
"""warnings_test.py CASES: warnings and errors in the transcripts of CASES are short: one sentence with its cure, at most 200
characters behind the names of program and file. What is more stands in a page."""
import pathlib
import re
import sys

MOST = 200
warnings, faults = 0, []
for case in sorted(pathlib.Path(sys.argv[1]).glob("*.t")):
    for number, line in enumerate(case.read_text().splitlines(), 1):
        found = re.match(r"(?:2> )?vpm-\w+: (warning|error): (.*)$", line)
        if not found:
            continue
        warnings += found.group(1) == "warning"
        text = re.sub(r"^(\S+\.\w+|standard input)(, line \d+)?: ", "", found.group(2))
        if len(text) > MOST:
            faults.append(f"{case.name}:{number}: {len(text)} characters: {text}")
if warnings < 50:
    faults.append(f"only {warnings} warnings were found")
print("\n".join(faults))
sys.exit(1 if faults else 0)
