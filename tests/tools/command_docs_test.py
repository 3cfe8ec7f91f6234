#!/usr/bin/env python3
"""Checks man pages and completions against the programs.

    command_docs_test.py BIN SHARE PROGRAM

BIN has the program, SHARE what scripts/command_docs.py made of it. A bash, which runs the completion, must offer each option of
--help-all, the words that an option takes, also after "=", and nothing where it takes a number; files must be left to bash. The man page
must name each option and be good roff, where `man` is there; zsh and fish read theirs, where they are there. Exit status: 0 if all
holds, 1 otherwise.
"""
import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys

# Prints what the completion offers after the words given: an answer a line, then how files are treated.
ASK = """
source "$1"; program=$2; shift 2
compopt() { echo "compopt $*"; }
COMP_WORDS=("$program" "$@"); COMP_CWORD=$#; COMPREPLY=()
"_${program//-/_}"
printf '%s\\n' "${COMPREPLY[@]}"
"""


def help_of(program):
    """Maps each option of --help-all to what it takes; empty for a flag."""
    text = subprocess.run([program, "--help-all"], capture_output=True, text=True, check=True).stdout
    heads = re.findall(r"^  (?:-\w, )?(--[a-z-]+)(?: (\S.*?))?(?:   *\S.*)?$", text, flags=re.MULTILINE)
    return {name: value for name, value in heads if not name.startswith("--help")}


def completion_faults(script, program):
    def offered(*words):
        done = subprocess.run(["bash", "-c", ASK, "bash", script, program.name, *words], capture_output=True, text=True, check=True)
        return done.stdout.split("\n")[:-1]

    options = help_of(program)
    if missing := set(options) - set(offered("-")):
        yield f"bash does not offer {', '.join(sorted(missing))}"
    if offered("--vers") != ["--version"]:
        yield f"bash offers {offered('--vers')} for --vers"
    if offered("--thr", "x") != [""]:  # no option is begun: files
        yield "bash offers options in place of a file"
    for option, value in options.items():
        choices = [choice for choice in value.strip("[]").split("|") if re.fullmatch("[a-z0-9-]+", choice)] if "|" in value else []
        if choices and (offered(option, "") != choices or offered(option, "=", "") != choices or offered(option, "=") != choices):
            yield f"bash offers {offered(option, '')} for {option}, which takes {value}"
        if choices and offered(option, choices[0][0]) != [choice for choice in choices if choice.startswith(choices[0][0])]:
            yield f"bash offers {offered(option, choices[0][0])} for {option} {choices[0][0]}"
        if value in ("N", "X") and offered(option, "") != ["compopt +o default", ""]:
            yield f"bash offers {offered(option, '')} for {option}, which takes a number"
        if value.startswith("FILE") and offered(option, "") != [""]:
            yield f"bash offers {offered(option, '')} for {option}, which takes a file"


def man_faults(page, program):
    roff = gzip.decompress(page.read_bytes()).decode().replace("\\-", "-")
    for option in help_of(program):
        if not re.search(rf"\\fB(-\w, )?{option}(?![a-z-])", roff):
            yield f"the man page does not name {option}"
    for section in ("NAME", "SYNOPSIS", "OPTIONS", "EXAMPLES", "EXIT STATUS"):
        if not re.search(rf'^\.SH "?{section}"?$', roff, flags=re.MULTILINE):
            yield f"the man page has no section {section}"
    if shutil.which("man"):
        done = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", page], capture_output=True, text=True,
                              env=dict(os.environ, LC_ALL="C.UTF-8", MANWIDTH="100", MANPAGER="cat"))
        if done.returncode != 0 or done.stderr:
            yield f"man says of its page: {done.stderr}"
        if re.search(r"\]\(|`|\*\*", done.stdout.replace("``", "").replace("''", "")):
            yield "the man page shows Markdown: " + re.search(r".*(\]\(|`|\*\*).*", done.stdout)[0]


def syntax_faults(share, program):
    for shell, path in (("bash", f"bash-completion/completions/{program}"), ("zsh", f"zsh/site-functions/_{program}"),
                        ("fish", f"fish/vendor_completions.d/{program}.fish")):
        if not shutil.which(shell):
            continue
        done = subprocess.run([shell, "-n", share / path], capture_output=True, text=True)
        if done.returncode != 0 or done.stderr:
            yield f"{shell} does not read its completion: {done.stderr}"


def main():
    folder, share, name = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3]
    found = [*completion_faults(share / "bash-completion/completions" / name, folder / name),
             *man_faults(share / f"man/man1/{name}.1.gz", folder / name), *syntax_faults(share, name)]
    print("\n".join(f"{name}: {fault}" for fault in found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
