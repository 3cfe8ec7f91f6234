# Messages about clouds of other programs that are damaged, or do not fit.

# PCD
$ head='VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n'; for t in 'WIDTH two\n' 'WIDTH\n' 'COUNT 1 1\n' 'COUNT 1 1 9999999\n' 'VIEWPOINT 0 0 0 1\n' 'VIEWPOINT 0 0 0 one 0 0 0\n' 'VIEWPOINT 0 0 nan 1 0 0 0\n' 'VIEWPOINT 0 0 0 2 0 0 0\n' 'WIDTH 2\nHEIGHT 2\nPOINTS 3\nDATA ascii\n' 'POINTS 0\nDATA ascii\n' 'WIDTH 9000000000\nHEIGHT 1\nDATA ascii\n' 'WIDTH 1\nHEIGHT 1\nDATA text\n' 'WIDTH 900\nHEIGHT 1\nDATA ascii\n0 0 1\n' 'WIDTH 2\nHEIGHT 1\nDATA ascii\n0 0 1\n' 'WIDTH 1\nHEIGHT 1\nDATA ascii\n0 0\n' 'WIDTH 1\nHEIGHT 1\nDATA ascii\n0 0 one\n' 'WIDTH 1\nHEIGHT 1\nDATA ascii\n0 0 1\n0 0 2\n' 'WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n1' 'WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n\x9\0\0\0\xc\0\0\0' 'WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n\1\0\0\0\x9\0\0\0x' 'WIDTH 1\nHEIGHT 1\nDATA binary_compressed\n\2\0\0\0\xc\0\0\0xx'; do printf "$head$t" | vpm-normals - -o x.vpmc; done
2> vpm-normals: error: standard input: PCD header: 'two' in WIDTH is not a count
2> vpm-normals: error: standard input: PCD header: 'WIDTH' has no value
2> vpm-normals: error: standard input: PCD header: COUNT names 2 fields, FIELDS 3
2> vpm-normals: error: standard input: PCD header: a COUNT of 9999999 is too large
2> vpm-normals: error: standard input: PCD header: VIEWPOINT needs 7 numbers: tx ty tz qw qx qy qz
2> vpm-normals: error: standard input: PCD header: 'one' in VIEWPOINT is not a number
2> vpm-normals: error: standard input: PCD header: VIEWPOINT is not finite
2> vpm-normals: error: standard input: PCD header: VIEWPOINT: the quaternion has length 2.000000 instead of 1; give tx ty tz qw qx qy qz of a unit quaternion
2> vpm-normals: error: standard input: PCD header: WIDTH 2 times HEIGHT 2 is not POINTS 3
2> vpm-normals: error: standard input: PCD holds no points
2> vpm-normals: error: standard input: PCD header promises 9000000000 points; at most 67108864 are read
2> vpm-normals: error: standard input: PCD header: DATA 'text' is not ascii, binary or binary_compressed
2> vpm-normals: error: standard input: PCD is truncated: 900 points cannot fit into the file
2> vpm-normals: error: standard input: PCD is truncated: 2 points cannot fit into the file
2> vpm-normals: error: standard input: PCD is truncated: 1 points cannot fit into the file
2> vpm-normals: error: standard input: PCD point 0: 'one' is not a number
2> vpm-normals: error: standard input: points without a grid need normals (normal_x normal_y normal_z, or nx ny nz); estimate them first, or give the depth image
2> vpm-normals: error: standard input: PCD is truncated before its compressed data
2> vpm-normals: error: standard input: PCD is truncated: 9 compressed bytes promised, 0 there
2> vpm-normals: error: standard input: PCD holds 9 bytes uncompressed; its points need 12
2> vpm-normals: error: standard input: PCD is corrupt: the compressed data cannot be decoded
[1]
$ for t in 'VERSION 0.5\n' 'VERSION 0.7\nDATA ascii\n' 'VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n0 0\n' 'VERSION 0.7\nFIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n0 0 0\n'; do printf "$t" | vpm-normals - -o x.vpmc; done
2> vpm-normals: error: standard input: PCD version 0.5 is not known; write version 0.7
2> vpm-normals: error: standard input: PCD header names no FIELDS
2> vpm-normals: error: standard input: no field holds z of its points; its fields are x, y
2> vpm-normals: error: standard input: PCD header: field 'z' has TYPE F of SIZE 3, which is no number
[1]

# PLY
$ for t in 'element vertex many\n' 'elements\n' 'element vertex 1\nproperty float x\nend_header\n' 'property float x\n' 'format ascii 1.0\nelement vertex 1\nproperty quad x\n' 'format ascii 1.0\nelement vertex 1\nproperty list float int x\n' 'format ascii 1.0\nend_header\n' 'format ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n' 'format ascii 1.0\nelement vertex 1\nend_header\n' 'format ascii 1.0\nelement vertex 9000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n' 'format ascii 1.0\nelement vertex 1\nproperty float x\nproperty float X\nend_header\n0 0\n'; do printf "ply\n$t" | vpm-normals - -o x.vpmc; done
2> vpm-normals: error: standard input: line 2: the element's count is 'many', which is not a whole number
2> vpm-normals: error: standard input: line 2: not a statement of a PLY header
2> vpm-normals: error: standard input: the header has no 'format' line
2> vpm-normals: error: standard input: line 2: a property before the first element
2> vpm-normals: error: standard input: line 4: quad is not a type of a PLY property
2> vpm-normals: error: standard input: line 4: the length of a list must be an integer
2> vpm-normals: error: standard input: the header has no element 'vertex'
2> vpm-normals: error: standard input: no field holds y of its points; its fields are x
2> vpm-normals: error: standard input: the element 'vertex' has no properties
2> vpm-normals: error: standard input: the header says 9000000000 x vertex, but the file has only 109 bytes; it is truncated or damaged
2> vpm-normals: error: standard input: two fields hold x of its points: x and X
[1]
$ head='ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n'; for t in '' '0 0 1 0 0 -1\n' '0 0 1 0 0 -1\n0 0 1 0 0\n' '0 0 1 0 0 -1\n0 0 1 0 0 up\n' '0 0 1 0 0 -1\n0 1 1 0 0 -1 7\n' '0 0 1 0 0 -1\n0 1 1 0 0 -1\n0 2 1 0 0 -1\n' '0 0 1 0 0 -1\n0 0 1 0 0 -1\n' 'nan 0 1 0 0 -1\nnan 0 1 0 0 -1\n' '0 0 1 0 0 0\n0 1 1 0 0 0\n'; do printf "$head$t" | vpm-normals - -o x.vpmc --force; done
2> vpm-normals: error: standard input: the header says 2 x vertex, but the file has only 154 bytes; it is truncated or damaged
2> vpm-normals: error: standard input: the header says 2 x vertex, but the file has only 167 bytes; it is truncated or damaged
2> vpm-normals: error: standard input: line 12: a value is missing
2> vpm-normals: error: standard input: line 12: a value is 'up', which is not a number
2> vpm-normals: warning: standard input: line 12 holds more numbers than the header says; they are not read
2> vpm-normals: warning: standard input: the header counts 2 x vertex, but more follows in line 13, which is not read
2> vpm-normals: error: standard input: all points are at one place; their spacing, which tells the size of the surface that each stands for, is not known
2> vpm-normals: error: standard input: no point with a finite position and normal
2> vpm-normals: error: standard input: all its normals are zero, as in files of 3D Gaussian splats; estimate them first, or give the depth image
[1]

# Points that are read, with what is wrong about them
$ points() { python3 -c 'import sys; n = range(20); turn = sys.argv[1]; far = float(sys.argv[2]); print("ply", "format ascii 1.0", "element vertex 400", *("property float " + p for p in "x y z nx ny nz".split()), "end_header", *(f"{i / 50 + far if (i, k) == (0, 0) else i / 50} {k / 50} 1 0 0 {dict(random=1 if (i * 7 + k * 3) % 5 < 2 else -1, none=0 if i == k else -1).get(turn, -1)}" for i in n for k in n), sep="\n")' "$@"; }; points random 0 > random.ply; points none 0 > none.ply; points toward 1e7 > far.ply
$ vpm-normals random.ply -o random.vpmc
2> vpm-normals: error: random.ply: 400 of its 400 normals (100 %) face opposite ways to those about them, the first at (0, 0, 1), (0, 0.02, 1), (0, 0.04, 1); turn them by --orient neighbours, or by the place of the sensor
[1]
$ vpm-normals none.ply -o none.vpmc
2> vpm-normals: note: none.ply: 20 points have no normal and are left out
$ vpm-normals far.ply -o far.vpmc
2> vpm-normals: error: far.ply: its points are too far apart: float32 rounds their places by up to 0.298023 m, too much for their spacing; leave out those that are far from the others
[1]
$ vpm-normals none.ply -o used.vpmc --invalid 9 --range 1,5 --along-ray
2> vpm-normals: warning: none.ply: --invalid is not used: it holds points with normals, not an image
2> vpm-normals: warning: none.ply: --range is not used: it holds points with normals, not an image
2> vpm-normals: warning: none.ply: --along-ray is not used: it holds points with normals, not an image
2> vpm-normals: note: none.ply: 20 points have no normal and are left out
