#!/usr/bin/env python3
"""Writes small valid inputs for every fuzz target: make_seeds.py FOLDER.

Each target gets a folder of its name. The containers are those of formats/golden; everything else
is made here, of one cube and one image of 8 x 6 pixels. The same files come out every time.
"""
import pathlib
import shutil
import struct
import sys
import zlib

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(SOURCE / "tests/tools"))
import mcap_writer  # noqa: E402
import scene_files  # noqa: E402

VERTICES = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
TRIANGLES = [t for a, b, c, d in QUADS for t in ((a, b, c), (a, c, d))]
WIDTH, HEIGHT = 8, 6
MILLIMETRES = [1000 + 3 * u + 5 * v for v in range(HEIGHT) for u in range(WIDTH)]
METRES = [value / 1000 for value in MILLIMETRES]


def meshes():
    vertices = "".join("v %g %g %g\n" % v for v in VERTICES)
    quads = "".join("f %d %d %d %d\n" % tuple(k + 1 for k in q) for q in QUADS)
    triangles = "".join("f %d/1/1 %d//2 -1 %d\n" % (a + 1, b + 1, c + 1)
                        for a, b, c in TRIANGLES)
    open_box = vertices + "".join(line + "\n" for line in quads.splitlines()[:-1])
    yield "obj/quads", vertices + quads
    yield "obj/habits", "# x\r\nmtllib a\r\no b\n" + vertices + "vt 0 0\nvn 0 0 1\n" + triangles
    yield "solid/sound", "\x00" + vertices + quads
    yield "solid/hole", "\x01" + open_box
    yield "solid/voxel", "\x02" + open_box
    yield "solid/flood", "\x03" + open_box
    yield "solid/weld", "\x04" + vertices + quads
    rows = "".join("%g %g %g\n" % v for v in VERTICES)
    faces = "".join("4 %d %d %d %d\n" % q for q in QUADS)
    yield "off/text", "OFF\n8 6 0\n" + rows + faces
    yield "off/colours", "COFF 8 6 0\n" + "".join(
        "%g %g %g 255 0 0 255\n" % v for v in VERTICES) + faces
    binary = struct.pack(">III", 8, 12, 18) + b"".join(struct.pack(">fff", *v) for v in VERTICES)
    binary += b"".join(struct.pack(">IIIII", 3, *t, 0) for t in TRIANGLES)
    yield "off/binary", b"OFF BINARY\n" + binary
    head = ("ply\nformat %s 1.0\ncomment x\nelement vertex 8\nproperty float x\nproperty float y\n"
            "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n")
    yield "ply/text", head % "ascii" + rows + faces
    for order, sign in (("little", "<"), ("big", ">")):
        body = b"".join(struct.pack(sign + "fff", *v) for v in VERTICES)
        body += b"".join(struct.pack(sign + "Biiii", 4, *q) for q in QUADS)
        yield "ply/" + order, (head % f"binary_{order}_endian").encode() + body
    yield "stl/text", "solid a\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % VERTICES[k] for k in t)
        + "endloop\nendfacet\n" for t in TRIANGLES) + "endsolid a\n"
    yield "stl/binary", b" " * 80 + struct.pack("<I", 12) + b"".join(
        struct.pack("<3f9fH", 0, 0, 0, *(c for k in t for c in VERTICES[k]), 0) for t in TRIANGLES)
    yield "om/double", open_mesh(VERTICES, TRIANGLES, "d", 1)
    yield "om/float", open_mesh(VERTICES, QUADS, "f", 0)


def open_mesh(vertices, faces, real, bits):
    """Returns OpenMesh's own format: positions, half-edges (next, to, face), vertices, faces."""
    edges, halfedge = [], {}
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1]):
            if (b, a) not in halfedge:
                edges.append((a, b))
                halfedge[a, b], halfedge[b, a] = 2 * len(edges) - 2, 2 * len(edges) - 1
    follows, owner = {}, {}
    for number, face in enumerate(faces):
        corners = list(face)
        for k, a in enumerate(corners):
            b, c = corners[(k + 1) % len(corners)], corners[(k + 2) % len(corners)]
            follows[halfedge[a, b]] = halfedge[b, c]
            owner[halfedge[a, b]] = number
    def chunk(entity, kind, signed, is_float, dimensions, size):
        return struct.pack("<H", entity << 2 | kind << 5 | signed << 9 | is_float << 10
                           | (dimensions - 1) << 11 | size << 14)
    topology = 7
    out = struct.pack("<3sBIII", b"OMP", 0x42, len(vertices), len(faces), len(edges))
    out += chunk(0, 0, 1, 1, 3, bits) + b"".join(struct.pack("<3" + real, *v) for v in vertices)
    out += chunk(6, topology, 1, 0, 1, 0)
    for k, (a, b) in enumerate(edges):
        out += struct.pack("<6b", follows[2 * k], b, owner[2 * k],
                           follows[2 * k + 1], a, owner[2 * k + 1])
    out += chunk(0, topology, 1, 0, 1, 0) + bytes(
        next(h for (a, _), h in halfedge.items() if a == v) for v in range(len(vertices)))
    out += chunk(2, topology, 1, 0, 1, 0) + bytes(
        halfedge[face[0], face[1]] for face in faces)
    return out + struct.pack("<H", 7 << 2)


def png(values):
    def part(name, data):
        body = name + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))
    rows = b"".join(b"\0" + struct.pack(">%dH" % WIDTH, *values[v * WIDTH:(v + 1) * WIDTH])
                    for v in range(HEIGHT))
    return (b"\x89PNG\r\n\x1a\n" + part(b"IHDR", struct.pack(">IIBBBBB", WIDTH, HEIGHT, 16, 0, 0, 0, 0))
            + part(b"IDAT", zlib.compress(rows, 9)) + part(b"IEND", b""))


def exr(compression, rows_per_chunk):
    """Returns an OpenEXR image of one float channel Z; compression 0 or 3 (ZIP)."""
    def attribute(name, kind, value):
        return name + b"\0" + kind + b"\0" + struct.pack("<I", len(value)) + value
    window = struct.pack("<4i", 0, 0, WIDTH - 1, HEIGHT - 1)
    head = struct.pack("<II", 20000630, 2)
    head += attribute(b"channels", b"chlist", b"Z\0" + struct.pack("<IIII", 2, 0, 1, 1) + b"\0")
    head += attribute(b"compression", b"compression", bytes([compression]))
    head += attribute(b"dataWindow", b"box2i", window) + attribute(b"displayWindow", b"box2i", window)
    head += attribute(b"lineOrder", b"lineOrder", b"\0")
    head += attribute(b"pixelAspectRatio", b"float", struct.pack("<f", 1))
    head += attribute(b"screenWindowCenter", b"v2f", bytes(8))
    head += attribute(b"screenWindowWidth", b"float", struct.pack("<f", 1)) + b"\0"
    chunks = []
    for v in range(0, HEIGHT, rows_per_chunk):
        row = METRES[v * WIDTH:(v + rows_per_chunk) * WIDTH]
        data = struct.pack("<%df" % len(row), *row)
        if compression == 3:
            split = data[0::2] + data[1::2]
            differences = split[:1] + bytes((b - a + 128) & 255 for a, b in zip(split, split[1:]))
            packed = zlib.compress(differences)
            data = packed if len(packed) < len(data) else data
        chunks.append(struct.pack("<ii", v, len(data)) + data)
    table, at = b"", len(head) + 8 * len(chunks)
    for chunk in chunks:
        table += struct.pack("<Q", at)
        at += len(chunk)
    return head + table + b"".join(chunks)


def tiff(values, code, bits, sample_format, compression=1):
    data = struct.pack("<%d%s" % (len(values), code), *values)
    if compression == 8:
        data = zlib.compress(data)
    tags = [(256, WIDTH), (257, HEIGHT), (258, bits), (259, compression), (262, 1), (273, 8),
            (277, 1), (278, HEIGHT), (279, len(data)), (339, sample_format)]
    directory = struct.pack("<H", len(tags)) + b"".join(
        struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags) + bytes(4)
    data += bytes(len(data) % 2)
    return b"II*\0" + struct.pack("<I", 8 + len(data)) + data + directory


def npy(kind, shape, data):
    """Returns an array of NumPy whose values are these bytes."""
    header = "{'descr': '%s', 'fortran_order': False, 'shape': (%s,), }" % (kind, ", ".join(map(str, shape)))
    header += " " * (117 - len(header)) + "\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header.encode() + data


def images():
    yield "png/gray", png(MILLIMETRES)
    yield "exr/plain", exr(0, 1)
    yield "exr/zip", exr(3, 16)
    yield "tiff/integers", tiff(MILLIMETRES, "H", 16, 1)
    yield "tiff/floats", tiff(METRES, "f", 32, 3)
    yield "tiff/deflate", tiff(MILLIMETRES, "H", 16, 1, 8)
    words = " ".join(map(str, MILLIMETRES))
    yield "netpbm/text", f"P2\n# x\n{WIDTH} {HEIGHT}\n65535\n{words}\n"
    yield "netpbm/binary", f"P5 {WIDTH} {HEIGHT} 65535\n".encode() + struct.pack(
        ">%dH" % len(MILLIMETRES), *MILLIMETRES)
    yield "netpbm/floats", f"Pf\n{WIDTH} {HEIGHT}\n-1.0\n".encode() + struct.pack(
        "<%df" % len(METRES), *METRES)
    for name, kind, data in (("floats", "<f4", struct.pack("<48f", *METRES)),
                             ("integers", "<u2", struct.pack("<48H", *MILLIMETRES))):
        yield "npy/" + name, npy(kind, (HEIGHT, WIDTH), data)


def clouds():
    points = [((u - 3.5) / 20 * z, (v - 2.5) / 20 * z, z) for (u, v), z in
              zip(((u, v) for v in range(HEIGHT) for u in range(WIDTH)), METRES)]
    head = ("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z%s\nSIZE 4 4 4%s\nTYPE F F F%s\nCOUNT 1 1 1%s\n"
            "WIDTH 8\nHEIGHT 6\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 48\nDATA %s\n")
    plain = ("", "", "", "")
    normals = (" normal_x normal_y normal_z", " 4 4 4", " F F F", " 1 1 1")
    rows = "".join("%g %g %g\n" % p for p in points)
    yield "pcd/text", head % (plain + ("ascii",)) + rows
    yield "pcd/normals", head % (normals + ("ascii",)) + "".join(
        "%g %g %g 0 0 -1\n" % p for p in points)
    data = b"".join(struct.pack("<3f", *p) for p in points)
    yield "pcd/binary", (head % (plain + ("binary",))).encode() + data
    by_field = b"".join(struct.pack("<f", p[c]) for c in range(3) for p in points)
    literal = b"".join(bytes([len(by_field[k:k + 32]) - 1]) + by_field[k:k + 32]
                       for k in range(0, len(by_field), 32))
    yield "pcd/compressed", (head % (plain + ("binary_compressed",))).encode() + struct.pack(
        "<II", len(literal), len(by_field)) + literal
    ply = ("ply\nformat %s 1.0\nelement vertex 48\n" + "".join(
        f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) + "end_header\n")
    yield "ply_points/text", ply % "ascii" + "".join("%g %g %g 0 0 -1\n" % p for p in points)
    yield "ply_points/binary", (ply % "binary_little_endian").encode() + b"".join(
        struct.pack("<6f", *p, 0, 0, -1) for p in points)


ROS = '{"position": {"x": 0, "y": 0, "z": 1}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}'
POSES = {"three_rows": "1 0 0 0\n0 1 0 0\n0 0 1 1\n\n1 0 0 0\n0 1 0 0\n0 0 1 2\n",
         "print": "[[1. 0. 0. 0.]\n [0. 1. 0. 0.]\n [0. 0. 1. 1.]\n [0. 0. 0. 1.]]\n",
         "list": "[[0,0,1,0,0,0,1],\n [5,0,0,1,0,0,0,1]]\n", "semicolons": "0;0;1;0;0;0;1\n",
         "ros": '{"header": {"stamp": {"sec": 1, "nanosec": 5}}, "pose": ' + ROS + '}\n{"poses": [' + ROS + "]}\n",
         "json": '[0,0,1,0,0,0,1]\n{"time": 1.5, "pose": [0.1,0,1,0,0,0,1]}\n',
         "matrix_json": '{"matrix": [1,0,0,0, 0,1,0,0, 0,0,1,2, 0,0,0,1]}\n',
         "tum": "# time tx ty tz qx qy qz qw\n0.0 0 0 1 0 0 0 1\n0.1 0 0.1 1 0 0 0.6 0.8\n",
         "matrix": "1 0 0 0\n0 1 0 0\n0 0 1 0.5\n0 0 0 1\n",
         "euroc": "#timestamp, p_x, p_y, p_z, q_w, q_x, q_y, q_z\n"
                  "1403636579763555584, 0, 0, 1, 1, 0, 0, 0\n"}
INTRINSICS = {
    "numbers": "525 525 319.5 239.5\n",
    "matrix": "525 0 319.5\n0 525 239.5\n0 0 1\n",
    "ros": "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
           "  data: [525, 0, 319.5, 0, 525, 239.5, 0, 0, 1]\n",
    "open3d": '{"width": 640, "height": 480, "intrinsic_matrix": '
              '[525, 0, 0, 0, 525, 0, 319.5, 239.5, 1]}\n',
    "realsense": '{"width": 640, "height": 480, "fx": 525, "fy": 525, "ppx": 319.5, "ppy": 239.5}\n',
    "bop": '{"0": {"cam_K": [525, 0, 319.5, 0, 525, 239.5, 0, 0, 1], "depth_scale": 0.1}, '
           '"5": {"cam_K": [526, 0, 319.5, 0, 525, 239.5, 0, 0, 1], "depth_scale": 0.1}}\n'}


def texts():
    for name, text in POSES.items():
        yield "poses/" + name, text
        yield "camera_pose/" + name, text.split("\n")[0] if "json" in name else text
    for name, text in INTRINSICS.items():
        yield "intrinsics/" + name, text
    upright = struct.pack("<16f", 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1)
    for target in ("poses", "camera_pose"):
        yield target + "/npy_matrices", npy("<f4", (1, 4, 4), upright)
        yield target + "/utf16", POSES["tum"].encode("utf-16")
    yield "poses/npy_times", npy("<f8", (2, 8), struct.pack("<16d", *[1, 0, 0, 1, 0, 0, 0, 1], *[2, 0, 0, 1, 0, 0, 0, 1]))
    yield "intrinsics/npy", npy("<f8", (3, 3), struct.pack("<9d", 525, 0, 319.5, 0, 525, 239.5, 0, 0, 1))
    yield "intrinsics/utf16", INTRINSICS["numbers"].encode("utf-16")
    yield "config/plain", ('{"input": "a.off", "output": "b", "spheres": 10, "coverage": 0.5, '
                           '"grow": true, "levels": [1, 2], "tool": ["a", "b"]}')
    yield "config/import", ('{"intrinsics": "525,525,319.5,239.5", "camera-pose": "0,0,0,0,0,0,1", '
                            '"depth-scale": 1000, "invalid": "65535,0", "range": "0.1,5", '
                            '"decode": "rotated", "window": 5, "edge-gate": 0.05}')
    for kind, text in enumerate(("0,0,0,0,0,0,1", "0.5%", "cuda:1", "pca", "rotated", "1e-3",
                                 "17", "100", "voxel=12")):
        yield f"options/{kind}", bytes([kind]) + text.encode()
    between = "\n--\n"
    yield "recording/listed", between.join((
        "# list\n0.0 1.png\n0.1 2.png", POSES["tum"], INTRINSICS["matrix"], POSES["matrix"]))
    yield "recording/associated", "0.0 1.png 0.0 2.png\n0.1 2.png 0.1 1.png\n"
    for name, options in {"plain": {"per_chunk": 0, "tf": "base:link"}, "chunks": {"per_chunk": 2, "tool": "/tool"},
                          "lz4": {"compression": "lz4", "order": ">"}, "zstd": {"compression": "zstd", "encoding": "png"}}.items():
        wanted = mcap_writer.Recording()
        wanted.frame = "camera"
        vars(wanted).update(options)
        data = mcap_writer.write(mcap_writer.messages_of_wall(1, wanted), wanted)
        yield "mcap/" + name, data[:-40] if name == "lz4" else data


def packages():
    def mesh(x):
        vertices = "".join('<vertex x="%g" y="%g" z="%g"/>' % (x + v[0], v[1], v[2]) for v in VERTICES)
        return f"<mesh><vertices>{vertices}</vertices><triangles>" + "".join(
            '<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in TRIANGLES) + "</triangles></mesh>"

    def model(objects, items):
        return ('<model unit="millimeter" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06">'
                f"<resources>{objects}</resources><build>{items}</build></model>")
    cube = f'<object id="1" type="model" name="cube">{mesh(0)}</object>'
    item = '<item objectid="1" transform="2 0 0 0 2 0 0 0 2 1 2 3"/>'
    yield "threemf/cube", model(cube, item)
    yield "threemf/support", model(cube + f'<object id="2" type="support">{mesh(3)}</object>', item + '<item objectid="2"/>')
    both = ('<object id="3"><components><component objectid="1"/><component objectid="2" p:path="/3D/Objects/a.model" '
            'transform="1 0 0 0 1 0 0 0 1 5 0 0"/></components></object>')
    other = model(f'<object id="2">{mesh(0)}</object>', "")
    for subtype in ("normal_part", "modifier_part", "negative_part"):
        yield f"threemf/{subtype}", "\n--\n".join((
            model(cube + both, '<item objectid="3"/>'), other,
            f'<config><object id="3"><part id="1" subtype="normal_part"/><part id="2" subtype="{subtype}"/></object></config>'))
    yield "threemf/volumes", "\n--\n".join((
        model(cube, item), other, "<config/>",
        '<config><object id="1"><volume firstid="0" lastid="5"><metadata type="volume" key="volume_type" '
        'value="ParameterModifier"/></volume></object></config>'))


def containers():
    for path in sorted((SOURCE / "formats/golden/v1").glob("*.vpm?")):
        yield f"{path.suffix[1:]}/{path.stem}", path.read_bytes()
        yield f"container/{path.name}", path.read_bytes()


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "scene").mkdir(parents=True)
    scene_files.write_all(folder / "scene")
    for make in (meshes, packages, images, clouds, texts, containers):
        for name, content in make():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content.encode("latin-1") if isinstance(content, str) else content)


if __name__ == "__main__":
    main()
