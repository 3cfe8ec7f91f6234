#!/usr/bin/env python3
"""Tests that the page of --view is opened in a browser for somebody who sits before a terminal with a display, and only then.

    browser_test.py --bin DIR[:DIR...]

The browser is a program named xdg-open that notes the page it was given. Exit status: 0 if the page was opened where it should be
and nowhere else, 1 otherwise, 77 (skipped) where there are no pseudo-terminals, as in a bare chroot.
"""
import argparse
import os
import pathlib
import pty
import subprocess
import sys
import tempfile
import time

WALL = pathlib.Path(__file__).with_name("inputs") / "wall.png"
SKIPPED = 77
PATIENCE = 10  # s, in which a browser that is started notes its page
BROWSER = '#!/bin/sh\necho "$1" >> "$OPENED"\n'


def has_terminals():
    try:
        for end in os.openpty():
            os.close(end)
    except OSError as fault:
        print(f"skipped: no pseudo-terminal can be made here ({fault})")
        return False
    return True


def look(folder, name, environment, options=(), terminal=True):
    """Runs vpm-normals with --view; its streams are a terminal, or none."""
    command = ["vpm-normals", str(WALL), "--intrinsics", "60,60,31.5,23.5", "--view", name, *options]
    if not terminal:
        subprocess.run(command, cwd=folder, env=environment, check=True, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return
    child, terminal_end = pty.fork()
    if child == 0:
        os.chdir(folder)
        os.execvpe(command[0], command, environment)
    try:
        while os.read(terminal_end, 4096):
            pass
    except OSError:
        pass  # Linux's way to say that the program has closed its terminal
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert status == 0, f"vpm-normals ended with {status}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    programs = parser.parse_args().bin
    if not has_terminals():
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        browser = folder / "bin" / "xdg-open"
        browser.parent.mkdir()
        browser.write_text(BROWSER)
        browser.chmod(0o755)
        opened = folder / "opened"
        without = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        without |= {"PATH": f"{browser.parent}:{programs}:{os.environ['PATH']}", "OPENED": str(opened)}
        display = without | {"DISPLAY": ":9"}

        look(folder, "pipe.html", display, terminal=False)
        look(folder, "none.html", without)
        look(folder, "empty.html", without | {"DISPLAY": ""})
        look(folder, "quiet.html", display, ["--quiet"])
        look(folder, "x11.html", display)
        look(folder, "wayland.html", without | {"WAYLAND_DISPLAY": "wayland-0"})
        pages = ["pipe.html", "none.html", "empty.html", "quiet.html", "x11.html", "wayland.html"]
        assert all((folder / page).stat().st_size > 0 for page in pages), "a page was not written"
        until = time.monotonic() + PATIENCE
        seen = []
        while sorted(seen) != ["wayland.html", "x11.html"] and time.monotonic() < until:
            time.sleep(0.02)
            seen = opened.read_text().split() if opened.exists() else []
    if sorted(seen) != ["wayland.html", "x11.html"]:
        print(f"opened in a browser: {seen}; expected: x11.html and wayland.html")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
