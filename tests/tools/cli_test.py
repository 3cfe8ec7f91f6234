#!/usr/bin/env python3
"""Runs transcripts of command lines and compares the output.

    cli_test.py --bin DIR[:DIR...] [--renew] CASE.t...

A transcript is text. A line "$ COMMAND" is run by bash (with pipefail) in a new folder that all
commands of the transcript share. The lines after it are the expected output:

    $ vpm-pack open.off -o open.vpmp
    2> vpm-pack: error: open.off: ... (glob)
    [1]

Plain lines are standard output, "2> " marks standard error, "[N]" an exit status other than 0. A
line that ends in " (glob)" is a pattern of fnmatch. Lines that start with "#" are comments. The
commands find the tools on PATH, the repository in $SOURCE, and schemas are checked by
`$VALIDATE SCHEMA FILE` (tests/formats/ask_to_validate.py).

--renew writes the present output into the transcripts; patterns that still match stay.
Exit status: 0 if all agree, 1 otherwise.
"""
import argparse
import contextlib
import difflib
import fnmatch
import os
import pathlib
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SECONDS_PER_COMMAND = 120


def parse(text):
    """Returns the transcript as a list of (lines before the command, command, expected lines)."""
    steps, before = [], []
    for line in text.splitlines():
        if line.startswith("$ "):
            steps.append((before, line[2:], []))
            before = []
        elif line.startswith("#") or not line:
            before.append(line)
        elif steps and not before:
            steps[-1][2].append(line)
        else:
            raise SystemExit(f"expected output without a command: {line}")
    return steps, before


def run(command, folder, environment):
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], cwd=folder, env=environment,
        stdin=subprocess.DEVNULL, capture_output=True, timeout=SECONDS_PER_COMMAND)
    lines = done.stdout.decode(errors="replace").splitlines()
    lines += ["2> " + line for line in done.stderr.decode(errors="replace").splitlines()]
    if done.returncode != 0:
        lines.append(f"[{done.returncode}]")
    return lines


def matches(expected, actual):
    if expected.endswith(" (glob)"):
        return fnmatch.fnmatchcase(actual, expected[:-len(" (glob)")])
    return expected == actual


def agree(expected, actual):
    return len(expected) == len(actual) and all(map(matches, expected, actual))


def renewed(expected, actual):
    """Returns the actual lines, with the expected patterns in the places where they match."""
    patterns = [line for line in expected if line.endswith(" (glob)")]
    lines = []
    for line in actual:
        found = next((p for p in patterns if matches(p, line)), None)
        lines.append(found or line)
    return lines


@contextlib.contextmanager
def validation_server(environment):
    """Runs the server that `$VALIDATE` asks, and names its socket in the environment."""
    with tempfile.TemporaryDirectory() as folder:
        environment["VALIDATION_SOCKET"] = f"{folder}/socket"
        with subprocess.Popen([SOURCE / "tests/formats/validate_json.py", "--serve", f"{folder}/socket"],
                              stdout=subprocess.PIPE) as server:
            if not server.stdout.readline():
                sys.exit(server.wait())  # it has said why
            try:
                yield
            finally:
                server.kill()


def check(case, environment, renew):
    whole = case.read_text()
    steps, rest = parse(whole)
    good, text = True, []
    with tempfile.TemporaryDirectory() as folder, \
         validation_server(environment) if "$VALIDATE" in whole else contextlib.nullcontext():
        for before, command, expected in steps:
            actual = run(command, folder, environment)
            text += before + ["$ " + command] + renewed(expected, actual)
            if agree(expected, actual):
                continue
            good = False
            print(f"{case}: $ {command}")
            print("\n".join(difflib.unified_diff(expected, actual, "expected", "actual",
                                                 lineterm="")))
    if renew:
        case.write_text("\n".join(text + rest) + "\n")
    return good or renew


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("--renew", action="store_true")
    parser.add_argument("cases", nargs="+", type=pathlib.Path)
    options = parser.parse_args()
    environment = dict(os.environ, LC_ALL="C", SOURCE=str(SOURCE),
                       VALIDATE=str(SOURCE / "tests/formats/ask_to_validate.py"),
                       PATH=options.bin + ":" + os.environ["PATH"])
    results = [check(case, environment, options.renew) for case in options.cases]
    sys.exit(0 if all(results) else 1)


if __name__ == "__main__":
    main()
