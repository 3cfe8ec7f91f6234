# What sensors, exporters and careless hands give is read right, or refused with the cure.

$ python3 $SOURCE/tests/tools/depth_files.py . && cp $SOURCE/tests/tools/inputs/* .
$ vpm-normals wall.pgm -o wall.vpmc --intrinsics 60,60,31.5,23.5 --report - | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["depth"], r["measured"], [[round(x, 3) for x in c] for c in r["extent"]])'
{'farthest': 1.062999963760376, 'median': 1.031999945640564, 'nearest': 1.0} 1.0 [[-0.525, -0.416, 1.0], [0.558, 0.416, 1.063]]

# Each format gives the same cloud.
$ for f in wall.pfm wall.npy wall.tif swapped.pgm; do vpm-normals $f --export $f.ply --intrinsics 60,60,31.5,23.5 && vpm-normals wall.pgm --export w.ply --intrinsics 60,60,31.5,23.5 --force && cmp w.ply $f.ply; done
2> vpm-normals: note: swapped.pgm: its values stand with the low byte first, and are read so; --decode big-endian reads them as the standard of PGM says

# Intrinsics and the camera's pose are read from files.
$ printf '60 60 31.5 23.5\n' > four.txt; for k in four.txt info.yaml realsense.json open3d.json; do vpm-normals wall.pgm -o $k.vpmc --intrinsics $k && cmp $k.vpmc wall.vpmc; done
$ vpm-normals wall.pgm -o x.vpmc --intrinsics larger.json
2> vpm-normals: error: wall.pgm: the intrinsics are of an image of 128 x 96 pixels; this one has 64 x 48; if it was scaled to that, give --intrinsics 60,60,31.5,23.5
[1]
$ vpm-normals wall.pgm -o pose.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose pose.txt && vpm-normals wall.pgm -o - --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,0.5,0,0,0,1 | cmp - pose.vpmc
$ vpm-normals wall.pgm -o x.vpmc --intrinsics wall.pgm
2> vpm-normals: error: wall.pgm: this is a PGM, PPM or PFM image; write fx, fy, cx and cy of its camera in a text, or give them as --intrinsics fx,fy,cx,cy
[1]
$ vpm-normals wall.pgm -o normalised.vpmc --intrinsics 1.1,1.2,0.5,0.5
2> vpm-normals: warning: wall.pgm: the intrinsics 1.1,1.2,0.5,0.5 are less than a pixel or a few; if they are parts of the image's size, give --intrinsics 70.4,57.6,31.5,23.5

# Values that mean something else are said, and the advice works.
$ vpm-normals marked.pgm -o marked.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: note: marked.pgm: 48 pixels hold 65535, which is taken for "not measured"; --invalid none takes it for a depth
$ vpm-normals marked.pgm -o marked.vpmc --intrinsics 60,60,31.5,23.5 --invalid none --force
2> vpm-normals: warning: marked.pgm: 48 pixels hold 65535, and no other is above 1062; if that marks what was not measured, give --invalid 65535
$ vpm-normals far.npy -o far.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: warning: far.npy: 48 pixels hold 9, and no other is above 1.062; if that marks what was not measured, give --invalid 9
$ vpm-normals far.npy -o far.vpmc --intrinsics 60,60,31.5,23.5 --invalid 9 --force
$ vpm-normals far.npy -o far.vpmc --intrinsics 60,60,31.5,23.5 --range 0.1,5 --force 2>&1 | wc -l
0
$ vpm-normals rotated.pgm -o rotated.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: warning: rotated.pgm: its values are multiples of 8, and their median is 8.26 m; if they are rotated by three bits, give --decode rotated, which makes that 1.03 m (SUN3D)
$ vpm-normals rotated.pgm --export rotated.ply --intrinsics 60,60,31.5,23.5 --decode rotated && cmp rotated.ply wall.npy.ply
$ vpm-normals wall.npy -o x.vpmc --intrinsics 60,60,31.5,23.5 --decode rotated
2> vpm-normals: error: wall.npy: --decode is for integers of 16 bits, which this image has not
[2]
$ vpm-normals wall.npy -o mm.vpmc --intrinsics 60,60,31.5,23.5 --unit mm
2> vpm-normals: warning: wall.npy: half of its depths are below 0.00103 m, which is improbable: is its unit another one? --depth-scale tells it, in units per metre
$ vpm-normals wall.pgm -o um.vpmc --intrinsics 60,60,31.5,23.5 --depth-scale 5 --verbose
2> vpm-normals: warning: wall.pgm: half of its depths are above 206 m, which is improbable: is its unit another one? --depth-scale tells it, in units per metre
2> vpm-normals: wall.pgm: depth 200 to 212.6 m, median 206.4 m; 100 % measured; the scene is 216.6 x 166.5 x 12.6 m, from (-105, -83.27, 200) to (111.6, 83.27, 212.6)
$ vpm-normals wall.pgm -o x.vpmc --intrinsics 60,60,31.5,23.5 --depth-scale 5 --unit mm
2> vpm-normals: error: --depth-scale and --unit exclude each other: leave one of them out
[2]
$ vpm-normals wall.pgm -o x.vpmc --intrinsics 60,60,31.5,23.5 --range 5,1
2> vpm-normals: error: --range 5,1: give near,far in metres, far greater than near
[2]
$ vpm-normals wall.pgm -o x.vpmc --intrinsics 60,60,31.5,23.5 --invalid many
2> vpm-normals: error: --invalid many: give values with commas, such as 65535,4095, or none
[2]

# Axes of other programs are named, and the cure works.
$ vpm-normals opengl.pcd -o x.vpmc
2> vpm-normals: error: opengl.pcd: its points are those of a camera with x right, y up, z backward; give --axes opengl
[1]
$ vpm-normals opengl.pcd -o gl.vpmc --axes opengl
2> vpm-normals: note: opengl.pcd: intrinsics recovered from its points: 60,60,31.5,23.5

# A tool that no pose brings to the scene is said, and whether the inverse poses would.
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,-0.95,0,0,0,1 -o /dev/null
2> vpm-query: warning: at every pose the tool is behind the camera; it would be there with inverse poses (from tool to world), or with vpm-normals --axes opengl --camera-pose 0,0,0,0,0,0,1
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 5,0,1,0,0,0,1 -o /dev/null
2> vpm-query: warning: at no pose is the tool in the camera's view; are poses and scene in the same frame and unit?
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.3,0,0,0,1 -o /dev/null
2> vpm-query: warning: at no pose is the tool within its size of the surface; are poses and scene in the same frame and unit?
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.7,0,0,0,1 -o /dev/null
$ vpm-pack cube.off -o large.vpmp --scale 1000 --spheres 50 --quiet && vpm-graph large.vpmp -o large.vpmg --quiet && vpm-query --tool large.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 -o /dev/null
2> vpm-pack: warning: cube.off: the mesh is 200 m across: if its unit is the millimetre, give --scale 1
2> vpm-query: warning: the tool is 346 m across and the scene 1.37 m: if the mesh is in metres, give vpm-pack --scale 1

# So are a tool in millimetres that is no giant, the cure works, and nothing else is said of it; and poses in millimetres.
$ sed -n 3,10p cube.off > corners.txt; (echo OFF; echo 8 12 0; awk '{print 75*$1, 150*$2, 250*$3}' corners.txt; tail -n +11 cube.off) > finger.off; vpm-pack finger.off -o finger.vpmp --spheres 30 --quiet && vpm-graph finger.vpmp -o finger.vpmg --quiet && vpm-query --tool finger.vpmg --cloud wall.vpmc --poses - -o /dev/null <<< $'0 0 0.95 0 0 0 1\n0 0 950 0 0 0 1'
2> vpm-pack: warning: finger.off: the mesh is 50 m across: if its unit is the millimetre, give --scale 0.001
2> vpm-query: warning: the tool is 60.2 m across and the scene 1.37 m: if the mesh is in millimetres, give vpm-pack --scale 0.001
$ vpm-pack finger.off -o metres.vpmp --scale 0.001 --spheres 30 --quiet && vpm-graph metres.vpmp -o metres.vpmg --quiet && vpm-query --tool metres.vpmg --cloud wall.vpmc --pose 0,0,1.02,0,0,0,1 -o /dev/null
$ printf '%s\n' '0 0 950 0 0 0 1' '10 0 960 0 0 0 1' > poses_mm.txt && vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses_mm.txt -o /dev/null
2> vpm-query: warning: at no pose is the tool within its size of the surface; it would be there with x, y, z of the poses divided by 1000, if they are millimetres
$ awk '{print $1/1000, $2/1000, $3/1000, $4, $5, $6, $7}' poses_mm.txt | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - | wc -l
2

# Files that were given by mistake are named.
$ printf 'version https://git-lfs.github.com/spec/v1\noid sha256:0\n' | vpm-normals - -o x.vpmc
2> vpm-normals: error: standard input: this is a Git LFS pointer, not the file itself; fetch it with: git lfs pull
[1]
$ printf 'PK\003\004' | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: standard input: this is an archive (zip, npz); unpack it first; of an npz, save one array as .npy
[1]
$ vpm-normals wall.vpmc -o x.vpmc
2> vpm-normals: error: wall.vpmc: this is a cloud (.vpmc); it is ready for vpm-query
[1]

# Messages escape what is no text, and are cut.
$ printf 'VERSION 0.7\nFIELDS x\033[31m\nSIZE 4\nTYPE \033\n' | vpm-normals - -o x.vpmc
2> vpm-normals: error: standard input: PCD header ends before its DATA line
[1]
$ python3 -c 'print("VERSION 0.7\nFI" + 100000 * "E" + " 1")' > long.pcd; vpm-normals long.pcd -o x.vpmc
2> vpm-normals: error: long.pcd: PCD header: unknown entry 'FIEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEEE…'
[1]
$ head -c 300 wall.vpmc | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - 2>&1 | cut -c1-80
vpm-query: error: standard input: this is a file of vpm (.vpmp, .vpmg, .vpmc); g
[1]

# What others write by the pages of formats/ is read.
$ python3 $SOURCE/tests/formats/independent_writer.py written.vpmc && vpm-query --tool cube.vpmg --cloud written.vpmc --pose 0,0,0.95,0,0,0,1 | python3 -c 'import json, sys; print(round(json.loads(sys.stdin.read())["volume_fraction"], 2))'
0.25

# Nothing is overwritten without --force, and no name may end like that of another kind.
$ echo mine > mine.txt; vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 -o mine.txt
2> vpm-query: error: mine.txt exists; name another output, or give --force to overwrite it
[2]
$ vpm-pack cube.off -o x.vpmp --spheres 5 --export mine.urdf --quiet; vpm-pack cube.off -o y.vpmp --spheres 5 --export mine.urdf --quiet
2> vpm-pack: error: mine.urdf exists; name another output, or give --force to overwrite it
[2]
$ vpm-pack cube.off -o cube.vpmp --spheres 5
2> vpm-pack: error: cube.vpmp exists and is a packing (.vpmp); name another output, or give --force to overwrite it
[2]
$ vpm-pack cube.off -o cube.stl --spheres 5
2> vpm-pack: error: cube.stl: this output is a packing (.vpmp), and .stl is the ending of another kind of file; let its name end in .vpmp, or give --force
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 -o results.vpmc
2> vpm-query: error: results.vpmc: this output is JSON, and .vpmc is the ending of another kind of file; name it .json or .jsonl, or give --force
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 -o results.ply
2> vpm-query: error: results.ply: this output is JSON, and .ply is the ending of another kind of file; name it .json or .jsonl, or give --force
[2]
$ vpm-graph cube.vpmp -o model.txt
2> vpm-graph: error: model.txt: this output is a tool model (.vpmg), and .txt is the ending of another kind of file; let its name end in .vpmg, or give --force
[2]

# A closed pipe ends quietly, by its signal; what a killed run left is removed by the next one.
$ bash -c 'vpm-query --tool cube.vpmg --cloud wall.vpmc --poses <(for k in $(seq 20000); do echo "0 0 0.95 0 0 0 1"; done) --level 0 | head -n 1 | wc -l; echo ${PIPESTATUS[0]}'
1
141
$ sleep 0 & : > .x.vpmp.vpm-$!-0.tmp; wait; vpm-pack cube.off -o swept.vpmp --spheres 5 --quiet; ls -A | grep -c tmp
0
[1]

# What brings a tool to the scene is told by how near it comes: of axes, inverse poses and poses of the camera's frame
# the one that fits best, or all that fit as well.
$ printf '%s\n' '0.1 0.1 0.95 0 0 0 1' '-0.2 -0.13 0.98 0 0 0 1' > steps.txt
$ vpm-normals opengl.pcd --axes opengl -o turned.vpmc --camera-pose 0,0,0,0,0,0,1 --quiet && vpm-query --tool cube.vpmg --cloud turned.vpmc --poses steps.txt -o /dev/null
2> vpm-query: warning: at every pose the tool is behind the camera; it would be there with inverse poses (from tool to world), or with vpm-normals --axes opencv
$ vpm-normals wall.pgm -o moved.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 4,0,0,0,0,0,1 && vpm-query --tool cube.vpmg --cloud moved.vpmc --poses steps.txt -o /dev/null
2> vpm-query: warning: at no pose is the tool in the camera's view; it would be there with no vpm-normals --camera-pose, if poses are in the camera's frame
$ vpm-normals wall.pgm -o w_first.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,0,0.9659258,0.258819,0,0 && vpm-query --tool cube.vpmg --cloud w_first.vpmc --pose 0,-0.475,0.8227,0,0,0,1 -o /dev/null
2> vpm-query: warning: at every pose the tool is behind the camera; it would be there with vpm-normals --camera-pose as tx,ty,tz,qx,qy,qz,qw (w last)
