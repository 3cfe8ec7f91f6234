# vpm-pack reads COLLADA, glTF, 3MF and FBX, in metres and with the transforms of nodes.

$ python3 $SOURCE/tests/tools/scene_files.py .
$ for f in cube.dae cube.gltf beside.gltf cube.glb cube.3mf cube.fbx; do vpm-pack $f --spheres 5 --report - | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["mesh"]["format"], r["mesh"]["triangles"], round(r["volume_mesh"], 5))'; done
COLLADA 12 1.0
glTF 12 1.0
glTF 12 1.0
glTF 12 1.0
3MF 12 1.0
FBX 12 1.0
2> vpm-pack: note: cube.dae: its unit of 0.001 m was applied; transforms of nodes were applied; z is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: cube.gltf: its coordinates are metres; transforms of nodes were applied; y is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: beside.gltf: its coordinates are metres; transforms of nodes were applied; y is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: cube.glb: its coordinates are metres; transforms of nodes were applied; y is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: cube.3mf: its unit is taken to be 0.001 m, the millimeter that the file names; transforms of nodes were applied; z is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: cube.fbx: its unit is taken to be 0.1 m, as the file says; transforms of nodes were applied; z is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
$ for f in cube.dae cube.glb cube.3mf spelled.3mf; do vpm-pack - --spheres 5 --report - --quiet < $f | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["mesh"]["format"], round(r["volume_mesh"], 5))'; done
COLLADA 1.0
glTF 1.0
3MF 1.0
3MF 1.0
$ for f in metre inch none mile; do vpm-pack $f.3mf --spheres 5 --report - | python3 -c 'import json, sys; r = json.loads(sys.stdin.read() or "{}"); print(round(r["volume_mesh"], 3) if r else "none")'; done
1.0
1.0
1.0
none
2> vpm-pack: note: metre.3mf: its unit is taken to be 1 m, the meter that the file names; transforms of nodes were applied; z is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: inch.3mf: its unit is taken to be 0.0254 m, the inch that the file names; transforms of nodes were applied; z is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: none.3mf: its unit is taken to be 0.001 m, which 3MF has by default; transforms of nodes were applied; z is up, as in the file
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: error: mile.3mf: its unit 'mile' is none of 3MF: micron, millimeter, centimeter, inch, foot or meter
[1]

# Positions of integers and instances of glTF are read.
$ for f in quantized instances; do vpm-pack $f.glb --spheres 5 --quiet --report - | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["mesh"]["shells"], round(r["volume_mesh"], 5), [round(c, 5) for c in r["mesh"]["box_high"]])'; done
1 1.0 [1.0, 1.0, 1.0]
2 2.0 [3.0, 1.0, 1.0]

# Several nodes are joined, or one is chosen.
$ for f in two.dae two.glb; do vpm-pack $f --spheres 5 --report - | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["mesh"]["shells"], round(r["volume_mesh"], 5))'; done
2 1.125
2 1.125
2> vpm-pack: note: two.dae: its unit of 0.001 m was applied; transforms of nodes were applied; y is up, as in the file
2> vpm-pack: note: two.dae: the meshes of 2 nodes are joined: body, tip; --node chooses one
2> vpm-pack: note: 5 spheres fill 55 % of a solid of 3.5 x 1 x 1 m
2> vpm-pack: note: two.glb: its coordinates are metres; transforms of nodes were applied; y is up, as in the file
2> vpm-pack: note: two.glb: the meshes of 2 nodes are joined: body, tip; --node chooses one
2> vpm-pack: note: 5 spheres fill 55 % of a solid of 3 x 1.5 x 1.5 m
$ for f in two.dae two.glb; do vpm-pack $f --node tip --spheres 5 --report - --quiet | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["mesh"]["shells"], round(r["volume_mesh"], 5))'; done
1 0.125
1 0.125
$ vpm-pack two.dae --node hand -o x.vpmp
2> vpm-pack: error: two.dae: it has no node 'hand'; nodes with faces: body, tip
[1]
$ vpm-pack two.dae --node tip -o tip.vpmp --spheres 9 --quiet && vpm-graph tip.vpmp --mesh two.dae -o tip.vpmg --quiet && echo made
made
$ printf 'v 0 0 0\nf 1 1 1\n' > a.obj && vpm-pack a.obj --node tip -o x.vpmp
2> vpm-pack: error: a.obj: OBJ has no nodes; leave --node out
[2]
$ head -c 500 cube.glb > cut.glb && vpm-pack cut.glb -o x.vpmp
2> vpm-pack: error: cut.glb: assimp cannot read this glTF file, which is damaged or of a version that it does not know; save it again, or as OBJ, PLY or STL
[1]
