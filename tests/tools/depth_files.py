#!/usr/bin/env python3
"""Writes a slanted wall, as a camera of 64 x 48 pixels sees it, in the formats of other programs.

    depth_files.py FOLDER

The depth of column u is 1000 + u millimetres; the camera is 60,60,31.5,23.5.
"""
import pathlib
import struct
import sys

WIDTH, HEIGHT = 64, 48
CAMERA = (60, 60, 31.5, 23.5)  # fx, fy, cx, cy
MILLIMETRES = [1000 + u for _ in range(HEIGHT) for u in range(WIDTH)]


def pgm(values, order=">"):
    return b"P5\n# a wall\n%d %d\n65535\n" % (WIDTH, HEIGHT) + struct.pack(f"{order}{len(values)}H", *values)


def pfm(metres):
    rows = [metres[v * WIDTH:(v + 1) * WIDTH] for v in reversed(range(HEIGHT))]
    return b"Pf\n%d %d\n-1.0\n" % (WIDTH, HEIGHT) + b"".join(struct.pack(f"<{WIDTH}f", *row) for row in rows)


def npy(metres, *shape):
    header = "{'descr': '<f4', 'fortran_order': False, 'shape': %s, }\n" % (shape or (HEIGHT, WIDTH),)
    return b"\x93NUMPY\x01\0" + struct.pack("<H", len(header)) + header.encode() + struct.pack(f"<{len(metres)}f", *metres)


def tiff(values):
    """Returns an uncompressed TIFF of 16-bit integers."""
    data = struct.pack(f"<{len(values)}H", *values)
    entries = [(256, 4, WIDTH), (257, 4, HEIGHT), (258, 3, 16), (259, 3, 1), (262, 3, 1), (273, 4, 8), (277, 3, 1),
               (278, 4, HEIGHT), (279, 4, len(data))]
    directory = struct.pack("<H", len(entries))
    directory += b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in entries) + struct.pack("<I", 0)
    return b"II*\0" + struct.pack("<I", 8 + len(data)) + data + directory


def opengl_pcd(metres):
    """Returns an organised cloud with y up and z backward."""
    fx, fy, cx, cy = CAMERA
    points = [((k % WIDTH - cx) / fx * z, -(k // WIDTH - cy) / fy * z, -z) for k, z in enumerate(metres)]
    head = f"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {WIDTH}\nHEIGHT {HEIGHT}\n"
    head += f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {WIDTH * HEIGHT}\nDATA binary\n"
    return head.encode() + b"".join(struct.pack("<3f", *p) for p in points)


CAMERA_INFO = """image_width: 64
image_height: 48
camera_matrix:
  rows: 3
  cols: 3
  data: [60.0, 0.0, 31.5, 0.0, 60.0, 23.5, 0.0, 0.0, 1.0]
distortion_coefficients: {rows: 1, cols: 5, data: [0.0, 0.0, 0.0, 0.0, 0.0]}
"""


def write_all(folder):
    metres = [value / 1000 for value in MILLIMETRES]
    marked = [65535 if k % WIDTH == 63 else value for k, value in enumerate(MILLIMETRES)]
    files = {
        "wall.pgm": pgm(MILLIMETRES), "swapped.pgm": pgm(MILLIMETRES, "<"), "rotated.pgm": pgm([8 * v for v in MILLIMETRES]),
        "marked.pgm": pgm(marked), "wall.pfm": pfm(metres), "wall.npy": npy(metres), "wall.tif": tiff(MILLIMETRES),
        "far.npy": npy([9.0 if k % WIDTH == 63 else z for k, z in enumerate(metres)]), "opengl.pcd": opengl_pcd(metres),
        "info.yaml": CAMERA_INFO.encode(),
        "realsense.json": b'{"width": 64, "height": 48, "fx": 60, "fy": 60, "ppx": 31.5, "ppy": 23.5}\n',
        "open3d.json": b'{"width": 64, "height": 48, "intrinsic_matrix": [60,0,0, 0,60,0, 31.5,23.5,1]}\n',
        "larger.json": b'{"width": 128, "height": 96, "fx": 120, "fy": 120, "ppx": 63.5, "ppy": 47.5}\n',
        "pose.txt": b"1 0 0 0\n0 1 0 0\n0 0 1 0.5\n0 0 0 1\n",
    }
    for name, data in files.items():
        (folder / name).write_bytes(data)


def main():
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    write_all(folder)


if __name__ == "__main__":
    main()
