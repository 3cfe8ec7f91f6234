# vpm-pack: a cube, from each kind of input to each kind of output.

$ printf 'OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' > cube.off
$ vpm-pack cube.off -o cube.vpmp --spheres 9 --report report.json --export cube.csv
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
$ head -2 cube.csv
x,y,z,r
0.5,0.5,0.5,0.5
$ wc -l < cube.csv
10
$ python3 -c 'import json; r = json.load(open("report.json")); print(r["spheres"], r["certified"], r["stop_reason"], r["mesh"]["format"], r["mesh"]["triangles"], round(r["volume_mesh"], 12))'
9 True spheres OFF 12 1.0

# The tool pipes, and the same input gives the same bytes with any number of threads.
$ vpm-pack - -o - --spheres 9 --threads 1 < cube.off | cmp - cube.vpmp
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
$ vpm-pack cube.off -o - --spheres 9 --threads 2 --validate | cmp - cube.vpmp
2> vpm-pack: note: voxels: 0.604167 of the volume covered, 0 voxels of spheres outside, 0 of two spheres
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
$ vpm-pack cube.off --spheres 1 --export cube.yml && cat cube.yml
collision_spheres:
  "cube":
    - "center": [0.5, 0.5, 0.5]
      "radius": 0.5
2> vpm-pack: note: 1 sphere fills 52.4 % of a solid of 1 x 1 x 1 m
$ vpm-pack cube.off --scale 0.001 --spheres 1 --report - | python3 -c 'import json, sys; print(round(json.load(sys.stdin)["r_max"], 9))'
0.0005
2> vpm-pack: note: 1 sphere fills 52.4 % of a solid of 1 x 1 x 1 mm
$ vpm-pack cube.off --spheres 1 --validate --report - | python3 -c 'import json, sys; v = json.load(sys.stdin)["validation"]; print(v["protruding_voxels"], v["overlapping_voxels"], abs(v["coverage"] - 0.5236) < 0.01)'
0 0 True
2> vpm-pack: note: voxels: 0.523591 of the volume covered, 0 voxels of spheres outside, 0 of two spheres
2> vpm-pack: note: 1 sphere fills 52.4 % of a solid of 1 x 1 x 1 m

# Fewer spheres than asked for are delivered with the reason.
$ vpm-pack cube.off --spheres 1000 --min-radius 0.3 --export one.csv
2> vpm-pack: note: packed 1 of the 1000 spheres asked for: no further sphere of at least --min-radius fits
2> vpm-pack: note: 1 sphere fills 52.4 % of a solid of 1 x 1 x 1 m
$ vpm-pack cube.off --min-radius 0.6 --export none.csv
2> vpm-pack: error: cube.off: no sphere fits: give a smaller --min-radius
[1]

# Some meshes are mended, others are refused.
$ sed 's/^4 3 2 1 0$/4 0 1 2 3/' cube.off > turned.off && vpm-pack turned.off --spheres 1 --export turned.csv
2> vpm-pack: note: turned.off: 4 edges had neighbours of opposite orientation; 2 triangles were turned to face outward
2> vpm-pack: note: 1 sphere fills 52.4 % of a solid of 1 x 1 x 1 m
$ sed -e '2s/6/5/' -e '$d' cube.off > open.off && vpm-pack open.off -o open.vpmp
2> vpm-pack: error: open.off: the mesh is open: 4 edges of one triangle in 1 hole, a loop through (0, 1, 0); * (glob)
[1]
$ printf 'OFF\n1000000000000 1 0\n' | vpm-pack - -o huge.vpmp
2> vpm-pack: error: standard input: the header says 1000000000000 vertices and 1 faces, but the file has only 22 bytes; it is truncated or damaged
[1]
$ : > empty.stl; vpm-pack empty.stl -o empty.vpmp
2> vpm-pack: error: empty.stl: the file is empty
[1]
$ vpm-pack missing.off -o missing.vpmp
2> vpm-pack: error: * missing.off* (glob)
[1]

# Wrong usage is refused.
$ vpm-pack
2> vpm-pack: error: no mesh is given: name an OBJ, OFF, PLY, STL, OM, COLLADA, glTF, 3MF or FBX file, or - for a pipe
[2]
$ vpm-pack cube.off
2> vpm-pack: error: nothing would be written: give -o OUT.vpmp, --export, --report or --view
[2]
$ vpm-pack cube.off --export cube.xyz
2> vpm-pack: error: export: the name 'cube.xyz' must end with .csv, .json, .ply (.points.ply), .glb, .vtk, .yml (.yaml), .xrdf, .urdf or .srdf
[2]
$ vpm-pack cube.off --spheres 0 -o zero.vpmp
2> vpm-pack: error: --spheres: 0 is not a whole number from 1 to 4294967294 (see vpm-pack --help)
[2]
$ vpm-pack cube.off --weld 2 -o weld.vpmp
2> vpm-pack: error: weld: must lie between 0 and 0.1; it is a share of the mesh's diagonal
[2]
$ vpm-pack cube.off -o - --report -
2> vpm-pack: error: only one output can be standard output: --output or --report
[2]
$ vpm-pack cube.off -o missing/cube.vpmp
2> vpm-pack: error: cannot write missing/cube.vpmp: there is no folder missing
[4]

# Refused runs leave nothing behind.
$ ls -A
cube.csv
cube.off
cube.vpmp
cube.yml
empty.stl
one.csv
open.off
report.json
turned.csv
turned.off
