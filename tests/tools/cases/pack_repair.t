# vpm-pack --repair: meshes that are not closed.

$ printf 'OFF\n8 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n' > open.off
$ vpm-pack open.off -o open.vpmp
2> vpm-pack: error: open.off: the mesh is open: 4 edges of one triangle in 1 hole, a loop through (0, 1, 0); give --repair to fill planar and small holes
[1]
$ vpm-pack open.off --repair --spheres 1 -o filled.vpmp --report filled.json
2> vpm-pack: note: open.off: filled a planar hole of 4 edges about (0, 0.5, 0.5)
2> vpm-pack: note: 1 sphere fills 52.4 % of a solid of 1 x 1 x 1 m
$ $VALIDATE pack-report filled.json
$ python3 -c 'import json; r = json.load(open("filled.json")); print(r["volume_mesh"], round(r["r_max"], 9), r["mesh"]["filled_holes"])'
1.0 0.5 [{'center': [0.0, 0.5, 0.5], 'edges': 4, 'planar': True, 'size': 1.4142135623730951}]
$ vpm-pack open.off --repair holes --spheres 1 --quiet -o - | cmp - filled.vpmp

$ vpm-pack open.off --repair voxel=20 --spheres 1 --report voxel.json
2> vpm-pack: note: open.off: a new surface from voxels of 0.05 m: at most * (glob)
2> vpm-pack: note: 1 sphere fills 52.8 % of a solid of 1 x 1 x 1 m
$ $VALIDATE pack-report voxel.json
$ python3 -c 'import json; m = json.load(open("voxel.json"))["mesh"]; v = m["voxel_repair"]; print(m["shells"], m["euler_characteristic"], v["voxel"], v["hausdorff_distance"] > v["voxel"])'
1 2 0.05 True

# A configuration names the mode; without one nothing is repaired.
$ vpm-pack open.off --repair --dump-config > config.json && $VALIDATE config.vpm-pack config.json && grep repair config.json
  "repair": "holes",
$ vpm-pack --config config.json open.off --spheres 1 --quiet --report - | grep -c '"planar": true'
1
$ vpm-pack --dump-config | grep -c repair
0
[1]

# A word after --repair is its mode if it is one of the modes, and the mesh otherwise.
$ vpm-pack --repair open.off --spheres 1 --quiet -o - | cmp - filled.vpmp
$ vpm-pack --spheres 1 --quiet -o - open.off --repair | cmp - filled.vpmp
$ vpm-pack --repair=holes open.off --spheres 1 --quiet -o - | cmp - filled.vpmp
$ vpm-pack --repair voxel open.off --spheres 1 --quiet --report - | grep -c voxel_repair
1
$ vpm-pack --repair=open.off open.off -o open.vpmp
2> vpm-pack: error: --repair: 'open.off' is none of holes, voxel, voxel=RES, flood and flood=RES
[2]
$ vpm-pack open.off --repair foo -o open.vpmp
2> vpm-pack: error: --repair: 'foo' is none of holes, voxel, voxel=RES, flood and flood=RES
[2]
$ vpm-pack open.off --repair voxel=1 -o open.vpmp
2> vpm-pack: error: repair: the voxels along the longest side must lie between 8 and 1024
[2]
$ vpm-pack open.off --repair voxel=1e3 -o open.vpmp
2> vpm-pack: error: --repair: 'voxel=1e3' is none of holes, voxel, voxel=RES, flood and flood=RES
[2]

# Holes are closed up to a width, by winding number or by a flood from outside.
$ vpm-pack open.off --repair voxel=20 --max-hole 0.5 -o open.vpmp
2> vpm-pack: error: open.off: a hole is 1 m wide, more than 0.5 m, through (0, 1, 0); close it, or give a wider --max-hole
[1]
$ vpm-pack open.off --repair flood -o open.vpmp
2> vpm-pack: error: open.off: a hole is 1 m wide, more than 0.0625 m, through (0, 1, 0); close it, or give a wider --max-hole
[1]
$ vpm-pack open.off --repair flood=20 --max-hole 1.2 --spheres 1 --quiet --report flood.json && $VALIDATE pack-report flood.json
$ python3 -c 'import json; r = json.load(open("flood.json")); v = r["mesh"]["voxel_repair"]; print(v["max_hole"], 0.8 < r["volume_mesh"] < 1.02)'
1.2 True
$ vpm-pack open.off --max-hole 1 -o open.vpmp
2> vpm-pack: error: --max-hole belongs to --repair voxel or flood
[2]
$ vpm-pack open.off --repair flood --max-hole 0.001 -o open.vpmp
2> vpm-pack: error: open.off: a hole is 1 m wide, more than 0.001 m, * (glob)
[1]
