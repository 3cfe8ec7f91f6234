#!/usr/bin/env python3
"""Writes a cube of edge 1 m as COLLADA, glTF, GLB, 3MF and FBX, in units and with transforms of nodes that give this edge.

    scene_files.py FOLDER

Two nodes stand in two.dae and two.glb: the cube as `body`, and one of half the edge, 3 m beside it, as `tip`.
"""
import base64
import json
import pathlib
import struct
import sys
import zipfile

VERTICES = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
TRIANGLES = [t for a, b, c, d in FACES for t in ((a, b, c), (a, c, d))]


def text_of(numbers):
    return " ".join(f"{n:g}" for n in numbers)


def dae(nodes, edge, unit, up):
    """nodes: name and 16 numbers of the matrix, row by row."""
    positions = text_of(edge * c for v in VERTICES for c in v)
    indices = text_of(k for face in FACES for k in face)
    placed = "".join(f'<node id="{name}" name="{name}"><matrix>{text_of(m)}</matrix><instance_geometry url="#g"/></node>'
                     for name, m in nodes)
    return f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="pa" count="24">{positions}</float_array><technique_common>
<accessor source="#pa" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4 4 4 4 4 4</vcount><p>{indices}</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s" name="s">{placed}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def gltf(nodes, edge):
    """Returns the JSON and the buffer. nodes: name, scale, translation."""
    buffer = b"".join(struct.pack("<3f", *(edge * c for c in v)) for v in VERTICES)
    buffer += b"".join(struct.pack("<3H", *t) for t in TRIANGLES)
    content = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}],
        "nodes": [{"name": n, "mesh": 0, "scale": [s] * 3, "translation": list(t)} for n, s, t in nodes],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0] * 3, "max": [edge] * 3},
                      {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
        "buffers": [{"byteLength": len(buffer)}],
    }
    return content, buffer


def glb_of(content, buffer):
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(buffer), 0x004E4942) + buffer
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def glb(nodes, edge):
    return glb_of(*gltf(nodes, edge))


def threemf(path, edge, name="3D/3dmodel.model", unit=' unit="millimeter"'):
    vertices = "".join('<vertex x="%g" y="%g" z="%g"/>' % tuple(edge * c for c in v) for v in VERTICES)
    triangles = "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in TRIANGLES)
    model = ('<?xml version="1.0" encoding="UTF-8"?><model' + unit + ' xml:lang="en-US" '
             'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1" type="model"><mesh>'
             f'<vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh></object></resources>'
             '<build><item objectid="1"/></build></model>')
    with zipfile.ZipFile(path, "w") as archive:
        def add(name, text):
            archive.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)  # without the time of day

        add("[Content_Types].xml", '<?xml version="1.0" encoding="UTF-8"?><Types '
                         'xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" '
                         'ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" '
                         'ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>')
        add("_rels/.rels", '<?xml version="1.0" encoding="UTF-8"?><Relationships '
                         'xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship '
                         f'Target="/{name}" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"'
                         '/></Relationships>')
        add(name, model)


def fbx(edge, unit_in_cm):
    positions = ",".join(f"{edge * c:g}" for v in VERTICES for c in v)
    indices = ",".join(str(k if i < 3 else -1 - k) for face in FACES for i, k in enumerate(face))
    return f"""; FBX 7.3.0 project file
FBXHeaderExtension:  {{
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}}
GlobalSettings:  {{
	Version: 1000
	Properties70:  {{
		P: "UpAxis", "int", "Integer", "",2
		P: "UnitScaleFactor", "double", "Number", "",{unit_in_cm}
	}}
}}
Objects:  {{
	Geometry: 10, "Geometry::cube", "Mesh" {{
		Vertices: *24 {{
			a: {positions}
		}}
		PolygonVertexIndex: *24 {{
			a: {indices}
		}}
		GeometryVersion: 124
	}}
	Model: 20, "Model::cube", "Mesh" {{
		Version: 232
		Properties70:  {{
			P: "Lcl Scaling", "Lcl Scaling", "", "A",2,2,2
		}}
	}}
}}
Connections:  {{
	C: "OO",20,0
	C: "OO",10,20
}}
"""


def quantized_glb(edge):
    """Returns a cube of positions in signed bytes (KHR_mesh_quantization), as optimisers write them."""
    points = b"".join(struct.pack("<4b", *(127 if c else -127 for c in v), 0) for v in VERTICES)
    corners = b"".join(struct.pack("<3H", *t) for t in TRIANGLES)
    content = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
        "nodes": [{"mesh": 0, "scale": [edge / 2] * 3, "translation": [edge / 2] * 3}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5120, "normalized": True, "count": len(VERTICES), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3 * len(TRIANGLES), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(points), "byteStride": 4},
                        {"buffer": 0, "byteOffset": len(points), "byteLength": len(corners)}],
        "buffers": [{"byteLength": len(points + corners)}]}
    return glb_of(content, points + corners)


def instanced_glb(edge, places):
    """Returns cubes at places (EXT_mesh_gpu_instancing)."""
    content, buffer = gltf([("body", 1, (0, 0, 0))], edge)
    added = b"".join(struct.pack("<3f", *place) for place in places)
    content["bufferViews"].append({"buffer": 0, "byteOffset": len(buffer), "byteLength": len(added)})
    content["accessors"].append({"bufferView": len(content["bufferViews"]) - 1, "componentType": 5126, "count": len(places),
                                 "type": "VEC3"})
    content["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": len(content["accessors"]) - 1}}}
    content["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    content["buffers"] = [{"byteLength": len(buffer + added)}]
    return glb_of(content, buffer + added)


def write_all(folder):
    same = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]
    half = [1, 0, 0, 3000, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
    (folder / "cube.dae").write_text(dae([("body", same)], 500, 0.001, "Z_UP"))
    (folder / "two.dae").write_text(dae([("body", same), ("tip", half)], 500, 0.001, "Y_UP"))
    content, buffer = gltf([("body", 2, (0, 0, 0))], 0.5)
    (folder / "beside.bin").write_bytes(buffer)
    (folder / "beside.gltf").write_text(json.dumps({**content, "buffers": [{"byteLength": len(buffer), "uri": "beside.bin"}]}))
    inline = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    (folder / "cube.gltf").write_text(json.dumps({**content, "buffers": [{"byteLength": len(buffer), "uri": inline}]}))
    (folder / "cube.glb").write_bytes(glb([("body", 2, (0, 0, 0))], 0.5))
    (folder / "quantized.glb").write_bytes(quantized_glb(1))
    (folder / "instances.glb").write_bytes(instanced_glb(1, [(0, 0, 0), (2, 0, 0)]))
    (folder / "two.glb").write_bytes(glb([("body", 2, (0, 0, 0)), ("tip", -1, (3, 0, 0))], 0.5))
    threemf(folder / "cube.3mf", 1000)
    threemf(folder / "metre.3mf", 1, unit=' unit="meter"')
    threemf(folder / "inch.3mf", 1 / 0.0254, unit=" unit = 'inch'")
    threemf(folder / "none.3mf", 1000, unit="")
    threemf(folder / "mile.3mf", 1, unit=' unit="mile"')
    threemf(folder / "spelled.3mf", 1000, "3D/3DModel.model")  # as some programs spell it
    (folder / "cube.fbx").write_text(fbx(5, 10))


if __name__ == "__main__":
    write_all(pathlib.Path(sys.argv[1]))
