#!/usr/bin/env python3
"""Checks the section "Which options go together" of vpm-query's page against the tool.

    options_table_test.py TOOL PAGE

Runs the tool with each option of the page in each column of the table. Inputs do not exist, so that the exit status is 1 if the
options go together, and 2 if they do not; the message must then name the option. Exit status: 0 if table and tool agree, 1 otherwise.
"""
import concurrent.futures
import itertools
import pathlib
import re
import subprocess
import sys
import tempfile

IN_CLOUD = {"--tool": "t.vpmg", "--cloud": "c.vpmc", "--poses": "p.txt"}
# Command line of each column of the table.
COLUMNS = {
    "poses in a cloud": IN_CLOUD,
    "`--batch`": IN_CLOUD | {"--batch": "2"},
    "`--coupling` in a cloud": IN_CLOUD | {"--coupling": "stiffness=500,damping=5", "--stiffness": "2"},
    "`--frames`": {"--tool": "t.vpmg", "--frames": "f", "--poses": "p.txt"},
    "several `--tool` in a cloud": IN_CLOUD | {"--tool": ["t.vpmg", "u.vpmg"]},
    "several `--tool` with `--frames`": {"--tool": ["t.vpmg", "u.vpmg"], "--frames": "f", "--poses": "p.txt"},
    "`--serve`": {"--tool": "t.vpmg", "--serve": None},
    "`--pairs`": {"--pairs": "assembly.json"},
    "`--urdf`": {"--urdf": "r.urdf", "--joints": "j.jsonl"},
}
POSE = "0,0,1,0,0,0,1"
# Values that each option accepts and that are not its default; all others take the name of a missing file.
VALUES = {
    "--pose": POSE, "--camera-pose": POSE, "--measure": "paper", "--shadows": "solid", "--stiffness": "2", "--level": "5",
    "--max-error": "1%", "--deadline-us": "5", "--coupling": "stiffness=500,damping=5", "--batch": "2", "--rate": "5",
    "--frame-rate": "5", "--frame-latency": "5", "--intrinsics": "1,1,1,1", "--depth-scale": "5", "--method": "pca", "--window": "9",
    "--unit": "mm", "--invalid": "5", "--range": "1,2", "--decode": "rotated", "--channel": "Z", "--axes": "opengl",
    "--edge-gate": "0.5", "--fail-above": "5", "--contacts": "5", "--repair": "holes", "--unseen": "0.1", "--remove-margin": "0.1", "--spheres-out": "s.ply", "--view": "v.html",
}


def names_in(text):
    return re.findall(r"`(--[a-z-]+)", text)


def options_of(page):
    """Maps each option of the page that is not common to all tools to its value, or None for a flag."""
    own = page.split("\n## Options\n")[1].split("\nCommon to all tools:")[0]
    heads = "\n".join(re.findall(r"^- (`-.*?`):", own, flags=re.MULTILINE))
    return {option: VALUES.get(option, "missing" if placeholder else None)
            for option, placeholder in re.findall(r"`(--[a-z-]+)( [A-Z]+)?", heads)}


def table_of(section):
    """Maps (option, column) to the text of the cell."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")]
    head, body = rows[0][1:], rows[2:]
    if head != list(COLUMNS):
        raise SystemExit(f"the table's columns are {head}; this test knows {list(COLUMNS)}")
    return {(option, column): cell for row in body for option in names_in(row[0]) for column, cell in zip(head, row[1:])}


def command_line(options):
    words = []
    for option, value in options.items():
        for one in value if isinstance(value, list) else [value]:
            words += [option] if one is None else [option, one]
    return words


def without(options, *left_out):
    return {option: value for option, value in options.items() if option not in left_out}


def checks_of(page):
    """Yields pairs: options of a command line, and the options that a refusal must name; none where it must not refuse."""
    values = options_of(page)
    section = re.search(r"^## Which options go together\n(.*?)^## ", page, flags=re.MULTILINE | re.DOTALL).group(1)
    table = table_of(section)
    needs = dict(re.findall(r"`(--[a-z-]+)` needs `(--[a-z-]+)`", section))
    for (column, base), option in itertools.product(COLUMNS.items(), values):
        cell = table.get((option, column), "yes")
        alternatives = names_in(cell)
        needed = {needs[option]: values[needs[option]]} if option in needs else {}
        with_option = without(base, *alternatives) | needed | ({} if option in base else {option: values[option]})
        yield with_option, [option] if cell == "no" else []
        if needed:
            yield without(with_option, needs[option]), [option] if cell == "no" else [option, needs[option]]
        if cell == "required":
            yield without(base, option), [option]
        if alternatives:
            yield without(base, option, *alternatives), [option, *alternatives]
    for line in re.findall(r"^- (.*)$", section, flags=re.MULTILINE):
        for pair in itertools.combinations(names_in(line), 2):
            column = next(c for c in COLUMNS if all(table.get((option, c)) != "no" for option in pair))
            yield COLUMNS[column] | {option: values[option] for option in pair}, pair


def fault_of(tool, folder, options, named):
    done = subprocess.run([tool, *command_line(options)], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    command = " ".join(["vpm-query", *command_line(options)])
    if not named:
        return None if done.returncode == 1 else f"the page allows this, exit status {done.returncode}: {command}\n{done.stderr}"
    if done.returncode != 2:
        return f"the page forbids this, exit status {done.returncode}: {command}"
    missed = [option for option in named if not re.search(rf"(?<!\S){option}(?![a-z-])", done.stderr)]
    return f"the message does not name {', '.join(missed)}: {command}\n{done.stderr}" if missed else None


def main():
    tool, page = map(pathlib.Path, sys.argv[1:])
    checks = list(checks_of(page.read_text()))
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor() as pool:
        faults = [fault for fault in pool.map(lambda check: fault_of(tool.resolve(), folder, *check), checks) if fault]
    print("\n".join(faults), f"{len(checks)} command lines, {len(faults)} faults", sep="\n" if faults else "")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
