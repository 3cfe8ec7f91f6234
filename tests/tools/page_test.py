#!/usr/bin/env python3
"""Checks a page against the tools.

    page_test.py --bin DIR[:DIR...] --example FOLDER PAGE [TOOL]

The page's blocks marked ```sh are run by bash in a new folder that holds the files of FOLDER, made by make-example, and must succeed. A result that
the page shows ('{"pose": ...}', "…" stands for any text) must be a line of the file results.jsonl that they leave. For the page of a
TOOL, every long option of `TOOL --help-all` must stand in its section "Options" and the reverse, and it must have the sections of a
man page in their order. `--help` must be a part of `--help-all`, of lines of at most 100 characters, with three examples that the tool
takes, and both have the page's exit codes. Exit status: 0 if all holds, 1 otherwise.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SECTIONS = ["Synopsis", "Description", "Options", "Which options go together", "Examples", "Exit status", "See also"]
LONGEST_SECONDS = 600
LONGEST_LINE = 100


def sections_of(page):
    """Maps each heading of the second level to its text, in the page's order."""
    parts = re.split(r"^## (.+)$", page, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def said(command, environment):
    return subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=True).stdout


def options_of_help(text):
    return set(re.findall(r"^  (?:-\w, )?(--[a-z][a-z-]*)", text, flags=re.MULTILINE))


def options_of_page(section):
    """Returns the options that list items introduce: "- `-o`, `--output FILE`: ..."."""
    heads = re.findall(r"^- (`-.*?`):", section, flags=re.MULTILINE)
    return {option for head in heads for option in re.findall(r"`(--[a-z][a-z-]*)", head)}


def example_faults(page, example, environment):
    """Yields what goes wrong when the page's examples are run."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(example, folder, dirs_exist_ok=True)
        for block in re.findall(r"^```sh\n(.*?)^```", page, flags=re.MULTILINE | re.DOTALL):
            done = subprocess.run(["bash", "-eo", "pipefail", "-c", block], cwd=folder, env=environment,
                                  stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=LONGEST_SECONDS)
            if done.returncode != 0:
                yield f"an example fails with exit status {done.returncode}:\n{block}{done.stderr}"
        for shown in re.findall(r'^\{"pose":.*$', page, flags=re.MULTILINE):
            pattern = ".*".join(map(re.escape, shown.split("…")))
            results = (pathlib.Path(folder) / "results.jsonl").read_text().splitlines()
            if not any(re.fullmatch(pattern, line) for line in results):
                yield f"no result of the examples is like {shown}"


def option_faults(tool, page, environment):
    """Yields how the page of a tool differs from its --help."""
    if not page.startswith(f"# {tool}\n"):
        yield f"the page does not begin with '# {tool}'"
    sections = sections_of(page)
    if [name for name in sections if name in SECTIONS] != SECTIONS:
        yield f"the page's sections are {', '.join(sections)}; needed are {', '.join(SECTIONS)} in this order"
        return
    of_help, of_page = options_of_help(said([tool, "--help-all"], environment)), options_of_page(sections["Options"])
    for option in sorted(of_help - of_page):
        yield f"{option} stands in --help-all but not in the page's options"
    for option in sorted(of_page - of_help):
        yield f"{option} stands in the page's options but not in --help-all"


def help_faults(tool, page, environment):
    """Yields what is wrong with --help and --help-all."""
    short, full = (said([tool, option], environment) for option in ("--help", "--help-all"))
    for line in (short + full).splitlines():
        if len(line) > LONGEST_LINE:
            yield f"a line of help has {len(line)} characters: {line}"
    if not options_of_help(short) < options_of_help(full) or len(short) >= len(full):
        yield "--help is not a part of --help-all"
    examples = re.findall(rf"^  ({tool} .*)$", short.split("\nExamples:\n")[1], flags=re.MULTILINE)
    if len(examples) != 3:
        yield f"--help has {len(examples)} examples"
    for example in examples:
        done = subprocess.run(["bash", "-c", example.replace(tool, f"{tool} --dump-config", 1)], env=environment,
                              capture_output=True, text=True)
        if done.returncode != 0:
            yield f"{tool} does not take an example of its help: {example}\n{done.stderr}"
    of_page = re.findall(r"^\| (\d+) \|", sections_of(page)["Exit status"], flags=re.MULTILINE)
    for text in (short, full):
        codes = re.findall(r"^  (\d+) ", text.split("\nExit codes:\n")[1], flags=re.MULTILINE)
        if codes != of_page:
            yield f"exit codes of help are {', '.join(codes)}, of the page {', '.join(of_page)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folders of the tools")
    parser.add_argument("--example", required=True, type=pathlib.Path, help="the files of make-example")
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("tool", nargs="?")
    options = parser.parse_args()
    environment = dict(os.environ, LC_ALL="C", PATH=options.bin + ":" + os.environ["PATH"])
    page = options.page.read_text()
    found = list(example_faults(page, options.example, environment))
    if options.tool:
        found += option_faults(options.tool, page, environment)
        found += help_faults(options.tool, page, environment)
    print("\n".join(f"{options.page}: {fault}" for fault in found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
