#!/usr/bin/python3
"""Tells what a page of vpm-query --view shows: title and points of view, meshes, and where each body is at each step.

usage: page_bodies.py PAGE.html
"""
import base64
import json
import struct
import sys

with open(sys.argv[1]) as file:
    page = file.read()
document = json.JSONDecoder().raw_decode(page, page.index("{", page.index('id="data"')))[0]
print(document["title"], "|", *document["views"])
print(", ".join(layer["name"] for layer in document["layers"] if layer["type"] == "mesh"))
for body in document["bodies"]:
    data = base64.b64decode(body["poses"]["data"])
    numbers = struct.unpack(f"<{len(data) // 4}f", data)
    places = [[round(x, 3) + 0 for x in numbers[k:k + 3]] for k in range(0, len(numbers), 7)]
    print("tool" if body["is_tool"] else "solid", body["name"], *places)
