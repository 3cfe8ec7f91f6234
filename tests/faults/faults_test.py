#!/usr/bin/env python3
"""Runs the tools on a machine that fails them: faults_test.py --bin FOLDER [NAME...]

Each test takes something away (disk, memory, descriptors, threads, a reader) or gives too much (an
endless input, an input that changes), and expects an exit code, a message of one line on standard
error, the old output unharmed, and no temporary file left. A test that this machine or user cannot
run is skipped and said. Exit status: 0 if all pass, 1 otherwise.
"""
import argparse
import os
import pathlib
import re
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import threading
import time

SOURCE = pathlib.Path(__file__).resolve().parents[2]
GOLDEN = SOURCE / "formats/golden/v1"
CUBE = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + (
    "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n")
REFUSED, USAGE, UNAVAILABLE, NOT_WRITTEN = 1, 2, 3, 4
SECONDS = 60
NOBODY = 65534


class Skipped(Exception):
    """Says why this machine cannot run a test."""


class Room:
    """Folder of a test, with a cube and the tools."""

    def __init__(self, bin_folder, folder):
        self.bin, self.folder = bin_folder, pathlib.Path(folder)
        (self.folder / "cube.obj").write_text(CUBE)

    def path(self, name):
        return str(self.folder / name)

    def command(self, tool, *arguments):
        return [str(self.bin / tool), *map(str, arguments)]

    def pack(self, *arguments, spheres=20):
        return self.command("vpm-pack", self.path("cube.obj"), "--spheres", spheres, *arguments)

    def run(self, command, **options):
        options.setdefault("stdin", subprocess.DEVNULL)
        try:
            return subprocess.run(command, cwd=self.folder, capture_output=True, timeout=SECONDS,
                                  **options)
        except PermissionError as fault:  # a folder above the tools or the test is locked
            raise Skipped(f"another user may not run the tools here: {fault}") from None

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())


def expect(condition, text):
    if not condition:
        raise AssertionError(text)


def expect_error(done, code, *words):
    """Expects the exit code and one line of standard error that has the words."""
    said = done.stderr.decode(errors="replace")
    expect(done.returncode == code, f"exit {done.returncode}, not {code}: {said}")
    expect(re.match(r"^vpm-\w+: error: ", said) and said.count("\n") == 1,
           f"not one line of error: {said}")
    for word in words:
        expect(word in said, f"'{word}' is not in: {said}")
    expect("std::" not in said and "terminate" not in said, f"a C++ name in: {said}")


def limited(kind, amount):
    return lambda: resource.setrlimit(kind, (amount, amount))


def become_another():
    os.setgroups([])
    os.setgid(NOBODY)
    os.setuid(NOBODY)


def tools_for_others(room, *names):
    """Copies tools to where other users may run them, and returns the folder."""
    room.folder.chmod(0o777)
    tools = room.folder / "tools"
    tools.mkdir()
    for name in names:
        shutil.copy(room.bin / name, tools / name)
    folder = room.folder
    while folder != folder.parent:
        if not folder.stat().st_mode & stat.S_IXOTH:
            raise Skipped(f"others may not enter {folder}")
        folder = folder.parent
    return tools


def test_full_device(room):
    expect_error(room.run(room.pack("-o", "/dev/full")), NOT_WRITTEN, "/dev/full", "No space")


def test_full_disk(room):
    """A file system of 64 kB, whose old file must stay."""
    disk = room.folder / "disk"
    disk.mkdir()
    if shutil.which("mount") is None:
        raise Skipped("there is no mount (Debian: mount)")
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "none", disk],
                             capture_output=True)
    if mounted.returncode != 0:
        raise Skipped("no file system can be mounted")
    try:
        (disk / "out.vpmp").write_bytes(b"old")
        (disk / "filler").write_bytes(bytes(56 * 1024))
        done = room.run(room.pack("--force", "-o", disk / "out.vpmp", spheres=3000))
        expect_error(done, NOT_WRITTEN, "No space")
        expect((disk / "out.vpmp").read_bytes() == b"old", "the old file is lost")
        expect(sorted(p.name for p in disk.iterdir()) == ["filler", "out.vpmp"], "leftovers")
    finally:
        subprocess.run(["umount", disk], check=True)


def test_file_size_limit(room):
    (room.folder / "out.vpmp").write_bytes(b"old")
    done = room.run(room.pack("--force", "-o", "out.vpmp"),
                    preexec_fn=limited(resource.RLIMIT_FSIZE, 100))
    expect_error(done, NOT_WRITTEN, "File too large")
    expect((room.folder / "out.vpmp").read_bytes() == b"old", "the old file is lost")
    expect(room.names() == ["cube.obj", "out.vpmp"], f"leftovers: {room.names()}")


def test_closed_pipe(room):
    """A reader that goes away ends the tool quietly."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(room.pack("-o", "-"), cwd=room.folder, stdout=writer,
                          stderr=subprocess.PIPE, timeout=SECONDS, restore_signals=True)
    os.close(writer)
    expect(done.returncode == -signal.SIGPIPE, f"exit {done.returncode}")
    expect(b"error" not in done.stderr, done.stderr.decode())


def test_full_pipe(room):
    """A pipe that its reader empties slowly loses nothing."""
    whole = room.run(room.pack("-o", "whole.vpmp", spheres=2000))
    expect(whole.returncode == 0, whole.stderr.decode())
    process = subprocess.Popen(room.pack("-o", "-", spheres=2000), cwd=room.folder,
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    taken = b""
    while piece := process.stdout.read(4096):
        taken += piece
        time.sleep(0.001)
    expect(process.wait(SECONDS) == 0, "the tool failed")
    expect(taken == (room.folder / "whole.vpmp").read_bytes(), "bytes differ")


def test_read_only_folder(room):
    folder = room.folder / "locked"
    folder.mkdir()
    (folder / "out.vpmp").write_bytes(b"old")
    folder.chmod(0o555)
    tools, options = room.bin, {}
    if os.geteuid() == 0:  # may write everywhere
        tools, options = tools_for_others(room, "vpm-pack"), {"preexec_fn": become_another}
    done = room.run([str(tools / "vpm-pack"), room.path("cube.obj"), "--force", "-o",
                     "locked/out.vpmp"], **options)
    expect_error(done, NOT_WRITTEN, "Permission denied")
    expect((folder / "out.vpmp").read_bytes() == b"old", "the old file is lost")


def test_missing_folder(room):
    done = room.run(room.pack("-o", "missing/out.vpmp"))
    expect(done.returncode in (USAGE, NOT_WRITTEN), f"exit {done.returncode}")
    expect_error(done, done.returncode, "missing")


def test_little_address_space(room):
    """The programs start or say why they cannot, for every limit of the address space."""
    for megabytes in (100, 300, 600, 1500):
        for tool in ("vpm-pack", "vpm-graph", "vpm-normals", "vpm-query"):
            done = room.run(room.command(tool, "--version"),
                            preexec_fn=limited(resource.RLIMIT_AS, megabytes << 20))
            if done.returncode != 0 and b"error while loading" not in done.stderr:
                expect_error(done, UNAVAILABLE, "cannot start", "ulimit")
        done = room.run(room.pack("-o", "out.vpmp", "--force"),
                        preexec_fn=limited(resource.RLIMIT_AS, megabytes << 20))
        if done.returncode != 0:
            expect(done.returncode in (REFUSED, UNAVAILABLE), f"{megabytes} MB: {done}")
            expect_error(done, done.returncode)
        expect(not [n for n in room.names() if n.endswith(".tmp")], f"leftovers {room.names()}")


def test_few_descriptors(room):
    for count in range(3, 12):
        done = room.run(room.pack("-o", "out.vpmp", "--force"),
                        preexec_fn=limited(resource.RLIMIT_NOFILE, count))
        if done.returncode == 0 or b"error while loading" in done.stderr:
            continue
        expect_error(done, done.returncode, "Too many open files")


def refuse_threads():
    """Becomes a user who may have no further process."""
    become_another()
    resource.setrlimit(resource.RLIMIT_NPROC, (1, 1))


def test_refused_threads(room):
    if os.geteuid() != 0:
        raise Skipped("only root can become another user")
    tools = tools_for_others(room, "vpm-pack", "vpm-graph", "vpm-query")
    for name in ("cube.vpmg", "wall.vpmc"):
        shutil.copy(GOLDEN / name, room.folder / name)
    for tool in ("vpm-pack", "vpm-graph"):
        done = room.run([str(tools / tool), "--version"], preexec_fn=refuse_threads)
        if done.returncode != 0:
            expect_error(done, UNAVAILABLE, "cannot start", "thread", "ulimit -u")
    done = room.run([str(tools / "vpm-query"), "--tool", "cube.vpmg", "--cloud", "wall.vpmc",
                     "--threads", "4"], preexec_fn=refuse_threads,
                    stdin=None, input=b"[0,0,1,0,0,0,1]\n" * 100)
    if done.returncode != 0:
        expect_error(done, done.returncode)


def test_fifo(room):
    os.mkfifo(room.path("pipe.obj"))
    writer = threading.Thread(
        target=lambda: pathlib.Path(room.path("pipe.obj")).write_text(CUBE))
    writer.start()
    done = room.run(room.command("vpm-pack", "pipe.obj", "--spheres", "5", "-o", "out.vpmp"))
    writer.join()
    expect(done.returncode == 0, done.stderr.decode())


def test_endless_input(room):
    endless = subprocess.Popen(["yes", "v 0 0 0"], stdout=subprocess.PIPE)
    done = room.run(room.command("vpm-pack", "-", "-o", "out"), stdin=endless.stdout)
    endless.kill()
    endless.wait()
    expect_error(done, REFUSED, "standard input", "1073741824 bytes")
    done = room.run(room.command("vpm-pack", "--config", "/dev/zero"))
    expect_error(done, USAGE, "configuration")


def test_changing_input(room):
    """A file that grows while it is read is refused."""
    path = room.folder / "grows.obj"
    with path.open("wb") as file:
        file.truncate(64 << 20)
    done_reading = threading.Event()

    def grow():
        with path.open("ab") as file:
            while not done_reading.is_set():
                file.write(b"#")
                file.flush()
                time.sleep(0.001)

    writer = threading.Thread(target=grow)
    writer.start()
    try:
        done = room.run(room.command("vpm-pack", "grows.obj", "-o", "out.vpmp"))
    finally:
        done_reading.set()
        writer.join()
    expect_error(done, REFUSED, "grows.obj", "changed while it was read")


def test_killed_runs(room):
    """Of ten killed runs at most one temporary file is left, which the next run removes."""
    whole = room.run(room.pack("-o", "out.vpmp", spheres=2000))
    expect(whole.returncode == 0, whole.stderr.decode())
    old = (room.folder / "out.vpmp").read_bytes()
    killed_while_writing = 0
    for _ in range(10):
        process = subprocess.Popen(
            room.pack("--force", "-o", "out.vpmp", spheres=2000),
            cwd=room.folder, stderr=subprocess.DEVNULL)
        # Kills it as soon as its temporary file is there.
        while process.poll() is None:
            mine = [n for n in room.names() if n.endswith(".tmp") and f"-{process.pid}-" in n]
            if mine:
                process.kill()
        process.wait()
        left = [n for n in room.names() if n.endswith(".tmp")]
        expect(len(left) <= 1, f"{left} are left")
        for name in left:
            expect(name.startswith(f".out.vpmp.vpm-{process.pid}-"), f"{name} names no owner")
            killed_while_writing += 1
        expect((room.folder / "out.vpmp").read_bytes() == old, "the old file is harmed")
    again = room.run(room.pack("--force", "-o", "out.vpmp", spheres=2000))
    expect(again.returncode == 0, again.stderr.decode())
    expect(room.names() == ["cube.obj", "out.vpmp"], f"leftovers: {room.names()}")
    return f"{killed_while_writing} of 10 killed while writing"


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, type=pathlib.Path, help="folder of the tools")
    parser.add_argument("names", nargs="*", help="tests to run; all if none is named")
    options = parser.parse_args()
    tests = {name[5:]: test for name, test in globals().items() if name.startswith("test_")}
    failed = False
    for name in options.names or tests:
        with tempfile.TemporaryDirectory() as folder:
            try:
                print(f"{name}: ok {tests[name](Room(options.bin.resolve(), folder)) or ''}")
            except Skipped as why:
                print(f"{name}: skipped, {why}")
            except (AssertionError, subprocess.TimeoutExpired) as fault:
                print(f"{name}: FAILED: {fault}")
                failed = True
    sys.exit(failed)


if __name__ == "__main__":
    main()
