#!/usr/bin/env python3
"""Writes a cloud by formats/*.md alone: independent_writer.py FILE.vpmc. It shares no code with libvpm, so it shows that the
specification suffices to write what the tools accept. The camera, 60,60,31.5,23.5 of 64 x 48 pixels, sees a wall at 1 m.
"""
import ctypes
import ctypes.util
import json
import math
import struct
import sys

xxhash = ctypes.CDLL(ctypes.util.find_library("xxhash"))
xxhash.XXH3_64bits.restype = ctypes.c_uint64
xxhash.XXH3_64bits.argtypes = [ctypes.c_char_p, ctypes.c_size_t]


def checksum(data):
    return xxhash.XXH3_64bits(data, len(data))


def container(kind, header, chunks):
    """Returns the bytes of a file; a chunk is its name, the size of an element and its bytes."""
    text = json.dumps(header).encode()
    end = 64 + 40 * len(chunks) + len(text)
    table, body = b"", b""
    for name, element, data in chunks:
        offset = -(-end // 64) * 64
        body += bytes(offset - end) + data
        end = offset + len(data)
        table += struct.pack("<4sIIIQQQ", name, 0, element, 0, offset, len(data), checksum(data))
    start = struct.pack("<8sIIIIQIIQQ", b"\x89VPM\r\n\x1a\n", 1, kind, 0, 0, end, len(chunks), len(text), 0,
                        checksum(table + text))
    return start + struct.pack("<Q", checksum(start)) + table + text + body


def wall(fx, fy, cx, cy, width, height, z):
    """Returns the chunks of a camera that sees a plane at depth z in every pixel."""
    pixels = [(u, v) for v in range(height) for u in range(width)]
    points = [((u - cx) * z / fx, (v - cy) * z / fy, z) for u, v in pixels]
    half_diagonal = math.hypot(1 / fx, 1 / fy) / 2
    radii = [z * half_diagonal * math.hypot(*p) / p[2] for p in points]  # / the cosine between normal and ray
    camera = struct.pack("<4d12d2I", fx, fy, cx, cy, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, width, height)
    return [(b"ORIG", 24, struct.pack("<3d", 0, 0, 0)),
            (b"POSN", 12, b"".join(struct.pack("<3f", *p) for p in points)),
            (b"NRML", 12, struct.pack("<3f", 0, 0, -1) * len(points)),
            (b"RADI", 4, struct.pack(f"<{len(radii)}f", *radii)),
            (b"PIXL", 4, struct.pack(f"<{len(points)}I", *range(len(points)))),
            (b"CAMR", 136, camera),
            (b"DPTH", 4, struct.pack("<f", z) * len(points))]


if __name__ == "__main__":
    header = {"unit": "m", "provenance": {"tool": "independent_writer.py"}}
    with open(sys.argv[1], "wb") as file:
        file.write(container(3, header, wall(60, 60, 31.5, 23.5, 64, 48, 1.0)))
