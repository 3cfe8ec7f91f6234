# Messages about meshes that are damaged, or are no solids.

# OBJ
$ refuse() { printf "$1" > a.obj; vpm-pack a.obj -o x.vpmp; }; for t in 'v 0 0\n' 'v 0 0 one\n' 'v 0 0 nan\n' 'v 0 0 0\nf 1 1 5\n' 'v 0 0 0\nf 1 2 x\n' 'v 1 0 0 0\n' 'v 0 0 0\n' 'v 0 0 0\nf 1 1\n'; do refuse "$t"; done
2> vpm-pack: error: a.obj: line 1: z is missing
2> vpm-pack: error: a.obj: line 1: z is 'one', which is not a number
2> vpm-pack: error: a.obj: line 1: a coordinate is not finite
2> vpm-pack: error: a.obj: line 2: vertex index 5 is out of range; the file has 1 vertices
2> vpm-pack: error: a.obj: line 2: a corner of the face is not a vertex index
2> vpm-pack: error: a.obj: line 1: the vertex divided by its w is not finite
2> vpm-pack: error: a.obj: the mesh has no faces, only 1 vertex; save it with its faces; a cloud of points is for vpm-normals
2> vpm-pack: error: a.obj: the mesh has no faces of three corners or more
[1]

# OFF
$ for t in 'OFX\n' 'OFF 3 1\n' 'OFF\n3 one 0\n' 'OFF\n-3 1 0\n' 'nOFF 4 3 1 0\n' 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n' 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 0.5\n' 'OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n' 'OFF 3 1 0\n0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n'; do printf "$t" > a.off; vpm-pack a.off -o x.vpmp; done
2> vpm-pack: error: a.off: line 1: expected the keyword OFF, or COFF, NOFF, STOFF, 4OFF
2> vpm-pack: error: a.off: the header says 3 vertices and 1 faces, but the file has only 8 bytes; it is truncated or damaged
2> vpm-pack: error: a.off: line 2: the number of faces is 'one', which is not a whole number
2> vpm-pack: error: a.off: line 2: a count is negative
2> vpm-pack: error: a.off: line 1: its points have 4 dimensions, not 3
2> vpm-pack: error: a.off: line 5: vertex index 7 is out of range; the header says 3 vertices, counted from 0
2> vpm-pack: error: a.off: line 5: a vertex index is '0.5', which is not a whole number
2> vpm-pack: error: a.off: line 5: the face's number of corners is negative
2> vpm-pack: error: a.off: line 4: a coordinate is not finite
[1]
$ cube='OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n'; printf "$cube$cube" | vpm-pack - --spheres 5 --report - | grep volume_mesh; printf "${cube}4 3 2 1 0\n" | vpm-pack - --spheres 5 --report - | grep volume_mesh; printf "${cube/6 0/5 0}" | vpm-pack - -o x.vpmp; printf "${cube/8 6/9 6}" | vpm-pack - -o x.vpmp
  "volume_mesh": 1.0,
  "volume_mesh": 1.0,
2> vpm-pack: note: standard input: another OFF file follows in line 17, which is not read
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: standard input: the header counts 6 faces, but more follows in line 17, which is not read
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: error: standard input: the header counts 5 faces, but more follows in line 16, which is not read; so the mesh is open: *; save it again, or fetch all of it (glob)
2> vpm-pack: error: standard input: the header counts 9 vertices, but line 11 does not look like one; so the mesh is open: *; save it again, or fetch all of it (glob)
[1]
$ printf 'OFF BINARY\n\0\0\0\011\0\0\0\0\0\0\0\0' | vpm-pack - -o x.vpmp
2> vpm-pack: error: standard input: the counts of this binary OFF file do not fit its 12 bytes in either byte order; it is truncated or damaged
[1]
$ printf '4OFF BINARY\n\0\0\0\0' | vpm-pack - -o x.vpmp
2> vpm-pack: error: standard input: line 1: binary OFF is read with three coordinates only; save it as text
[1]

# PLY
$ for t in 'element vertex 3\n' 'format text 1.0\n' 'format ascii 1.0\nelement vertex many\n' 'format ascii 1.0\nelement vertex -1\n' 'format ascii 1.0\nproperty float x\n' 'format ascii 1.0\nelement vertex 1\nproperty quad x\n' 'format ascii 1.0\nelement vertex 1\nproperty float\n' 'format ascii 1.0\nelement vertex 1\nend_header\n' 'end_header\n' 'format ascii 1.0\nvertices 3\n'; do printf "ply\n$t" | vpm-pack - -o x.vpmp; done
2> vpm-pack: error: standard input: the file ends after line 2 where 'end_header' should follow; it is truncated
2> vpm-pack: error: standard input: line 2: unknown format; it must be ascii, binary_little_endian or binary_big_endian
2> vpm-pack: error: standard input: line 3: the element's count is 'many', which is not a whole number
2> vpm-pack: error: standard input: line 3: the element's count is negative
2> vpm-pack: error: standard input: line 3: a property before the first element
2> vpm-pack: error: standard input: line 4: quad is not a type of a PLY property
2> vpm-pack: error: standard input: line 4: the property has no name
2> vpm-pack: error: standard input: the element 'vertex' has no properties
2> vpm-pack: error: standard input: the header has no 'format' line
2> vpm-pack: error: standard input: line 3: not a statement of a PLY header
[1]
$ head='ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n'; for t in 'end_header\n' 'element face 1\nproperty int a\nend_header\n' 'element face 1\nproperty list uchar int vertex_indices\nproperty list uchar int more\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' 'element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n' 'element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n9000000 0 1 2\n' 'element face 1\nproperty list float int vertex_indices\nend_header\n'; do printf "$head$t" | vpm-pack - -o x.vpmp; done
2> vpm-pack: error: standard input: the header says 3 x vertex, but the file has only 100 bytes; it is truncated or damaged
2> vpm-pack: error: standard input: the header says 3 x vertex, 1 x face, but the file has only 130 bytes; it is truncated or damaged
2> vpm-pack: error: standard input: line 14: a value is missing
2> vpm-pack: error: standard input: line 13: face 0: a vertex index is out of range; the header says 3 vertices, counted from 0
2> vpm-pack: error: standard input: line 13: a value is missing
2> vpm-pack: error: standard input: line 8: the length of a list must be an integer
[1]
$ printf 'ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n123456789012' | vpm-pack - -o x.vpmp
2> vpm-pack: error: standard input: the header says 1 x vertex, 1 x face, but the file has only 184 bytes; it is truncated or damaged
[1]

$ head='ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n'; for t in '3 0 1 2\n3 0 1 2\n' '3 0 1 2\nply\n' '3 0 1 2 0\n'; do printf "$head$t" | vpm-pack - -o x.vpmp; done
2> vpm-pack: error: standard input: the header counts 1 face, but more follows in line 14, which is not read; so the mesh is open: * (glob)
2> vpm-pack: error: standard input: another PLY file follows in line 14, which is not read; so the mesh is open: * (glob)
2> vpm-pack: error: standard input: line 13 holds more numbers than the header says; they are not read; so the mesh is open: * (glob)
[1]

# STL
$ for t in 'solid\nfacet normal 0 0 1\nfacet\n' 'solid\nvertex 0 0 0\n' 'solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\n' 'solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n' 'solid\nfacets\n' 'solid\nfacet normal 0 0 1\nouter loop\n' 'solid\nendsolid\n'; do printf "$t" > a.stl; vpm-pack a.stl -o x.vpmp; done
2> vpm-pack: error: a.stl: line 3: a facet begins within a facet
2> vpm-pack: error: a.stl: line 2: a vertex outside of a facet
2> vpm-pack: error: a.stl: line 6: a facet must have 3 vertices
2> vpm-pack: error: a.stl: line 4: z is 'zero', which is not a number
2> vpm-pack: error: a.stl: line 2: not a statement of an STL file
2> vpm-pack: error: a.stl: the file ends without 'endsolid'; it is truncated
2> vpm-pack: error: a.stl: this is no mesh: it has no vertices and no faces; give the file that was meant, as OBJ, PLY or STL
[1]
$ head -c 83 /dev/zero > a.stl; vpm-pack a.stl -o x.vpmp; head -c 100 /dev/zero > a.stl; vpm-pack a.stl -o x.vpmp; (head -c 80 /dev/zero; printf '\1\0\0\0'; head -c 46 /dev/zero; printf '\377\377\377\177') | head -c 134 > a.stl; vpm-pack a.stl -o x.vpmp
2> vpm-pack: error: a.stl: 83 bytes are too few for a binary STL file; it is truncated
2> vpm-pack: error: a.stl: the header says 0 triangles, and 16 bytes follow, which are no whole number of triangles
2> vpm-pack: error: a.stl: triangle 0 (at byte 84): a coordinate is not finite
[1]

# Solids that are none
$ mesh() { echo "OFF $1 $2 0"; }; (mesh 3 1; printf '1 1 1\n1 1 1\n1 1 1\n3 0 1 2\n') | vpm-pack - -o x.vpmp; (mesh 3 1; printf '0 0 0\n1 0 0\n0 1 0\n2 0 1\n') | vpm-pack - -o x.vpmp; (mesh 3 1; printf '0 0 0\n1 0 0\n0 1 0\n3 0 1 1\n') | vpm-pack - -o x.vpmp; (mesh 3 2; printf '0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n') | vpm-pack - -o x.vpmp; (mesh 5 1; printf '0 0 0\n2 2 0\n2 0 0\n0 2 0\n-1 1 0\n5 0 1 2 3 4\n') | vpm-pack - -o x.vpmp
2> vpm-pack: error: standard input: its coordinates lie up to 1 from the origin, where floats of 32 bits are 1.2e-07 apart, coarse for a mesh of 0; so all triangles lie in one point; move it to the origin before it is saved
2> vpm-pack: error: standard input: the mesh has no faces of three corners or more
2> vpm-pack: error: standard input: every triangle has two equal corners; the mesh has no surface
2> vpm-pack: error: standard input: the mesh is degenerate: it is closed, but encloses no volume (0 m^3)
2> vpm-pack: error: standard input: a polygon of 5 corners, from (0, 0, 0), *; save triangles in the program that wrote it (glob)
[1]
$ cube='OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n'; printf "$cube" > cube.off; printf "${cube/6 0/7 0}3 0 1 6\n" | vpm-pack - -o x.vpmp; printf "${cube/6 0/7 0}4 3 2 1 0\n" | vpm-pack - --spheres 5 --repair --report - | grep volume_mesh; printf "${cube/1 1 1/1 1 1e31}" | vpm-pack - -o x.vpmp
  "volume_mesh": 1.0,
2> vpm-pack: error: standard input: the mesh is open: 2 edges of one triangle in 1 hole, a rim through (0, 0, 0); and non-manifold: 1 edge belongs to more than two triangles; give --repair voxel for a new surface
2> vpm-pack: note: standard input: 2 repeated triangles dropped
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: error: standard input: the mesh reaches from (0, 0, 0) to (1, 1, 1e+31), which leaves the range of 1e-30 to 1e30 m; give --scale
[1]

# Solids that are mended, with a note.
$ awk 'NR < 11 {print} NR > 10 {print $1, $5, $4, $3, $2}' cube.off | vpm-pack - --spheres 5 --report - | grep volume_mesh
  "volume_mesh": 1.0,
2> vpm-pack: note: standard input: the mesh faced inward and was turned
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
$ (echo OFF 16 12 0; sed -n 3,10p cube.off; sed -n 3,10p cube.off | awk '{print $1 / 2 + 0.25, $2 / 2 + 0.25, $3 / 2 + 0.25}'; sed -n 11,16p cube.off; sed -n 11,16p cube.off | awk '{print 4, $2 + 8, $3 + 8, $4 + 8, $5 + 8}') | vpm-pack - --spheres 5 --report - | grep volume_mesh
  "volume_mesh": 1.0,
2> vpm-pack: note: standard input: 1 shell inside of the solid dropped: nothing but solid lies on both sides; turn it over if it is a cavity
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 1 x 1 x 1 m
$ (echo OFF 16 12 0; sed -n 3,10p cube.off; sed -n 3,10p cube.off | awk '{print $1 + 0.5, $2 + 0.25, $3 + 0.25}'; sed -n 11,16p cube.off; sed -n 11,16p cube.off | awk '{print 4, $2 + 8, $3 + 8, $4 + 8, $5 + 8}') | vpm-pack - --spheres 5 --report - | grep volume_mesh
  "volume_mesh": 1.71875,
2> vpm-pack: warning: standard input: the mesh intersects itself: 19 pairs of triangles, at (0.333333, 0.333333, 1) and more; what it encloses at least once is the solid, and overlaps count once
2> vpm-pack: note: 5 spheres fill 46.1 % of a solid of 1.5 x 1.25 x 1.25 m

# Files that are no meshes are named, with the next step.
$ for t in '\xff\xd8\xff' '\x89HDF' 'LASF' '#ROSBAG V2.0' 'BLENDER' '<mujoco>' '\x1f\x8b' 'VERSION .7\n' '\x89PNG'; do printf "$t" | vpm-pack - -o x.vpmp; done
2> vpm-pack: error: standard input: this is a JPEG picture, which holds no exact values; give the mesh, or a cloud and images to vpm-normals
2> vpm-pack: error: standard input: this is an HDF5 file; give the mesh, or a cloud and images to vpm-normals
2> vpm-pack: error: standard input: this is a LAS cloud; give the mesh, or a cloud and images to vpm-normals
2> vpm-pack: error: standard input: this is a ROS bag; give the mesh, or a cloud and images to vpm-normals
2> vpm-pack: error: standard input: this is a Blender file; export a mesh from it, as OBJ, PLY or STL
2> vpm-pack: error: standard input: this is a robot description (MJCF); give one of the files that it names
2> vpm-pack: error: standard input: this is compressed by gzip; unpack it first: gunzip
2> vpm-pack: error: standard input: this is a cloud of points (PCD); give the mesh, or a cloud and images to vpm-normals
2> vpm-pack: error: standard input: this is a PNG picture; give the mesh, or a cloud and images to vpm-normals
[1]
