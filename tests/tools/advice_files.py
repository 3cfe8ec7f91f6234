"""Writes the inputs of advice_test.py: meshes, depth images, clouds, cameras, poses and recordings with one mistake each.

The cube of the meshes has an edge of 1 m. The wall of the scenes is that of depth_files.py: 64 x 48 pixels, the camera
60,60,31.5,23.5, the depth of column u is 1 + u / 1000 m.
"""
import bz2
import gzip
import json
import lzma
import math
import pathlib
import struct
import subprocess
import sys
import zipfile
import zlib

import depth_files
import scene_files
from depth_files import HEIGHT, MILLIMETRES, WIDTH

HERE = pathlib.Path(__file__).resolve().parent
METRES = [value / 1000 for value in MILLIMETRES]
CORNERS = scene_files.VERTICES
FACES = scene_files.FACES  # of four corners each
TRIANGLES = scene_files.TRIANGLES
LAST_COLUMN = [k % WIDTH == WIDTH - 1 for k in range(WIDTH * HEIGHT)]


def off(vertices, faces):
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(f"{x:.17g}" for x in v) for v in vertices]
    return "\n".join(lines + [" ".join(map(str, [len(f), *f])) for f in faces]) + "\n"


def scaled(vertices, factor, shift=(0, 0, 0)):
    return [tuple(factor * x + s for x, s in zip(v, shift)) for v in vertices]


def joined(*parts):
    """Returns the vertices and faces of several meshes as those of one."""
    vertices, faces = [], []
    for more, their_faces in parts:
        faces += [tuple(k + len(vertices) for k in f) for f in their_faces]
        vertices += more
    return vertices, faces


def binary_stl(vertices, triangles):
    facets = [struct.pack("<12fH", 0, 0, 0, *(x for k in t for x in vertices[k]), 0) for t in triangles]
    return b"\0" * 80 + struct.pack("<I", len(facets)) + b"".join(facets)


def moebius(radius, steps=24):
    """Returns a strip with half a turn, about the x axis."""
    vertices, triangles = [], []
    for k in range(steps):
        angle, turn = 2 * math.pi * k / steps, math.pi * k / steps
        for side in (-0.3, 0.3):
            r = radius * (1 + side * math.cos(turn))
            vertices.append((radius * side * math.sin(turn) + 3, r * math.cos(angle), r * math.sin(angle)))
    for k in range(steps):
        a, b = 2 * k, 2 * k + 1
        c, d = (2 * k + 2, 2 * k + 3) if k + 1 < steps else (1, 0)
        triangles += [(a, b, c), (b, d, c)]
    return vertices, triangles


def ball_of_patches(rows=32):
    """Returns a ball of squares with gaps between them, of which every second one faces inward."""
    vertices, faces = [], []

    def at(u, v):
        polar, around = math.pi * u / rows, math.pi * v / rows
        return math.sin(polar) * math.cos(around), math.sin(polar) * math.sin(around), math.cos(polar)
    for i in range(rows):
        for j in range(2 * rows):
            low, high = 0.02, 0.98
            square = [(low, low), (high, low), (high, high), (low, high)]
            faces.append(tuple(range(len(vertices), len(vertices) + 4))[::1 if (i + j) % 2 else -1])
            vertices += [at(i + a, j + b) for a, b in square]
    return vertices, faces


def squares_apart(gap):
    """Returns the cube as squares with gaps between them, of which every second one faces inward."""
    vertices, faces = [], []
    for k, face in enumerate(FACES):
        middle = [sum(CORNERS[c][axis] for c in face) / 4 for axis in range(3)]
        faces.append(tuple(range(4 * k, 4 * k + 4))[::1 if k % 2 else -1])
        vertices += [tuple(m + (1 - gap) * (x - m) for x, m in zip(CORNERS[c], middle)) for c in face]
    return vertices, faces


def write_meshes(folder):
    box = (CORNERS, FACES)
    plate = [(x, y, 0.05 * z) for x, y, z in CORNERS]
    loose = [v for f in FACES for v in scaled([CORNERS[k] for k in f], 1, (1e-4 * sum(f), 0, 0))]
    inner = (scaled(CORNERS, 0.5, (0.25, 0.25, 0.25)), FACES)
    turned = (inner[0], [f[::-1] for f in FACES])
    far = scaled(CORNERS, 1, (4.65e6, 0, 0))
    crossing = [(0, 0, 0), (2, 2, 0), (2, 0, 0), (0, 2, 0), (-1, 1, 0)]
    files = {
        "cube.off": off(*box), "open.off": off(CORNERS, FACES[:-1]), "cube_mm.off": off(scaled(CORNERS, 1000), FACES),
        "tiny.off": off(scaled(CORNERS, 0.0005), FACES), "huge.off": off(scaled(CORNERS, 1e31), FACES),
        "small.off": off(scaled(CORNERS, 0.2, (-0.1, -0.1, -0.1)), FACES),
        "other.off": off(scaled(CORNERS, 0.3, (-0.1, -0.1, -0.1)), FACES),
        "small_mm.off": off(scaled(CORNERS, 200, (-100, -100, -100)), FACES),
        "loose.off": off(loose, [range(k, k + 4) for k in range(0, len(loose), 4)]),
        "gaps.off": off(*ball_of_patches()), "apart.off": off(*squares_apart(0.02)), "sheet.off": off(CORNERS[:4], [(0, 1, 3, 2)]),
        "fan.off": off(CORNERS, [*FACES, (0, 1, 7)]), "plate.off": off(plate, FACES),
        "foil.off": off([(x, y, 1e-6 * z) for x, y, z in CORNERS], FACES),
        "moebius.off": off(*joined(box, moebius(0.1))), "moebius_alone.off": off(*moebius(0.1)),
        "inner.off": off(*joined(box, inner)), "cavity.off": off(*joined(box, turned)),
        "far.stl": binary_stl(far, TRIANGLES), "near.stl": binary_stl(CORNERS, TRIANGLES),
        "cut.stl": binary_stl(CORNERS, TRIANGLES)[:-50],
        "crossing.off": off([*CORNERS, *crossing], [*FACES, (8, 9, 10, 11, 12)]),
        "points.obj": "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS), "blank.obj": "\n", "words.txt": "words of no format\n", "points.xyz": "0 0 0\n1 0 0\n0 1 0\n",
        "robot.urdf": '<?xml version="1.0"?>\n<robot name="r"><link name="l"><visual><geometry><mesh filename="cube.off"/>'
                      "</geometry></visual></link></robot>\n",
        "binary.off": b"4OFF BINARY\n" + struct.pack(">3i", 1, 0, 0) + struct.pack(">4f", 0, 0, 0, 1),
        "text.off": "4OFF 8 6 0\n" + "\n".join(f"{x} {y} {z} 1" for x, y, z in CORNERS) + "\n"
                    + "\n".join(" ".join(map(str, [4, *f])) for f in FACES) + "\n",
        "cube.obj": "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(
            f"f {' '.join(str(k + 1) for k in f)}\n" for f in FACES),
    }
    files["packed.gltf"] = '{"asset": {"version": "2.0"}, "extensionsRequired": ["EXT_meshopt_compression"]}'
    write_all(folder, files)
    scene_files.write_all(folder)
    cube = (folder / "cube.dae").read_text()
    (folder / "comma.dae").write_text(cube.replace('meter="0.001"', 'meter="0,001"'))
    (folder / "nodes.dae").write_text(cube.replace('<instance_geometry url="#g"/>', ""))
    scene_files.threemf(folder / "parts.3mf", 1000, unit=' unit="millimeter" requiredextensions="slice"')
    (folder / "large.glb").write_bytes(scene_files.glb([("body", 100, (0, 0, 0))], 0.5))
    for name, settings in {"negative": '<config><object id="1"><volume firstid="0" lastid="11"><metadata key="volume_type" '
                                       'value="NegativeVolume"/></volume></object></config>', "settings": "<config>"}.items():
        scene_files.threemf(folder / f"{name}.3mf", 1000)
        with zipfile.ZipFile(folder / f"{name}.3mf", "a") as archive:
            archive.writestr("Metadata/Slic3r_PE_model.config", settings)
    skinned = (folder / "cube.gltf").read_text().replace('"mesh": 0', '"mesh": 0, "skin": 0')
    (folder / "skin.gltf").write_text(skinned.replace('"scene": 0', '"scene": 0, "skins": [{"joints": [0]}]'))
    (folder / "cut.glb").write_bytes((folder / "cube.glb").read_bytes()[:500])


def png(values):
    """Returns a PNG of 16-bit integers."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + struct.pack(f">{WIDTH}H", *values[v * WIDTH:(v + 1) * WIDTH]) for v in range(HEIGHT))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 16, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def exr(channels):
    """Returns an uncompressed OpenEXR image of 32-bit floats; channels: name and values."""
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<i", len(value)) + value
    channels = sorted(channels.items())
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name, _ in channels) + b"\0"
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    head = struct.pack("<ii", 20000630, 2) + attribute(b"channels", b"chlist", listed)
    head += attribute(b"compression", b"compression", b"\0") + attribute(b"dataWindow", b"box2i", window)
    head += attribute(b"displayWindow", b"box2i", window) + attribute(b"lineOrder", b"lineOrder", b"\0")
    head += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    size = 4 * WIDTH * len(channels)
    first = len(head) + 8 * HEIGHT
    table = struct.pack(f"<{HEIGHT}Q", *(first + v * (8 + size) for v in range(HEIGHT)))
    rows = [struct.pack("<ii", v, size) + b"".join(
        struct.pack(f"<{WIDTH}f", *values[v * WIDTH:(v + 1) * WIDTH]) for _, values in channels) for v in range(HEIGHT)]
    return head + table + b"".join(rows)


# Writes what a packed file holds to standard output, on machines without gunzip and its like.
UNPACK = """import bz2, gzip, lzma, sys, zipfile
name = sys.argv[1]
openers = {"gz": gzip.open, "bz2": bz2.open, "xz": lzma.open, "zip": lambda name: zipfile.ZipFile(name).open("wall.npy")}
sys.stdout.buffer.write(openers[name.split(".")[-1]](name).read())
"""


def write_images(folder):
    depth_files.write_all(folder)
    disparity = [2047 if last else round(1092.5 - 351.3 / z) for z, last in zip(METRES, LAST_COLUMN)]
    swapped = [(value >> 8) | (value & 255) << 8 for value in MILLIMETRES]
    nearer = [0.9 * z for z in METRES]
    files = {
        "steps.pgm": depth_files.pgm([1256 if 2 * (k % WIDTH) < WIDTH else 1000 for k in range(WIDTH * HEIGHT)], "<"),
        "white.pgm": depth_files.pgm([65535] * (WIDTH * HEIGHT)),
        "disparity.pgm": depth_files.pgm(disparity), "swapped.png": png(swapped), "wall.png": png(MILLIMETRES),
        "scale.pfm": depth_files.pfm([1000 * z for z in METRES]).replace(b"-1.0", b"-2.0", 1),
        "two.exr": exr({"left.Z": METRES, "right.Z": nearer}), "unnamed.exr": exr({"near": METRES, "far": nearer}),
        "layer.exr": exr({"WorldDepth.R": METRES, **{f"WorldDepth.{c}": [0] * len(METRES) for c in "GB"}, "R": nearer}),
        "wall.pgm.gz": gzip.compress(depth_files.pgm(MILLIMETRES)), "wall.pgm.bz2": bz2.compress(depth_files.pgm(MILLIMETRES)),
        "wall.pgm.xz": lzma.compress(depth_files.pgm(MILLIMETRES)), "empty.pgm": b"", "unpack.py": UNPACK,
        "rows.npy": depth_files.npy([x for p in points_of_wall() for x in p], WIDTH * HEIGHT, 3),
        "points.npy": depth_files.npy([x for p in points_of_wall() for x in p], HEIGHT, WIDTH, 3),
    }
    write_all(folder, files)
    with zipfile.ZipFile(folder / "wall.zip", "w") as archive:
        archive.writestr("wall.npy", depth_files.npy(METRES))


def points_of_wall():
    fx, fy, cx, cy = depth_files.CAMERA
    return [((k % WIDTH - cx) / fx * z, (k // WIDTH - cy) / fy * z, z) for k, z in enumerate(METRES)]


def pcd(points, width=WIDTH, height=HEIGHT, normals=None, viewpoint="0 0 0 1 0 0 0", version="0.7"):
    fields = "x y z" + (" normal_x normal_y normal_z" if normals else "")
    count = len(fields.split())
    head = f"VERSION {version}\nFIELDS {fields}\nSIZE{count * ' 4'}\nTYPE{count * ' F'}\nCOUNT{count * ' 1'}\nWIDTH {width}\n"
    head += f"HEIGHT {height}\nVIEWPOINT {viewpoint}\nPOINTS {len(points)}\nDATA ascii\n"
    rows = [(*p, *n) for p, n in zip(points, normals)] if normals else points
    return head + "".join(" ".join(f"{x:.9g}" for x in row) + "\n" for row in rows)


def ply(points, normals=None, kind="float", digits=17):
    names = "x y z nx ny nz".split()[:6 if normals else 3]
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property {kind} {name}\n" for name in names) + "end_header\n"
    rows = [(*p, *n) for p, n in zip(points, normals)] if normals else points
    return head + "".join(" ".join(f"{x:.{digits}g}" for x in row) + "\n" for row in rows)


def binary_ply(points, normals):
    """Returns a PLY of 32-bit floats, which alone are as coarse as they say: text keeps its digits."""
    head = ply(points, normals).split("end_header\n")[0].replace("ascii", "binary_little_endian") + "end_header\n"
    return head.encode() + b"".join(struct.pack("<6f", *p, *n) for p, n in zip(points, normals))


def write_clouds(folder):
    points = points_of_wall()
    toward, away, none = ([(0, 0, z)] * len(points) for z in (-1, 1, 0))
    in_gl = [(x, -y, -z) for x, y, z in points]
    in_ros = [(z, -x, -y) for x, y, z in points]
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    turned = [(c * x + s * z, y, c * z - s * x) for x, y, z in points]  # by 30 degrees about y
    one_row = {"width": len(points), "height": 1}
    # A lidar of 48 rings: its angles, not its tangents, are evenly spaced.
    angles = [((k % WIDTH - 31.5) / 60, (k // WIDTH - 23.5) / 60) for k in range(WIDTH * HEIGHT)]
    lidar = [(math.tan(a), math.tan(b) / math.cos(a), 1) for a, b in angles]
    files = {
        "grid.pcd": pcd(points), "gl.pcd": pcd(in_gl), "ros.pcd": pcd(in_ros), "world.pcd": pcd(turned),
        "viewpoint.pcd": pcd(points, viewpoint="0 0 0.5 1 0 0 0"), "old.pcd": pcd(points, version="0.5"),
        "two.pcd": pcd(points, viewpoint="0 0 0 2 0 0 0"),
        "mirrored.pcd": pcd([(-x, y, z) for x, y, z in points]), "twisted.pcd": pcd([(y, -x, z) for x, y, z in points]),
        "lidar.pcd": pcd(lidar), "lidar_normals.pcd": pcd(lidar, normals=toward),
        "away.pcd": pcd(points, normals=away, **one_row), "points.ply": ply(points, toward), "bare.ply": ply(points),
        "turned.ply": ply(points, [[-c for c in n] if k % 3 == 0 else n for k, n in enumerate(toward)]),
        "zero.ply": ply(points, none), "far_point.ply": ply([*points, (1e7, 0, 0)], [*toward, (0, 0, -1)]),
        "coarse.ply": binary_ply([(x + 1e5, y, z) for x, y, z in points], toward),
        "digits.ply": ply([(x + 1e5, y, z) for x, y, z in points], toward, "double", 6),
        "coded.ply": ply(points, [((x + 1) / 2, (y + 1) / 2, (z + 1) / 2) for x, y, z in toward]),
        "points.xyz": ply(points, toward).split("end_header\n")[1],
        "double.ply": ply([(x + 1e5, y, z) for x, y, z in points], toward, "double"),
    }
    write_all(folder, files)


def write_cameras(folder):
    one = {"fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5}
    files = {
        "four.txt": "60 60 31.5 23.5\n", "matrix.txt": "60 0 31.5\n0 60 23.5\n0 0 1\n", "five.txt": "60 60 31.5 23.5 0\n",
        "none.json": json.dumps({"name": "camera"}), "one.json": json.dumps(one),
        "K.json": json.dumps({"K": [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]}),
        "camera_matrix.json": json.dumps({"camera_matrix": {"data": [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]}}),
        "intrinsic_matrix.json": json.dumps({"intrinsic_matrix": [60, 0, 0, 0, 60, 0, 31.5, 23.5, 1]}),
        "both.json": json.dumps({"K": [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1], "P": [61, 0, 31.5, 0, 0, 61, 23.5, 0, 0, 0, 1, 0]}),
        "region.json": json.dumps({"width": 128, "height": 96, "K": [60, 0, 63.5, 0, 60, 47.5, 0, 0, 1],
                                   "roi": {"x_offset": 32, "y_offset": 24, "width": WIDTH, "height": HEIGHT}}),
        "shape.json": json.dumps({"width": 100, "height": 96, **one}),
        "several.json": json.dumps({"left": one, "right": {**one, "fx": 61}}),
        "complex.npy": depth_files.npy(METRES).replace(b"<f4", b"<c8"),
        "two_poses.txt": "0 0 0 0 0 0 1\n0 0 0.5 0 0 0 1\n", "one_pose.txt": "0 0 0 0 0 0 1\n",
        "mirror.txt": "1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n",
    }
    write_all(folder, files)


def write_poses(folder):
    """All poses that are sound put the small cube at 0.95 m before the camera."""
    pose = "0 0 0.95 0 0 0 1"
    matrix = "1 0 0 0\n0 1 0 0\n0 0 1 0.95\n0 0 0 1\n"
    files = {
        "poses.txt": pose + "\n", "timed.txt": f"0 {pose}\n1 {pose}\n", "back.txt": f"1 {pose}\n0 {pose}\n",
        "some_timed.txt": f"0 {pose}\n{pose}\n", "matrix_pose.txt": matrix, "none.txt": "# none\n",
        "five_of_pose.txt": "0 0 0.95 0 0\n", "nine.txt": "0 0 0.95 0 0 0 1 0 0\n", "comma.txt": "0,0,,0.95,0,0,0,1\n",
        "long.txt": "0,0,0.95,0,0,0,2\n", "wxyz.txt": "0 0 0.95 1 0 0 0\n",
        "header.txt": "# tx ty tz qw qx qy qz\n0 0 0.95 1 0 0 0\n", "header_six.txt": "# tx ty tz qw qx qy qz\n0 0 0.95 1 0 0\n",
        "pose.jsonl": '{"pose": [0, 0, 0.95, 0, 0, 0, 1]}\n',
        "list.jsonl": "[0, 0, 0.95, 0, 0, 0, 1]\n", "nameless.jsonl": '{"place": [0, 0, 0.95, 0, 0, 0, 1]}\n',
        "poses_mm.txt": "0 0 950 0 0 0 1\n", "inverted.txt": "0 0 -0.95 0 0 0 1\n",
        "ms.txt": f"0 {pose}\n2000000 {pose}\n", "still.txt": f"0 {pose}\n0.05 {pose}\n",
        "still_tum.txt": f"1000 {pose}\n1000.05 {pose}\n", "camera_path.txt": 3 * "0 0 0 0 0 0 1\n",
        "camera_two.txt": 2 * "0 0 0 0 0 0 1\n", "list.txt": "0 wall.png\n1 wall.png\n",
        "device.txt": "0 0 0 0.85 0 0 0 1\n0.05 0 0 0.94 0 0 0 1\n",
    }
    write_all(folder, files)


def write_recordings(folder):
    for kind, name in (("numbered", "steps"), ("timed", "tum")):
        subprocess.run([sys.executable, HERE / "frames.py", kind, folder / name, "3"], check=True)
    wall = png(MILLIMETRES)
    files = {
        "bare/readme.txt": "", "named/a.png": wall, "named/b.png": wall, "twice/1.png": wall, "twice/01.png": wall,
        "plain/1.png": wall, "plain/2.png": wall, "plain/3.png": wall,
        "scan/depth/1.png": wall,
    }
    for name in ("named", "twice", "bare"):
        (folder / name).mkdir()
    (folder / "plain").mkdir()
    (folder / "scan/depth").mkdir(parents=True)
    write_all(folder, files)
    names = {"named": "a.png", "twice": "1.png"}
    write_all(folder, {f"{name}.txt": f"0 {name}/{file}\n" for name, file in names.items()})


# These tables hold the first bytes of other programs' files, and the advice for each: files that lead to meshes, to scans, to
# either.
MESH_STARTS = {
    b"<mujoco>": "give one of the files that it names", b"ISO-10303-21;": "export a mesh from it",
    b"BLENDER-v300": "export a mesh from it, as OBJ, PLY or STL", b"#usda 1.0\n": "export it as OBJ, PLY or STL",
    b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1": "export a mesh from it", b"3D Geometry File Format": "export a mesh from it",
    b"**ABCDEFGHIJKLM": "export a mesh from it", b"$MeshFormat\n": "export it as OBJ, PLY or STL",
    b"MeshVersionFormatted 2\n": "export it as OBJ, PLY or STL", b"xof 0303txt": "export it as OBJ, PLY or STL",
    b"OCTM\5\0\0\0": "export it as OBJ, PLY or STL", b"<amf>": "export it as OBJ, PLY or STL",
    b'<?xml version="1.0"?>\n<amf>': "export it as OBJ, PLY or STL", b"DBRep_DrawableShape\n": "export a mesh from it",
    b"*Heading\n": "export a mesh from it",
}
SCAN_STARTS = {
    b"\xff\xd8\xff\xe0": "give the 16-bit or float image", b"GIF89a": "give the 16-bit or float image",
    b"\x89HDF\r\n\x1a\n": "save one of its arrays as .npy or 16-bit PNG",
    b"MATLAB 5.0 MAT-file": "save one of its arrays as 16-bit PNG",
    b"MATLAB 7.3 MAT-file": "save one of its arrays as 16-bit PNG",
    b"\x1a\x45\xdf\xa3": "extract its depth images as 16-bit PNG, for example by ffmpeg",
    b"#ROSBAG V2.0": "convert it to MCAP: rosbags-convert --src BAG --dst OUT --dst-storage mcap",
    b"RIFF\x10\0\0\0WEBP": "give the 16-bit or float image", b"#?RADIANCE\n": "give the 16-bit or float image",
    b"P7\nWIDTH 64\n": "save it as PGM, or as 16-bit PNG", b"\x80\x04\x95\x10": "save its array as .npy",
    b"160&120&1&": "save its depths as .npy, PFM or 16-bit PNG", b"PIEH": "save its depths as .npy, PFM or 16-bit PNG",
    b"SQLite format 3\0": "convert the bag's folder to MCAP: rosbags-convert --src FOLDER --dst OUT --dst-storage mcap",
    b"LASF": "convert it to PLY with normals, for example by PDAL",
    b"ASTM-E57": "convert it to PLY with normals, for example by PDAL",
}
OTHER_STARTS = {
    b"<!DOCTYPE html>": "download the file itself", b"<html>": "download the file itself",
    b"# vtk DataFile Version 3.0\n": "export it as PLY", b"<VTKFile>": "export it as PLY",
    b"DRACO\x02\x02": "decode it to PLY: draco_decoder", b"\x28\xb5\x2f\xfd": "unpack it first: unzstd",
    b"\x04\x22\x4d\x18": "unpack it first: unlz4",
    b"%PDF-1.7": "give the file that was meant", b"7z\xbc\xaf\x27\x1c": "unpack it first: 7z x",
    b"version https://git-lfs.github.com/spec/v1\n": "fetch it with: git lfs pull",
    b'<?xml version="1.0"?>\n<VTKFile/>': "export it as PLY",
    b'<?xml version="1.0"?>\n<svg/>': "give the file that was meant", b"\xff\xfev\0": "save it as UTF-8",
}
STARTS = {**MESH_STARTS, **SCAN_STARTS, **OTHER_STARTS}


def write_all(folder, files):
    for name, content in files.items():
        (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)


def write(folder):
    write_meshes(folder)
    write_images(folder)
    write_clouds(folder)
    write_cameras(folder)
    write_poses(folder)
    write_recordings(folder)
    write_all(folder, {"arm.urdf": (pathlib.Path(__file__).parent / "inputs/arm.urdf").read_bytes()})
    write_all(folder, {f"start{k}": start + b" " * 40 for k, start in enumerate(STARTS)})
