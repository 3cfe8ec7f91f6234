# Messages about depth images that are damaged, or hold something else than depth.

$ python3 $SOURCE/tests/tools/depth_files.py .

# PGM and PFM
$ for t in 'P6 3 2 65535\n' 'P5 3 2 255\n123456' 'P5 3 2 65535\n12345' 'P5 0 2 65535\n' 'P5 3 two 65535\n' 'P5 3\n' 'P2 3 1 4095 1 2 x\n' 'P2 3 1 4095 1 2 70000\n' 'P2 3 2 4095 1 2\n' 'Pf 3 2 0\n' 'Pf 3 2 -1\n1234'; do printf "$t" | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5; done
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: a colour or black-and-white picture (P6); depth is P2, P5 or Pf
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: its largest value is 255: depth needs 16 bits
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: the file is truncated: 12 bytes of pixels promised, 5 there
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: its size is no whole number above 0
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: 'two' is not a number
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: the header is truncated
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: pixel 2: 'x' is no value
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: pixel 2: '70000' is no value
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: the file is truncated
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: its scale is 0; it must be -1 (little-endian) or 1 (big-endian)
2> vpm-normals: error: standard input: not a depth image in PGM or PFM: the file is truncated: 24 bytes of pixels promised, 4 there
[1]
$ sed '3s/-1.0/-2.0/' wall.pfm > scaled.pfm; vpm-normals scaled.pfm -o scaled.vpmc --intrinsics 60,60,31.5,23.5; vpm-normals scaled.pfm -o scaled.vpmc --intrinsics 60,60,31.5,23.5 --unit m --force
2> vpm-normals: warning: scaled.pfm: the scale of 2 in its header multiplies nothing; give --depth-scale if depths are not metres

# NPY
$ npy() { python3 -c 'import struct, sys; h = sys.argv[1].encode(); sys.stdout.buffer.write(b"\x93NUMPY\1\0" + struct.pack("<H", len(h)) + h + b"\0" * 32)' "$1"; }; for h in "{'descr': '<f4', 'shape': (2, 1), }" "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 1), }" "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 2), }" "{'descr': '<f4', 'fortran_order': False, 'shape': 2, }" "{'descr': '<f4', 'fortran_order': False, 'shape': (9, 9), }"; do npy "$h" | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5; done; npy '{}' | head -c 9 | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: standard input: not a sound NPY: its header has no fortran_order
2> vpm-normals: error: standard input: not a depth image in NPY: integers of 8 bits; depth is a float or an integer of 16 bits or more
2> vpm-normals: error: standard input: not a depth image in NPY: an array of 2 x 2 x 2; depth has two dimensions, rows and columns; save only the z of the point at each pixel
2> vpm-normals: error: standard input: not a sound NPY: its shape cannot be read
2> vpm-normals: error: standard input: not a sound NPY: the file is truncated: 9 x 9 values promised, 8 there
2> vpm-normals: error: standard input: not a sound NPY: the file is truncated
[1]

# PNG
$ png() { python3 -c 'import struct, sys, zlib; chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)); w, h, bits, color = map(int, sys.argv[1:]); sys.stdout.buffer.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, bits, color, 0, 0, 0)) + chunk(b"IDAT", zlib.compress(b"\0" * 40)) + chunk(b"IEND", b""))' "$@"; }; for p in '2 2 8 2' '2 2 8 0' '9000 9000 16 0' '100000 100000 16 0' '9 9 16 0'; do png $p | vpm-normals - -o x.vpmc --intrinsics 60,60,31.5,23.5; done
2> vpm-normals: error: standard input: a PNG with 3 channels of 8 bits is no depth image; depth needs one gray channel of 16 bits
2> vpm-normals: error: standard input: a PNG with 1 channel of 8 bits is no depth image; depth needs one gray channel of 16 bits
2> vpm-normals: error: standard input: an image of 9000 x 9000 pixels is not read; at most 67108864 pixels are
2> vpm-normals: error: standard input: an image of 100000 x 100000 pixels is not read; at most 67108864 pixels are
2> vpm-normals: error: standard input: not a sound PNG: * (glob)
[1]

# Values that mean something else
$ python3 -c 'import sys; sys.path.insert(0, sys.argv[1]); sys.dont_write_bytecode = True; from depth_files import *; d = [2047 if k % 64 == 63 else round(1092.5 - 351300 / z) for k, z in enumerate(MILLIMETRES)]; open("disparity.pgm", "wb").write(pgm(d)); open("sparse.pgm", "wb").write(pgm([z if k // 64 < 3 and k % 64 < 32 else 0 for k, z in enumerate(MILLIMETRES)])); open("dots.pgm", "wb").write(pgm([z if k in (99, 2222) else 0 for k, z in enumerate(MILLIMETRES)]))' $SOURCE/tests/tools
$ vpm-normals disparity.pgm -o raw.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: warning: disparity.pgm: no value is above 2047, which 48 pixels hold, as in the raw disparity of a Kinect (NYU Depth); if so, give --decode disparity
$ vpm-normals disparity.pgm -o disparity.vpmc --intrinsics 60,60,31.5,23.5 --decode disparity --verbose
2> vpm-normals: disparity.pgm: depth 0.9994 to 1.063 m, median 1.032 m; 98.44 % measured; the scene is 1.065 x 0.8326 x 0.0635 m, from (-0.5247, -0.4163, 0.9994) to (0.5403, 0.4163, 1.063)
$ vpm-normals sparse.pgm -o sparse.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: warning: sparse.pgm: only 3.1 % of its pixels hold a measurement
$ vpm-normals dots.pgm -o dots.vpmc --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: dots.pgm: none of its 2 measured pixels has neighbours enough for a normal
[1]
$ vpm-normals wall.pgm -o wall.vpmc --intrinsics 60,60,31.5,23.5 --channel Z --flip
2> vpm-normals: warning: wall.pgm: --channel is not used: it is no OpenEXR image
2> vpm-normals: warning: wall.pgm: --flip is not used: normals estimated from depth face the camera
$ vpm-normals wall.pgm -o none.vpmc --intrinsics 60,60,31.5,23.5 --range 5,9
2> vpm-normals: error: wall.pgm: no pixel holds a measurement: its depths are from 1 m to 1.06 m, all outside of --range, which is in metres
[1]

# Files that are no depth images are named, with the next step.
$ for t in '\x1f\x8b' 'BZh9' '\xfd7zXZ\0' '7z\xbc\xaf' '\xff\xd8\xff' 'GIF89a' '\x89HDF' 'MATLAB 5.0 MAT-file' '#ROSBAG V2.0' '\x89MCAP' 'LASF' 'ASTM-E57' 'BLENDER' '\xd0\xcf\x11\xe0' '%%PDF' '<html>' '<?xml?><sdf>' '<?xml?><svg>'; do printf "$t" | vpm-normals - -o x.vpmc; done
2> vpm-normals: error: standard input: this is compressed by gzip; unpack it first: gunzip
2> vpm-normals: error: standard input: this is compressed by bzip2; unpack it first: bunzip2
2> vpm-normals: error: standard input: this is compressed by xz; unpack it first: unxz
2> vpm-normals: error: standard input: this is compressed by 7-Zip; unpack it first: 7z x
2> vpm-normals: error: standard input: this is a JPEG picture, which holds no exact values; give the 16-bit or float image
2> vpm-normals: error: standard input: this is a GIF picture; give the 16-bit or float image
2> vpm-normals: error: standard input: this is an HDF5 file; save one of its arrays as .npy or 16-bit PNG
2> vpm-normals: error: standard input: this is a MATLAB file; save one of its arrays as 16-bit PNG
2> vpm-normals: error: standard input: this is a ROS bag; convert it to MCAP: rosbags-convert --src BAG --dst OUT --dst-storage mcap
2> vpm-normals: error: standard input: this is an MCAP recording; give its file to vpm-normals, or to vpm-query --frames
2> vpm-normals: error: standard input: this is a LAS cloud; convert it to PLY with normals, for example by PDAL
2> vpm-normals: error: standard input: this is an E57 cloud; convert it to PLY with normals, for example by PDAL
2> vpm-normals: error: standard input: this is a Blender file; give a depth image or a cloud, or the mesh to vpm-pack
2> vpm-normals: error: standard input: this is a file of SolidWorks or of an office program; give a depth image or a cloud, or the mesh to vpm-pack
2> vpm-normals: error: standard input: this is a PDF document; give the file that was meant
2> vpm-normals: error: standard input: this is a web page; download the file itself
2> vpm-normals: error: standard input: this is a robot description (URDF, MJCF, SDF); give a depth image or a cloud, or the mesh to vpm-pack
2> vpm-normals: error: standard input: this is an XML file; give the file that was meant
[1]
