#!/usr/bin/env python3
"""Reads the golden files by formats/*.md alone, and compares with the content listed beside them. Shares
no code with libvpm, so it shows that the specification suffices to write a reader.
"""
import json
import pathlib
import struct
import sys

GOLDEN = pathlib.Path(__file__).resolve().parents[2] / "formats" / "golden" / "v1"


def read_container(data):
    magic, version, kind, required, _, size, chunks, header_size, reserved, _, _ = struct.unpack(
        "<8sIIIIQIIQQQ", data[:64])
    assert magic == b"\x89VPM\r\n\x1a\n" and version == 1 and required == 0 and reserved == 0
    assert size == len(data)
    table_end = 64 + 40 * chunks
    end = table_end + header_size
    header = json.loads(data[table_end:end])
    found = {}
    for k in range(chunks):
        name, index, element, zero, offset, length, _ = struct.unpack(
            "<4sIIIQQQ", data[64 + 40 * k:104 + 40 * k])
        assert zero == 0 and offset == -(-end // 64) * 64 and not any(data[end:offset])
        end = offset + length
        found[name.decode(), index] = (element, data[offset:end])
    assert end == len(data)
    return kind, header, found


def records(chunk, layout):
    element, data = chunk
    assert element == struct.calcsize("<" + layout), (element, layout)
    return [list(values) for values in struct.iter_unpack("<" + layout, data)]


def flat(chunk, letter):
    return [value for value, in records(chunk, letter)]


def read_packing(header, chunks):
    return {"spheres": records(chunks["SPHR", 0], "4d"),
            "vertices": records(chunks["VERT", 0], "3d"),
            "triangles": records(chunks["TRIA", 0], "3I"),
            "provenance": header["provenance"]}


def read_level(record, chunks, k):
    epsilon, x, y, z, cell, nx, ny, nz, bridges, components, count = record
    level = {
        "epsilon": epsilon, "bridges": bridges, "components_before": components,
        "sphere_count": count,
        "graph": {"begin": flat(chunks["EDGB", k], "I"),
                  "neighbors": flat(chunks["EDGN", k], "I")},
        "hierarchy": {
            "nodes": [{"bound": n[:4], "begin": n[4], "end": n[5], "children_are_leaves": n[6]}
                      for n in records(chunks["NODE", k], "4d4I")],
            "leaves": flat(chunks["LEAF", k], "I")},
        "grid": {"low": [x, y, z], "cell": cell, "size": [nx, ny, nz],
                 "begin": flat(chunks["GRDB", k], "I"),
                 "spheres": flat(chunks["GRDS", k], "I")},
        "share_volume": flat(chunks["SHRV", k], "d"),
        "share_centroid": records(chunks["SHRC", k], "3d"),
        "share_reach": flat(chunks["SHRR", k], "d"),
        "block_begin": flat(chunks["BLKB", k], "I"),
        "blocks": [{"center": b[:3], "radius": b[3], "begin": b[4], "end": b[5]}
                   for b in records(chunks["BLCK", k], "4f2I")],
        "samples": [{"center": s[:3], "radius": s[3], "weight": s[4]}
                    for s in records(chunks["SMPL", k], "4fd")]}
    if ("SMPF", k) in chunks:
        level["faces"] = [{"sample": f[0], "axis": f[1:4], "toward": f[4], "away": f[5],
                           "along": f[6], "across": f[7]}
                          for f in records(chunks["SMPF", k], "I7f")]
    return level


def read_tool_model(header, chunks):
    (volume, x, y, z, reach), = records(chunks["TOOL", 0], "5d")
    levels = records(chunks["LEVL", 0], "5d6I")
    model = {"volume": volume, "center_of_mass": [x, y, z], "reach": reach,
             "solid_hash": header["solid_hash"],
             "spheres": records(chunks["SPHR", 0], "4d"),
             "levels": [read_level(record, chunks, k) for k, record in enumerate(levels)],
             "provenance": header["provenance"]}
    if ("CALB", 0) in chunks:
        model["calibration"] = [{"mean": e[0], "p95": e[1], "worst": e[2]}
                                for e in records(chunks["CALB", 0], "3d")]
    if ("SRFV", 0) in chunks:
        model["surface"] = {"vertices": records(chunks["SRFV", 0], "3d"),
                            "triangles": records(chunks["SRFT", 0], "3I")}
    return model


def read_cloud(header, chunks):
    cloud = {"origin": records(chunks["ORIG", 0], "3d")[0],
             "positions": records(chunks["POSN", 0], "3f"),
             "normals": records(chunks["NRML", 0], "3f"),
             "radii": flat(chunks["RADI", 0], "f"),
             "provenance": header["provenance"]}
    if ("CAMR", 0) in chunks:
        camera, = records(chunks["CAMR", 0], "16d2I")
        cloud["pixels"] = flat(chunks["PIXL", 0], "I")
        cloud["camera"] = {"fx_fy_cx_cy": camera[:4],
                           "rotation": [camera[4:7], camera[7:10], camera[10:13]],
                           "translation": camera[13:16],
                           "width": camera[16], "height": camera[17]}
        cloud["depth"] = flat(chunks["DPTH", 0], "f")
    return cloud


def main():
    readers = {1: read_packing, 2: read_tool_model, 3: read_cloud}
    compared = 0
    for listing in sorted(GOLDEN.glob("*.json")):
        kind, header, chunks = read_container(listing.with_suffix("").read_bytes())
        assert header["unit"] == "m"
        if readers[kind](header, chunks) != json.loads(listing.read_text()):
            sys.exit(f"{listing.stem}: the content differs from {listing.name}")
        compared += 1
    print(f"{compared} golden files read as the specification says")
    sys.exit(0 if compared else 1)


if __name__ == "__main__":
    main()
