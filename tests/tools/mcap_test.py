#!/usr/bin/env python3
"""Tests that recordings of ROS 2 give the answers that the same frames give as PNG files, and that what lies in them is refused.

    mcap_test.py --bin DIR hand|npm|lies

hand: the recording is written by mcap_writer.py. npm: by @mcap/core, which npm installs into a temporary folder. lies: recordings whose
lengths, sizes, checksums, compressions and types lie end in one line, in little time and memory; what is cut is read as far as it
goes. Exit status: 0 if all holds, 1 otherwise, 77 where npm cannot install the package.
"""
import argparse
import base64
import json
import os
import pathlib
import random
import resource
import shutil
import struct
import subprocess
import sys
import tempfile

import frames
import mcap_writer as mcap

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77
PATIENCE = 60  # s, in which npm installs what is small
COUNT, START = 20, 1700000000  # frames, 30 a second; s
CAMERA = (60, 60, 31.5, 23.5)
TOPIC, FRAME = "/camera/depth/image_rect_raw", "camera_depth_optical_frame"


def stamp(k):
    """Returns the time of frame k, ns."""
    return START * 10**9 + k * 33333333


def seconds(nanoseconds):
    return f"{nanoseconds // 10**9}.{nanoseconds % 10**9:09}"


class Stamped(mcap.Cdr):
    """Takes the times of headers in nanoseconds."""

    def header(self, time, frame):
        return self.add("i", time // 10**9).add("I", time % 10**9).text(frame)


def motion(k):
    """Returns the places of the mast in the world, and of the tool: numbers whose sums are exact."""
    return (k / 64, 0, -k / 128), (k / 64, 0, 1.25 - k / 64)


def messages():
    """Yields topic, type, message and time, ns, of a camera on a mast that moves, and of a tool, which TF tells as tool0 of the world and,
    at every second time only, as tool1 of a base that is turned by 90 degrees."""
    def transform(cdr, time, parent, child, place, turn=0):
        cdr.header(time, parent).text(child).add("d", *place, 0, 0, turn * 0.5**0.5, 0.5**0.5 if turn else 1)
    still = Stamped().add("I", 2)
    transform(still, 0, "mast", FRAME, (0, 0.125, 0.0625))
    transform(still, 0, "world", "base", (0.5, -0.25, 0.125), 1)
    yield "/tf_static", mcap.TF, still.message(), stamp(0)
    for k in range(COUNT):
        time = stamp(k)
        mast, tool = motion(k)
        moving = Stamped().add("I", 2 + (k % 2 == 0 or k == COUNT - 1))
        transform(moving, time, "world", "mast", mast)
        transform(moving, time, "world", "tool0", tool)
        if k % 2 == 0 or k == COUNT - 1:
            transform(moving, time, "base", "tool1", (tool[1] + 0.25, 0.5 - tool[0], tool[2] - 0.125), -1)
        yield "/tf", mcap.TF, moving.message(), time
        yield "/tool", mcap.POSE, Stamped().header(time, "world").add("d", *tool, 0, 0, 0, 1).message(), time
        info = Stamped().header(time, FRAME).add("I", frames.HEIGHT, frames.WIDTH).text("plumb_bob").add("I", 0)
        fx, fy, cx, cy = CAMERA
        info.add("d", fx, 0, cx, 0, fy, cy, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1, fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0)
        yield "/camera/depth/camera_info", mcap.CAMERA_INFO, info.add("I", 0, 0, 0, 0, 0, 0).add("B", 0).message(), time
        row = struct.pack("<H", 1000 + 3 * k) * frames.WIDTH
        image = Stamped().header(time, FRAME).add("I", frames.HEIGHT, frames.WIDTH).text("16UC1").add("B", 0)
        yield TOPIC, mcap.IMAGE, image.add("I", len(row)).data(row * frames.HEIGHT).message(), time


def write_files(folder):
    """Writes the same frames as a folder of PNG with lists, and the tool's path."""
    (folder / "depth").mkdir(parents=True)
    lines = {"depth.txt": "", "groundtruth.txt": "", "tool.txt": ""}
    for k in range(COUNT):
        time = seconds(stamp(k))
        (folder / "depth" / f"{time}.png").write_bytes(frames.png(1000 + 3 * k))
        lines["depth.txt"] += f"{time} depth/{time}.png\n"
        (x, y, z), tool = motion(k)
        lines["groundtruth.txt"] += f"{time} {x} {y + 0.125} {z + 0.0625} 0 0 0 1\n"
        lines["tool.txt"] += f"{time} {tool[0]} {tool[1]} {tool[2]} 0 0 0 1\n"
    for name, text in lines.items():
        (folder / name).write_text(text)


def run(*command, **options):
    return subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, check=False, **options)


def output_of(*command):
    done = run(*command)
    assert done.returncode == 0, f"{command}: {done.stderr.decode()}"
    return done.stdout


def write_by_hand(file, compression):
    writer = mcap.Writer(7, True, compression)
    for topic, kind, message, time in messages():
        writer.add(topic, kind, message, time / 1e9)
    file.write_bytes(writer.bytes())


def npm_folder(folder):
    """Returns a folder in which @mcap/core is installed; none where it cannot be."""
    if not shutil.which("npm") or not shutil.which("node"):
        print("skipped: npm and node are not installed")
        return None
    packages = "@mcap/core@2", "@foxglove/wasm-zstd@1"
    try:
        installed = run("npm", "install", "--no-audit", "--no-fund", "--fetch-retries=0", "--prefix", folder, *packages, timeout=PATIENCE)
        fault = installed.returncode and installed.stderr.decode()[:200]
    except subprocess.TimeoutExpired:
        fault = f"it takes more than {PATIENCE} s"
    if fault:
        print("skipped: npm cannot install", *packages, fault)
        return None
    shutil.copy(HERE / "mcap_npm.mjs", folder)
    return folder


def write_by_npm(file, compression, folder):
    told = [{"topic": topic, "type": kind, "time": str(time), "data": base64.b64encode(message).decode()}
            for topic, kind, message, time in messages()]
    subprocess.run(["node", folder / "mcap_npm.mjs", file, compression or "none"], input=json.dumps(told).encode(), check=True)


def check_answers(folder, files, rec):
    """Checks that the recording gives the bytes that the files give, but for the ending of the frames' names."""
    def ask(*options):
        return output_of("vpm-query", "--tool", folder / "cube.vpmg", "--rate", 60, "--quiet", *options)
    expected = ask("--frames", files, "--intrinsics", "60,60,31.5,23.5", "--poses", files / "tool.txt").replace(b'.png"', b'"')
    fractions = {json.loads(line)["volume_fraction"] for line in expected.splitlines()}
    assert len(fractions) > COUNT, "the tool does not move through the scene"
    for poses in ("/tool", "tool0", "world:tool0"):
        assert ask("--frames", rec, "--topic", TOPIC, "--trajectory", f"{rec}:{poses}") == expected, f"{rec}:{poses} gives other answers"
    answers = [json.loads(line) for line in expected.splitlines()]
    for poses, turned in (("tool1", 0), ("base:tool0", 1), ("base:tool1", 1)):
        others = [json.loads(line) for line in ask("--frames", rec, "--poses", f"{rec}:{poses}").splitlines()]
        assert len(others) == len(answers), f"{poses}: {len(others)} answers"
        for answer, other in zip(answers, others):
            x, y, z = other["force"]
            force = (-y, x, z) if turned else (x, y, z)
            for mine, its in zip((answer["volume"], *answer["force"]), (other["volume"], *force)):
                assert abs(mine - its) < 1e-6 * 0.008, f"{poses}: {other} in place of {answer}"
    at, last = seconds(stamp(5)), seconds(stamp(COUNT - 1))
    for name, options in (("a", ["--at", at]), ("b", ["--at", f"+{19 * 0.033333333}"]), ("first", [])):
        output_of("vpm-normals", rec, "--topic", TOPIC, "-o", folder / f"{name}.vpmc", "--force", "--quiet", *options)
    output_of("vpm-normals", files, "-o", folder / "clouds", "--intrinsics", "60,60,31.5,23.5", "--force", "--quiet")
    poses = [f"--pose={','.join(map(str, motion(5)[1]))},0,0,0,1"]
    for name, time in (("a", at), ("b", last), ("first", seconds(stamp(0)))):
        mine, other = (output_of("vpm-query", "--tool", folder / "cube.vpmg", "--cloud", cloud, "--quiet", *poses)
                       for cloud in (folder / f"{name}.vpmc", folder / "clouds" / f"{time}.vpmc"))
        assert mine == other, f"the cloud of {time} is another one"


def mutations():
    """Yields names of recordings that lie, and their bytes."""
    wanted = mcap.Recording()
    sound = mcap.write(mcap.messages_of_wall(2, wanted), wanted)
    plain = mcap.Recording()
    plain.per_chunk = 0
    unchunked = mcap.write(mcap.messages_of_wall(2, plain), plain)
    chunk = sound.index(b"\x06", len(mcap.MAGIC) + 9 + 19)
    huge = b"\xff" * 7 + b"\x7f"

    def put(data, at, part):
        return data[:at] + part + data[at + len(part):]
    yield "record", put(sound, chunk + 1, huge)
    yield "chunk size", put(sound, chunk + 9 + 16, huge)
    yield "large chunk size", put(sound, chunk + 9 + 16, struct.pack("<Q", 200_000_000))
    yield "checksum", put(sound, chunk + 9 + 24, b"\1\2\3\4")
    yield "name of the compression", put(sound, chunk + 9 + 28, b"\xff\xff\xff\xff")
    yield "stored size", put(sound, chunk + 9 + 32, huge)
    image = unchunked.index(b"16UC1\0")
    yield "width", put(unchunked, image - 8, b"\xff\xff\xff\xff")
    yield "height", put(unchunked, image - 12, b"\xff\xff\xff\xff")
    yield "encoding", put(unchunked, image - 4, b"\xff\xff\xff\xff")
    yield "step", put(unchunked, image + 8, b"\xff\xff\xff\xff")
    yield "data", put(unchunked, image + 12, b"\xff\xff\xff\xff")
    yield "order of bytes", unchunked.replace(b"\0\1\0\0\xe8\3\0\0", b"\0\7\0\0\xe8\3\0\0")
    for name in ("lz4", "zstd"):
        wanted.compression = name
        packed = mcap.write(mcap.messages_of_wall(2, wanted), wanted)
        yield f"huge {name}", put(packed, chunk + 9 + 16, huge)
        yield f"more {name}", put(packed, chunk + 9 + 16, struct.pack("<Q", 200_000_000))
        yield f"noise in {name}", put(packed, chunk + 70, bytes(range(40)))
        yield f"unknown {name}", packed.replace(name.encode(), b"x" * len(name))
    mixed = mcap.Writer()
    for kind in (mcap.POSE, mcap.IMAGE):
        mixed.add(wanted.topic, kind, mcap.pose(1, "a", (0, 0, 0, 0, 0, 0, 1)), 1)
    yield "two types", mixed.bytes()


def check_lies(folder):
    """Checks that each recording that lies ends in one line, within 2 s of the processor and 600 MB of addresses."""
    def limit():
        resource.setrlimit(resource.RLIMIT_CPU, (2, 2))
        resource.setrlimit(resource.RLIMIT_AS, (600 << 20, 600 << 20))
    for name, data in mutations():
        rec = folder / "lies.mcap"
        rec.write_bytes(data)
        done = run("vpm-normals", rec, "-o", folder / "lies.vpmc", "--force", preexec_fn=limit)
        lines = done.stderr.decode().splitlines()
        said = [line for line in lines if "error: " in line or "warning: " in line]
        assert done.returncode in (0, 1) and len(said) == 1, f"{name}: status {done.returncode}: {lines}"
        assert (done.returncode == 1) == ("error: " in said[0]), f"{name}: {lines}"


def check_cut(folder):
    """Checks that images are read of a chunk in which the file ends, as many as came before, whatever it is compressed by."""
    count, left = 40, 0.7
    noise = random.Random(1)
    for compression in ("", "lz4", "zstd"):
        writer = mcap.Writer(2 * count, True, compression)
        for k in range(count):
            row = 2 * frames.WIDTH
            rows = b"".join(struct.pack("<H", noise.randrange(500, 2000)) for _ in range(frames.WIDTH * frames.HEIGHT))
            writer.add("/camera/depth/camera_info", mcap.CAMERA_INFO, mcap.camera_info(k, "c", (frames.WIDTH, frames.HEIGHT), CAMERA), k)
            writer.add(TOPIC, mcap.IMAGE, mcap.image(k, "c", frames.WIDTH, frames.HEIGHT, "16UC1", rows, row), k)
        data = writer.bytes()
        rec, clouds = folder / "cut.mcap", folder / f"cut_{compression}"
        rec.write_bytes(data[:int(left * len(data))])
        done = run("vpm-normals", rec, "-o", f"{clouds}/", "--force")
        found = len(list(clouds.glob("*.vpmc")))
        assert done.returncode == 0 and b"it has no end" in done.stderr, f"{compression}: {done}"
        assert count / 3 < found <= left * count, f"{compression}: {found} images"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("part", choices=("hand", "npm", "lies"))
    arguments = parser.parse_args()
    os.environ["PATH"] = arguments.bin + ":" + os.environ["PATH"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if arguments.part == "lies":
            check_lies(folder)
            check_cut(folder)
            return 0
        npm = npm_folder(folder / "npm") if arguments.part == "npm" else None
        if arguments.part == "npm" and npm is None:
            return SKIPPED
        output_of("vpm-pack", HERE / "inputs/cube.off", "-o", folder / "cube.vpmp", "--spheres", 50, "--quiet")
        output_of("vpm-graph", folder / "cube.vpmp", "-o", folder / "cube.vpmg", "--levels", 30, "--quiet")
        write_files(folder / "files")
        for compression in ("", "zstd") if npm else ("", "lz4", "zstd"):
            rec = folder / "rec.mcap"
            if npm:
                write_by_npm(rec, compression, npm)
            else:
                write_by_hand(rec, compression)
            check_answers(folder, folder / "files", rec)
    return 0


if __name__ == "__main__":
    sys.exit(main())
