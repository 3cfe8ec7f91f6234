#!/usr/bin/env python3
"""Passes on what a run of the tests prints, and sums it up at the end: the minutes of each step and the slowest tests.

Usage: COMMAND 2>&1 | scripts/run_summary.py

A step begins with a line "== NAME". Where lines tell of a fault (of a package, a compiler, the linker, ninja, ctest or a
missing resource), they are printed again at the end, so that the cause stands where a reader of a long log looks first.
"""
import re
import sys
import time

CAUSE = re.compile(r"""
    ^FAILED:\ | ^ninja:\ (error|build\ stopped) | \berror:\  | internal\ compiler\ error | undefined\ reference | ld\ returned
    | ^CMake\ Error | ^E:\  | ^dpkg:\ error | \*\*\*(Failed|Timeout|Exception|Not\ Run) | ^Could\ not\ find
    | ^\s*\d+\ -\ .*\((Failed|Timeout|SEGFAULT|ILLEGAL|Not\ Run|Subprocess\ aborted|BAD_COMMAND|INTERRUPT|Child\ aborted).*\)
    | ^\[\s+FAILED\s+\] | :\ Failure$ | No\ space\ left | [Cc]annot\ allocate | Killed | Terminated
    | ^empty_root\.sh:\  | ^(Assertion|Value)Error | ^FAIL:\  | ^ERROR:\ """, re.VERBOSE)
# Tests that count faults of others print such words when they pass.
PASSED = re.compile(r"Passed\s+[0-9.]+ sec|^ok ")
TEST = re.compile(r"Test\s+#\d+: (\S+) .*?\s([0-9.]+) sec")
MOST_LINES, LONGEST_LINE, SLOWEST = 40, 300, 8


def main():
    start = time.monotonic()
    steps, tests, causes = [("Setting out", 0.0)], [], []
    for raw in sys.stdin.buffer:
        sys.stdout.buffer.write(raw)
        sys.stdout.buffer.flush()
        line = raw.decode(errors="replace").rstrip()
        if line.startswith("== ") and not re.search(r": good, \d+ s$", line):
            steps.append((line[3:], time.monotonic() - start))
        if test := TEST.search(line):
            tests.append((float(test.group(2)), test.group(1)))
        if CAUSE.search(line) and not PASSED.search(line):
            causes.append(f"[{steps[-1][0][:40]}] {line}"[:LONGEST_LINE])

    ends = [at for _, at in steps[1:]] + [time.monotonic() - start]
    print("\nMinutes of each step:")
    for (name, begin), end in zip(steps, ends):
        if end - begin >= 1:
            print(f"  {(end - begin) / 60:5.1f}  {name[:100]}")
    print(f"  {ends[-1] / 60:5.1f}  in all")
    if tests:
        tests.sort(reverse=True)
        print(f"Slowest of {len(tests)} tests, seconds: " + ", ".join(f"{name} {took:.0f}" for took, name in tests[:SLOWEST]))
    if causes:
        print(f"\nLines that tell of a fault ({len(causes)}, the last {min(len(causes), MOST_LINES)}):")
        for line in dict.fromkeys(causes[-MOST_LINES:]):
            print("  " + line)


if __name__ == "__main__":
    main()
