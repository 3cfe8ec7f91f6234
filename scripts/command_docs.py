#!/usr/bin/env python3
"""Makes the man page of a program and its completions for bash, zsh and fish.

    command_docs.py PROGRAM PAGE FOLDER

The man page is made of the Markdown PAGE, the completions of what `PROGRAM --help-all` prints. They are written below FOLDER where
the share/ of an installation has them. The build runs this for each program.
"""
import gzip
import pathlib
import re
import subprocess
import sys

# Parts of a line of --help-all that introduces an option: "  -o, --output FILE   Packing to write".
OPTION = re.compile(r"  (?:-(?P<short>\w), )?--(?P<name>[a-z-]+)(?: (?P<value>\S.*?))?(?:  +(?P<words>\S.*))?")


def options_of(text):
    """Returns the options of --help-all in its order, each a dictionary of short, name, value and words; None for what is absent."""
    options = []
    for line in text.splitlines():
        match = OPTION.fullmatch(line)
        if match:
            options.append(match.groupdict())
        elif options and line.startswith(" " * 28):
            options[-1]["words"] = " ".join(filter(None, [options[-1]["words"], line.strip()]))
    return options


def choices_of(option):
    """Returns the words that the option takes; none where it takes others, too, such as numbers and files."""
    value = (option["value"] or "").strip("[]")
    return [word for word in value.split("|") if re.fullmatch("[a-z0-9-]+", word)] if "|" in value else []


def takes_files(option):
    return bool(re.search(r"FILE|FOLDER|MODEL|CLOUD|MESH", option["value"] or ""))


def names_of(option):
    return ([f"-{option['short']}"] if option["short"] else []) + [f"--{option['name']}"]


def bash_completion(program, options):
    cases = []
    for option in filter(lambda option: option["value"], options):
        names, choices = "|".join(names_of(option)), choices_of(option)
        if choices:
            cases.append(f"    {names}) mapfile -t COMPREPLY < <(compgen -W '{' '.join(choices)}' -- \"$word\"); return ;;")
        else:
            cases.append(f"    {names}) {'' if takes_files(option) else 'compopt +o default; '}return ;;")
    function = "_" + program.replace("-", "_")
    every = " ".join(name for option in options for name in names_of(option))
    return "\n".join([
        f"# bash completion of {program}", f"{function}() {{",
        "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}",
        "  if [[ $word == = ]]; then word=; elif [[ $before == = ]]; then before=${COMP_WORDS[COMP_CWORD-2]}; fi",
        "  COMPREPLY=()", "  case $before in", *cases, "  esac",
        f"  if [[ $word == -* ]]; then mapfile -t COMPREPLY < <(compgen -W '{every}' -- \"$word\"); fi", "}",
        f"complete -o default -F {function} {program}", ""])


def zsh_completion(program, options):
    lines = [f"#compdef {program}", "_arguments \\"]
    for option in options:
        words = re.sub(r"([\[\]\\:])", r"\\\1", option["words"] or "").replace("'", "'\\''")
        choices = choices_of(option)
        value = ""
        if option["value"]:
            value = ":value:" + (f"({' '.join(choices)})" if choices else "_files" if takes_files(option) else " ")
        names = names_of(option)
        head = f"'({' '.join(names)})'{{{','.join(names)}}}" if len(names) > 1 else f"'*'{names[0]}"
        lines.append(f"  {head}'[{words}]{value}' \\")
    return "\n".join([*lines, "  '*:input:_files'", ""])


def fish_completion(program, options):
    lines = [f"# fish completion of {program}"]
    for option in options:
        words = (option["words"] or "").replace("\\", "\\\\").replace("'", "\\'")
        choices = choices_of(option)
        value = f" -x -a '{' '.join(choices)}'" if choices else " -r -F" if takes_files(option) else " -x" if option["value"] else ""
        short = f" -s {option['short']}" if option["short"] else ""
        lines.append(f"complete -c {program}{short} -l {option['name']}{value} -d '{words}'")
    return "\n".join(lines + [""])


def escaped(text):
    """Returns text in which roff finds no request and no escape."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text)


def in_roff(text):
    """Returns a paragraph of Markdown: code and stressed words in fonts, links by their words."""
    text = re.sub(r"!?\[([^\]]*)\]\((?:[^()]|\([^)]*\))*\)", r"\1", text)
    parts = re.split(r"(`[^`]+`|\*\*[^*]+\*\*|\*[^*\s][^*]*\*)", text)
    fonts = {"`": "B", "*": "I"}
    return "".join(f"\\f{fonts[part[0]]}{escaped(part.strip('`*'))}\\fP" if k % 2 else escaped(part)
                   for k, part in enumerate(parts))


def table_in_roff(rows):
    """Returns a table as a list of its rows, since a terminal has no room for wide ones: each row by its first cell."""
    head, _, *body = [[cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip().strip("|"))] for row in rows]
    lines = []
    for first, *others in body:
        told = [cell if len(head) == 2 else f"{name}: {cell}" for name, cell in zip(head[1:], others)]
        lines += [".TP", in_roff(first), in_roff("; ".join(told))]
    return lines


def blocks_of(page):
    """Yields the blocks of a page: its lines, with those of a fence or of a table together."""
    lines, fence = [], False
    for line in page.splitlines():
        if line.startswith("```"):
            if not fence and lines:
                yield lines
                lines = []
            lines.append(line)
            fence = not fence
            if not fence:
                yield lines
                lines = []
        elif fence:
            lines.append(line)
        elif not line.strip() or re.match(r"#|- ", line) or (lines and lines[0].startswith("#")):
            if lines:
                yield lines
            lines = [line] if line.strip() else []
        else:
            lines.append(line)
    if lines:
        yield lines


def block_in_roff(lines):
    """Returns the lines of roff for a block: heading, code, table, item of a list, picture or paragraph."""
    first, text = lines[0], " ".join(line.strip() for line in lines)
    if first.startswith("#"):
        level, words = first.split(" ", 1)
        return [f".{'SH' if level == '##' else 'SS'} \"{escaped(words.upper() if level == '##' else words)}\""]
    if first.startswith("```") or first.startswith("    "):
        code = lines[1:-1] if first.startswith("```") else [line[4:] for line in lines]
        return [".PP", ".RS 4", ".nf", *map(escaped, code), ".fi", ".RE"]
    if first.startswith("|"):
        return table_in_roff(lines)
    if first.startswith("- "):
        option = re.match(r"- ((?:`-[^`]*`(?:, )?)+): (.*)", text)
        if option:
            return [".TP", in_roff(option[1]), in_roff(option[2])]
        return [".IP \\(bu 2", in_roff(text[2:])]
    return [] if first.startswith("![") else [".PP", in_roff(text)]


def man_page(program, version, page):
    title, rest = page.split("\n", 1)
    summary, rest = rest.strip().split("\n\n", 1)
    brief = in_roff(" ".join(summary.split()).rstrip("."))
    lines = [f'.TH {program.upper()} 1 "" "{program} {version}" vpm', ".ad l", ".nh", ".SH NAME",
             f"{escaped(program)} \\- {brief[0].lower() + brief[1:]}"]
    for block in blocks_of(rest):
        lines += block_in_roff(block)
    return "\n".join(lines) + "\n"


def main():
    program, page, folder = map(pathlib.Path, sys.argv[1:])

    def said(option):
        return subprocess.run([program.resolve(), option], capture_output=True, text=True, check=True).stdout

    options, name, version = options_of(said("--help-all")), program.name, said("--version").split()[-1]
    man = gzip.compress(man_page(name, version, page.read_text(encoding="utf-8")).encode(), 9, mtime=0)
    for path, content in {
            f"man/man1/{name}.1.gz": man,
            f"bash-completion/completions/{name}": bash_completion(name, options).encode(),
            f"zsh/site-functions/_{name}": zsh_completion(name, options).encode(),
            f"fish/vendor_completions.d/{name}.fish": fish_completion(name, options).encode()}.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_bytes(content)


if __name__ == "__main__":
    main()
