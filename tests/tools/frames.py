#!/usr/bin/env python3
"""Makes a recording of a wall that comes 10 mm nearer with each frame: frames.py numbered|timed FOLDER COUNT.

16-bit PNG of 64 x 48 pixels, millimetres, f = 60 px; the first frame sees the wall at 1 m. `numbered`: frame-000000.depth.png
with .pose.txt, as 7-Scenes has it; `timed`: depth.txt, depth/TIME.png and groundtruth.txt, 30 frames a second from
1000 s on, as TUM RGB-D has it.
"""
import pathlib
import struct
import sys
import zlib

WIDTH, HEIGHT = 64, 48


def png(millimetres):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = (b"\0" + struct.pack(">H", millimetres) * WIDTH) * HEIGHT
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def main(kind, folder, count):
    (folder / "depth" if kind == "timed" else folder).mkdir(parents=True)
    lines = []
    for k in range(count):
        image = png(1000 - 10 * k)
        if kind == "numbered":
            (folder / f"frame-{k:06}.depth.png").write_bytes(image)
            (folder / f"frame-{k:06}.pose.txt").write_text("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
        else:
            name = f"depth/{1000 + k / 30:.6f}.png"
            (folder / name).write_bytes(image)
            lines.append(f"{1000 + k / 30:.6f} {name}\n")
    if kind == "timed":
        (folder / "depth.txt").write_text("# time file\n" + "".join(lines))
        (folder / "groundtruth.txt").write_text("999 0 0 0 0 0 0 1\n1010 0 0 0 0 0 0 1\n")


if __name__ == "__main__":
    main(sys.argv[1], pathlib.Path(sys.argv[2]), int(sys.argv[3]))
