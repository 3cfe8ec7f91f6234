# vpm-normals: depth images and clouds of other programs become clouds with normals.

$ cp $SOURCE/tests/tools/inputs/wall.png .
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --report report.json --export wall.ply
$ $VALIDATE normals-report report.json
$ python3 -c 'import json; r = json.load(open("report.json")); del r["seconds"]; print(json.dumps(r, sort_keys=True))'
{"depth": {"farthest": 1.0, "median": 1.0, "nearest": 1.0}, "edge_gate": 0.02, "extent": [[-0.5249999761581421, -0.3916666805744171, 1.0], [0.5249999761581421, 0.3916666805744171, 1.0]], "height": 48, "intrinsics": [60.0, 60.0, 31.5, 23.5], "invalid": 1, "measured": 0.9996744791666666, "method": "inverse-depth", "points": 3071, "width": 64, "window": 7, "without_normal": 0}

# The same bytes come from a pipe, with any number of threads.
$ vpm-normals - -o - --intrinsics 60,60,31.5,23.5 --threads 1 < wall.png | cmp - wall.vpmc
$ vpm-normals -o - --intrinsics 60,60,31.5,23.5 wall.png --threads 2 | cmp - wall.vpmc
$ vpm-normals wall.png -o pca.vpmc --intrinsics 60,60,31.5,23.5 --method pca --window 5 --edge-gate 0 --camera-pose 1,2,3,0,0,0,1

# An organised PCD keeps the grid and tells its camera; points with normals need no camera.
$ vpm-normals wall.png --export grid.pcd --intrinsics 60,60,31.5,23.5
$ vpm-normals grid.pcd -o grid.vpmc
2> vpm-normals: note: grid.pcd: intrinsics recovered from its points: 60,60,31.5,23.5
$ vpm-normals grid.pcd -o grid.vpmc --intrinsics 60,60,31.5,23.5 --force && vpm-normals grid.pcd --report - --quiet | python3 -c 'import json, sys; print(json.load(sys.stdin)["points"])'
3071
$ vpm-normals wall.ply -o scattered.vpmc --report - | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["method"], r["points"], r["invalid"])'
file 3071 0
$ vpm-normals wall.ply -o scattered.vpmc --intrinsics 60,60,31.5,23.5 --force
2> vpm-normals: warning: wall.ply: --intrinsics is not used: it holds points with normals, not an image
$ vpm-normals grid.pcd -o x.vpmc --intrinsics 90,90,31.5,23.5
2> vpm-normals: error: grid.pcd: its points do not fit the intrinsics given: point (0, 0) is 15.7 pixels from where fx 90 fy 90 cx 31.5 cy 23.5 see it, more than 0.5; leave --intrinsics out to have them recovered
[1]

# Wrong usage is refused.
$ vpm-normals
2> vpm-normals: error: no depth image is given: name a file, or - for a pipe
[2]
$ vpm-normals wall.png
2> vpm-normals: error: nothing would be written: give -o OUT.vpmc, --export, --report or --view
[2]
$ vpm-normals wall.png -o x.vpmc
2> vpm-normals: error: wall.png: a depth image needs --intrinsics: fx,fy,cx,cy in pixels, or a file with them
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5
2> vpm-normals: error: --intrinsics 60,60,31.5: give four numbers fx,fy,cx,cy, or a file with them
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 0,60,31.5,23.5
2> vpm-normals: error: intrinsics: fx,fy,cx,cy must be finite and within 2^40, fx and fy greater than 0 (pixels)
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --window 8
2> vpm-normals: error: normals: the window must be odd and between 3 and 31 pixels, not 8
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --edge-gate 1
2> vpm-normals: error: normals: the edge gate must be at least 0 and less than 1
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --method svd
2> vpm-normals: error: --method: svd not in {inverse-depth,pca} (see vpm-normals --help)
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --depth-scale 0
2> vpm-normals: error: --depth-scale must be finite and greater than 0
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --export points.xyz
2> vpm-normals: error: --export points.xyz: the name must end in .ply or .pcd
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,0
2> vpm-normals: error: --camera-pose: expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found 3 in '0,0,0'
[2]
$ vpm-normals wall.png -o - --report - --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: only one output can be standard output: --output or --report
[2]
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --report wall.vpmc
2> vpm-normals: error: --output and --report would both be written to wall.vpmc; name two files
[2]
$ vpm-normals wall.png -o outside.vpmc --intrinsics 600,600,319.5,239.5
2> vpm-normals: warning: wall.png: the principal point of 600,600,319.5,239.5 lies outside of the image of 64 x 48 pixels; if that was scaled from 640 x 480, give --intrinsics 60,60,31.5,23.5
2> vpm-normals: warning: wall.png: the focal lengths of 600,600,319.5,239.5 are improbable for an image of 64 x 48 pixels; are these the intrinsics of this image's size?

# Unsuitable inputs are refused.
$ vpm-normals nowhere.png -o x.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: cannot read nowhere.png: No such file or directory
[1]
$ head -c 90 wall.png | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: standard input: not a sound PNG: the file is truncated
[1]
$ printf '' | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: standard input: the file is empty; give a depth image or a cloud
[1]
$ echo hello | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: standard input: neither PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD nor PLY by its content; give a depth image or a cloud
[1]
$ printf 'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n' | vpm-normals - -o x.vpmc
2> vpm-normals: error: standard input: points without a grid need normals (normal_x normal_y normal_z, or nx ny nz); estimate them first, or give the depth image
[1]
$ printf 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1000000\nHEIGHT 60\nPOINTS 60000000\nDATA binary\n' | vpm-normals - -o x.vpmc
2> vpm-normals: error: standard input: PCD is truncated: 720000000 bytes of points promised, 0 there
[1]
