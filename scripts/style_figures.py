#!/usr/bin/env python3
"""Prints figures about the source: lines, files, comments, longest functions.

Usage: scripts/style_figures.py [FOLDER ...]

FOLDER limits files, comments and functions to these folders. They are figures and no check: whether a comment says what it
means is found by reading it.
"""
import argparse
import collections
import pathlib
import re
import statistics

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = ("examples", "libvpm", "tests", "tools")
ENDINGS = {".h", ".cpp", ".cu", ".cuh"}
QUERY_FOLDERS = ("measure", "scene", "backend", "query")
LONG = 50  # lines of a function
STRING = re.compile(r'"(?:\\.|[^"\\])*"|(?<!\w)\'(?:\\.|[^\'\\])+\'')


def source_files(folders):
    """Returns the paths, relative to ROOT, of all C++ and CUDA files in the folders, or in all that hold sources."""
    paths = [path for folder in folders or SOURCES for path in (ROOT / folder).rglob("*")]
    return sorted(str(path.relative_to(ROOT)) for path in paths if path.suffix in ENDINGS)


def read_lines(name):
    return (ROOT / name).read_text(encoding="utf-8").splitlines()


def split_comment(line):
    """Returns the code of a line and its // comment, or None where it has none."""
    blanked = STRING.sub(lambda match: "x" * len(match.group()), line)
    at = blanked.find("//")
    return (line, None) if at < 0 else (line[:at], line[at + 2:].strip())


def comment_words(lines):
    """Yields the first word of each run of // lines, and of each comment behind code."""
    run_column = None
    for line in lines:
        code, comment = split_comment(line)
        if comment is None or code.startswith("}"):
            run_column = None
            continue
        continues = not code.strip() and run_column == len(code)
        run_column = len(code)
        if not continues and (word := re.search(r"[A-Za-z]+", comment)):
            yield word.group()


def functions(lines):
    """Yields name, first line and length of each function. Relies on clang-format's indentation."""
    code = [split_comment(line)[0].rstrip() for line in lines]
    depths = [0]  # indentations of the scopes whose members may be functions
    at = 0
    while at < len(code):
        indent = len(code[at]) - len(code[at].lstrip())
        if code[at].strip() == "" or code[at].lstrip().startswith(("#", "public:", "private:", "protected:")):
            at += 1
            continue
        while len(depths) > 1 and indent < depths[-1]:
            depths.pop()
        if indent != depths[-1] or code[at].lstrip().startswith("}"):
            at += 1
            continue
        end_of_head = at  # a head ends with the line that opens its body, or with a semicolon
        while end_of_head < len(code) - 1 and not code[end_of_head].endswith(("{", ";", "}")):
            end_of_head += 1
        head = " ".join(line.strip() for line in code[at:end_of_head + 1])
        if not head.endswith("{") or head.startswith(("namespace", "extern")):
            at = end_of_head + 1
            continue
        if re.match(r"(template ?<.*> )?(class|struct|union)\b(?!.*\) (const )?\{)", head):
            depths.append(indent + 2)
            at = end_of_head + 1
            continue
        close = end_of_head + 1
        while close < len(code) and not re.match(" {%d}}" % indent, code[close]):
            close += 1
        bare = re.sub(r"\[\[.*?\]\]|__\w+__\(.*?\)|<[^<>()]*>", "", head)
        name = re.search(r"([\w:~]+|operator[^(]*)\(", bare)
        if name and close < len(code) and not head.startswith("enum"):
            yield name.group(1), at + 1, close - at + 1
        at = close + 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="*", default=["libvpm", "tools", "tests", "examples"], metavar="FOLDER")
    arguments = parser.parse_args()
    files = {name: read_lines(name) for name in source_files(arguments.folders)}

    print("lines of the query path:")
    for folder in QUERY_FOLDERS:
        lengths = [len(read_lines(name)) for name in source_files([f"libvpm/{folder}"])]
        print(f"  libvpm/{folder:<10} {sum(lengths):6} in {len(lengths)} files")
    headers = source_files(["libvpm/include"])
    print(f"installed headers: {len(headers)} with {sum(len(read_lines(name)) for name in headers)} lines")

    groups = collections.defaultdict(list)
    for name, lines in files.items():
        groups[name.split("/")[0]].append(len(lines))
    for group, lengths in sorted(groups.items()):
        print(f"{group}: {len(lengths)} files, median {statistics.median(lengths):.0f} lines, {sum(lengths)} in all")

    words = collections.Counter(word for lines in files.values() for word in comment_words(lines))
    print(f"comments: {sum(words.values())}; they most often begin with "
          + ", ".join(f"{word} {count}" for word, count in words.most_common(12)))

    found = sorted(((length, function, f"{name}:{line}") for name, lines in files.items()
                    if not name.startswith("tests/") for function, line, length in functions(lines)), reverse=True)
    print(f"functions: {len(found)}, {sum(length > LONG for length, *_ in found)} longer than {LONG} lines; the longest:")
    for length, function, place in found[:10]:
        print(f"  {length:4} {function}  {place}")


if __name__ == "__main__":
    main()
