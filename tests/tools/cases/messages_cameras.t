# Messages about intrinsics, poses of the camera and of the tool, and recordings.

$ python3 $SOURCE/tests/tools/depth_files.py . && cp $SOURCE/tests/tools/inputs/* . && vpm-pack cube.off -o cube.vpmp --spheres 30 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet && vpm-normals wall.pgm -o wall.vpmc --intrinsics 60,60,31.5,23.5

# Intrinsics
$ for t in '{}' '{"fx": 60}' '{"left": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "right": {"fx": 2, "fy": 1, "cx": 1, "cy": 1}}' '{' '{"fx": 1e999}' '60 60 31.5' '60 0 31.5 0 60 23.5 0 0 2' '-60 60 31.5 23.5' 'camera: [' 'a: b'; do echo "$t" > i.txt; vpm-normals wall.pgm -o x.vpmc --intrinsics i.txt; done
2> vpm-normals: error: i.txt: no camera's intrinsics in it; it needs fx, fy, cx and cy, or a matrix K, camera_matrix or intrinsic_matrix
2> vpm-normals: error: i.txt: no camera's intrinsics in it; it needs fx, fy, cx and cy, or a matrix K, camera_matrix or intrinsic_matrix
2> vpm-normals: error: i.txt: it holds several cameras: left, right; give the numbers of one as --intrinsics fx,fy,cx,cy
2> vpm-normals: error: i.txt: not JSON: it cannot be read from line 2 on
2> vpm-normals: error: i.txt: not readable: one of its numbers is beyond what a double holds
2> vpm-normals: error: i.txt: its 3 numbers are neither fx fy cx cy nor a matrix fx 0 cx 0 fy cy 0 0 1
2> vpm-normals: error: i.txt: its 9 numbers are neither fx fy cx cy nor a matrix fx 0 cx 0 fy cy 0 0 1
2> vpm-normals: error: i.txt: its focal lengths are not greater than 0, or its numbers are too large
2> vpm-normals: error: i.txt: not YAML: * (glob)
2> vpm-normals: error: i.txt: no camera's intrinsics in it; it needs fx, fy, cx and cy, or a matrix K, camera_matrix or intrinsic_matrix
[1]
$ echo '{"K": [60, 1, 31.5, 0, 60, 23.5, 0, 0, 1], "D": [0.1, 0, 0, 0, 0]}' > i.json; vpm-normals wall.pgm -o skewed.vpmc --intrinsics i.json
2> vpm-normals: warning: i.json: the skew in its matrix is not used
2> vpm-normals: warning: i.json: the lens's distortion in it is not used: the depth image must be a rectified one
$ printf '60 0 31.5 0\n0 60 23.5 0\n0 0 1 0\n0 0 0 1\n' > scannet.txt; printf '\357\273\27760 60 31.5 23.5\n' > mark.txt; printf '\377\376' > wide.txt; printf '60 60 31.5 23.5\n' | iconv -t UTF-16LE >> wide.txt; echo '{"cameraMatrix": [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1]}' > key.json; printf 'camera_model: pinhole\nintrinsics: [60, 60, 31.5, 23.5]\n' > kalibr.yaml; for k in scannet.txt mark.txt wide.txt key.json kalibr.yaml; do vpm-normals wall.pgm -o $k.vpmc --intrinsics $k && cmp $k.vpmc wall.vpmc; done
$ for t in '60 0 31.5 45 0 60 23.5 0 0 0 1 0' '<?xml version="1.0"?><opencv_storage></opencv_storage>' '\037\213' '{"M1": [60, 0, 31.5, 0, 60, 23.5, 0, 0, 1], "M2": [61, 0, 31.5, 0, 60, 23.5, 0, 0, 1]}' '{"camera_model": "omni", "intrinsics": [1, 60, 60, 31.5, 23.5]}'; do printf "$t" > i.txt; vpm-normals wall.pgm -o x.vpmc --intrinsics i.txt; done
2> vpm-normals: error: i.txt: its matrix has a last column that is not 0, or a last row that is not 0 0 0 1, like that of another camera or a pose; if fx, fy, cx and cy are this image's, give --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: i.txt: this is XML, which is not read for intrinsics; write it as .yml, which OpenCV does where the file's name ends so
2> vpm-normals: error: i.txt: this is compressed by gzip; unpack it first: gunzip
2> vpm-normals: error: i.txt: it holds several cameras: M1, M2; give the numbers of one as --intrinsics fx,fy,cx,cy
2> vpm-normals: error: i.txt: its camera_model is omni, and only pinhole is read; rectify the images and give the numbers of the camera that they have then as --intrinsics fx,fy,cx,cy
[1]
$ echo '{"fx": 60, "fy": 60, "cx": 31.5, "cy": 23.5, "k1": 0.1, "depth_scale": 0.1}' > bop.json; printf 'Camera.fx: 60.0\nCamera.fy: 60.0\nCamera.cx: 31.5\nCamera.cy: 23.5\nDepthMapFactor: 5000.0\n' > orb.yaml; for o in bop.json orb.yaml 'orb.yaml --depth-scale 5000' 'orb.yaml --unit mm'; do vpm-normals wall.pgm -o factor.vpmc --force --intrinsics $o; done
2> vpm-normals: warning: bop.json: the lens's distortion in it is not used: the depth image must be a rectified one
2> vpm-normals: warning: bop.json: it tells a depth factor, depth_scale 0.1, which is not used; if it is in millimetres per unit, give --depth-scale 10000
2> vpm-normals: warning: orb.yaml: it tells a depth factor, DepthMapFactor 5000, which is not used; give --depth-scale 5000
2> vpm-normals: note: orb.yaml: it tells a depth factor, DepthMapFactor 5000, which is not used: 1000 units per metre were given

# Poses of the camera
$ for p in 0,0,0,0,0,0,2 0,0,0,0,0,0,nan 0,0,inf,0,0,0,1 0,0,0,0,0,0,one 0,0,0; do vpm-normals wall.pgm -o x.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose $p; done
2> vpm-normals: error: --camera-pose: the quaternion has length 2.000000 instead of 1; give x,y,z,w of a unit quaternion
2> vpm-normals: error: --camera-pose: the quaternion is not finite
2> vpm-normals: error: --camera-pose: the translation is not finite
2> vpm-normals: error: --camera-pose: 'one' is not a number in '0,0,0,0,0,0,one'
2> vpm-normals: error: --camera-pose: expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found 3 in '0,0,0'
[2]
$ for t in '1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n' '1 0 0 0\n0 1 0 0\n0 0 2 0\n0 0 0 1\n' '0 0 0 0 0 0 1\n0 0 1 0 0 0 1\n' '' '{"matrix": [1, 0, 0, 0]}' '{"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]]}' '{"extrinsic": [1, 0, 0, 0]}' '[[1,0,0,0],\n [0,1,0,0],\n [0,0,1,0],\n [0,0,1,1]]'; do printf "$t" > p.txt; vpm-normals wall.pgm -o x.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose p.txt; done
2> vpm-normals: error: p.txt, line 4: pose: the rotation matrix mirrors (its determinant is not positive); give a proper rotation
2> vpm-normals: error: p.txt, line 4: pose: the 3x3 block is not a rotation alone but scales its columns by 1, 1 and 2; divide its columns by that, and scale the mesh instead if that is meant
2> vpm-normals: error: p.txt: it holds several poses; give a file with the one of this image, or its numbers
2> vpm-normals: error: p.txt: no pose in it; each line gives one: tx ty tz qx qy qz qw, or JSON
2> vpm-normals: error: p.txt: a camera's matrix has 4x4 numbers by rows, the last row 0 0 0 1
2> vpm-normals: error: p.txt: the rotation matrix mirrors (its determinant is not positive); give a proper rotation
2> vpm-normals: error: p.txt: "extrinsic" has neither 16 numbers by columns, as Open3D writes it, nor lists of rows
2> vpm-normals: error: p.txt: the 4x4 matrix is written by columns: its last column is 0 0 0 1, and its last row 0 0 1 1 ends in 1; transpose it
[1]
$ vpm-normals wall.pgm -o rounded.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,0,0,0,0.707,0.707
2> vpm-normals: note: --camera-pose: its rotation is not exact and has been normalised

# Poses of the tool
$ for t in '0 0 1 0 0 0 2' '0 0 1 0 0 0 nan' '1 0 0 0\n0 1 0 0\n0 0 1 1\n0 0 0 2' '1 0 0 0\n0 1 0 0\n0 0 1' '1 0 0 0\n0 1 0 0' '{"place": [0]}' '{"pose": 7}' '{"pose": ["a"]}' '{"pose":' '{"pose": one}' '[[0,0,0.95,0,0,0,1], [0,0,0.95,0,0,0,2]]' '2 0 0 0 0 2 0 0 0 0 2 1' '0 0 1 world 0 0 0 1' '1 1 0 0 0 0 0 1 1 a.png' '# tx ty tz qw qx qy qz\n0 0 1 1 0 0' '0 0 one 0 0 0 1' '1 0 0 0 0 1 0 0 0 0 -1 1 0 0 0 1'; do printf "$t\n" | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -; done
2> vpm-query: error: standard input, line 1: pose: the quaternion has length 2.000000 instead of 1; give x,y,z,w of a unit quaternion
2> vpm-query: error: standard input, line 1: pose: the quaternion is not finite
2> vpm-query: error: standard input, line 4: the last row of a 4x4 pose must be 0 0 0 1, not 0 0 0 2
2> vpm-query: error: standard input, line 3: a row of a 4x4 matrix must have four numbers
2> vpm-query: error: standard input, line 2: the file ends inside of a 4x4 matrix
2> vpm-query: error: standard input, line 1: no pose in the object; it has "place"; give "pose" (7 numbers) or "matrix" (4x4 by rows), or "position" with x, y, z and "orientation" with x, y, z, w
2> vpm-query: error: standard input, line 1: a pose must be a list of numbers
2> vpm-query: error: standard input, line 1: a pose must be a list of numbers
2> vpm-query: error: standard input, line 1: a bracket that opens here is not closed; close it, or write a pose on each line
2> vpm-query: error: standard input, line 1: not JSON; write each pose as [tx,ty,tz,qx,qy,qz,qw], or in an object as "pose"
2> vpm-query: error: standard input, line 1, pose 2: pose: the quaternion has length 2.000000 instead of 1; give x,y,z,w of a unit quaternion
2> vpm-query: error: standard input, line 1: pose: the 3x3 block is not a rotation alone but scales by 2; divide its columns by that, and scale the mesh instead if that is meant
2> vpm-query: error: standard input, line 1: column 4 is not a number: world; leave this column out
2> vpm-query: error: standard input, line 1: it looks like images.txt of COLMAP, whose poses map the world to the camera, w first; convert each to a line tx ty tz qx qy qz qw of the inverse pose
2> vpm-query: error: standard input, line 2: found 6 numbers where the line of names has 7 (line 1); let the names in it be those of the numbers, in their order
2> vpm-query: error: standard input, line 1: column 3 is not a number: one
2> vpm-query: error: standard input, line 1: pose: the rotation matrix mirrors (its determinant is not positive); give a proper rotation
[1]
$ for t in '# tx ty tz q0 q1 q2 q3\n0 0 1 1 0 0 0' '# Format: timestamp tx ty tz qw qx qy qz\n0 0 1 1 0 0 0' '{"time": 0, "stamp": 0, "pose": [0, 0, 1, 0, 0, 0, 1]}' '1 0 0 0 0 1 0 0 0 0 -1 1' '1 2 3 4 5'; do printf "$t\n" | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -; done
2> vpm-query: error: standard input, line 2: line 1 seems to tell the order of the numbers, but not clearly: # tx ty tz q0 q1 q2 q3; name the columns in a comment: # tx ty tz qx qy qz qw, or qw qx qy qz
2> vpm-query: error: standard input, line 2: found 7 numbers where the line of names has 8 (line 1); let the names in it be those of the numbers, in their order
2> vpm-query: error: standard input, line 1: both "time" and "stamp" in the object; give one time
2> vpm-query: error: standard input, line 1: pose: the rotation matrix mirrors (its determinant is not positive); give a proper rotation
2> vpm-query: error: standard input, line 1: found 5 numbers; a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by row), or 12 without the last row
[1]
$ (head -c 1100000 /dev/zero | tr '\0' 1; echo) | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -
2> vpm-query: error: standard input, line 1: a line of more than a million bytes is no text
[1]
$ printf '0 0 0.95 0 0 0.707 0.707\n' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - -o /dev/null
2> vpm-query: note: rotations were up to 0.00015 away from orthonormal and have been normalised

# Recordings
$ mkdir named twice once && cp wall.png named/a.png && cp wall.png twice/1.png && cp wall.png twice/01.png && cp wall.png once/1.png && printf '0 0 0 0.95 0 0 0 1\n0.002 0 0 0.95 0 0 0 1\n' > path.txt
$ for f in named twice; do vpm-query --tool cube.vpmg --frames $f --trajectory path.txt --intrinsics 60,60,31.5,23.5; done
2> vpm-query: error: named/a.png: its name is neither a time (12.345.png) nor has it a number (frame-000001.png); give a list of "time file" lines instead
2> vpm-query: error: twice/1.png: has the number of 01.png; give a list of "time file" lines
[1]
$ vpm-query --tool cube.vpmg --frames once --trajectory path.txt --intrinsics 60,60,31.5,23.5 --repeat-frames --quiet
2> vpm-query: error: frames that all come within one step cannot be repeated; leave --repeat-frames out, or give more frames
[1]
$ printf '0 0 0 0 0 0 1\n0 0 0 0 0 0 1\n' > two.txt; vpm-query --tool cube.vpmg --frames once --trajectory path.txt --intrinsics 60,60,31.5,23.5 --camera-poses two.txt --quiet
2> vpm-query: error: two.txt: 2 poses without times for 1 frames; give one for each, or times
[1]
$ printf '0 gone.png\n' > gone.txt; vpm-query --tool cube.vpmg --frames gone.txt --trajectory path.txt --intrinsics 60,60,31.5,23.5
2> vpm-query: error: gone.txt: none of the 1 files that it names is there
[1]
$ printf 'zero wall.png\n' > bad.txt; vpm-query --tool cube.vpmg --frames bad.txt --trajectory path.txt --intrinsics 60,60,31.5,23.5
2> vpm-query: error: bad.txt, line 1: not a time and a file: zero wall.png
[1]
$ printf '9 wall.png\n' > late.txt; vpm-query --tool cube.vpmg --frames late.txt --trajectory path.txt --intrinsics 60,60,31.5,23.5 --quiet
2> vpm-query: error: the path (0.000 to 0.002 s) and the frames (9.000 to 9.000 s) share no time; --align-starts lets both begin together
[1]
$ vpm-query --tool cube.vpmg --frames once --trajectory path.txt --intrinsics 60,60,31.5,23.5 --frame-latency 9 --quiet
2> vpm-query: error: once: no frame can be used; the last one: none comes before the path ends
[1]
$ printf '0 0 0 0.95 0 0 0 1\n2e6 0 0 0.95 0 0 0 1\n' > long.txt; vpm-query --tool cube.vpmg --frames once --trajectory long.txt --intrinsics 60,60,31.5,23.5
2> vpm-query: error: the path is longer than 10^9 steps at this rate; are its times seconds?
[1]
