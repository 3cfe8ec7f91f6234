# A tool that is behind the surface where the camera measured nothing, which counts for nothing, is warned about.

$ cp $SOURCE/tests/tools/inputs/cube.off .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ cat > walls.py <<< $'import struct\nfor name, is_seen in {"whole": lambda u, v: True, "specks": lambda u, v: (7 * u + 13 * v) % 3 > 0, "hole": lambda u, v: max(abs(u - 31.5), abs(v - 23.5)) > 8, "half": lambda u, v: u < 32, "rows": lambda u, v: v % 4 < 2, "step": lambda u, v: 2 if u >= 32 else 1}.items():\n    depths = [1000 * int(is_seen(u, v)) for v in range(48) for u in range(64)]\n    open(name + ".pgm", "wb").write(b"P5\\n64 48\\n65535\\n" + struct.pack(">3072H", *depths))'
$ python3 walls.py && for n in whole specks hole half rows step; do vpm-normals $n.pgm -o $n.vpmc --intrinsics 60,60,31.5,23.5; done
2> vpm-normals: warning: step.pgm: 1536 pixels hold 2000, and no other is above 1000; if that marks what was not measured, give --invalid 2000

# The cube is a quarter in the wall.
$ for n in whole specks hole half rows; do echo $n; vpm-query --tool cube.vpmg --cloud $n.vpmc --pose 0,0,0.95,0,0,0,1 2>&1 | grep -o '"volume_fraction":0.[0-9]\|vpm-query: warning.*'; done
whole
"volume_fraction":0.2
specks
"volume_fraction":0.2
hole
"volume_fraction":0.0
vpm-query: warning: at pose 0 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
half
"volume_fraction":0.1
vpm-query: warning: at pose 0 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
rows
"volume_fraction":0.1
vpm-query: warning: at pose 0 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes

# In the part that the image does not show next to the half that it does, and half out of the camera's view.
$ for p in 0.15,0,0.95 0.3,0,0.95; do vpm-query --tool cube.vpmg --cloud half.vpmc --pose $p,0,0,0,1 | grep -o '"volume_fraction":0.[0-9]'; done
"volume_fraction":0.0
"volume_fraction":0.0
2> vpm-query: warning: at pose 0 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
2> vpm-query: warning: at pose 0 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
$ for p in 0.3 0.55; do vpm-query --tool cube.vpmg --cloud whole.vpmc --pose $p,0,0.95,0,0,0,1 | grep -o '"volume_fraction":0.[0-9]'; done
"volume_fraction":0.2
"volume_fraction":0.1
2> vpm-query: warning: at pose 0 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes

# Nothing is said of tools that wait: before the wall, before its hole, and beside the image.
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0 0 0.7 0 0 0 1' '0.45 0 0.7 0 0 0 1' '0.7 0 0.7 0 0 0 1' '0.7 0 -0.3 0 0 0 1' > wait.txt
$ vpm-query --tool cube.vpmg --cloud whole.vpmc --poses wait.txt -o /dev/null
$ tail -n +2 wait.txt > free.txt; for n in hole half step; do (cat free.txt; echo '-0.3 0 0.95 0 0 0 1') | vpm-query --tool cube.vpmg --cloud $n.vpmc --poses - -o /dev/null; done

# Poses are named, of several tools too, of many every n-th; the measure as printed has its own rules.
$ cat free.txt wait.txt > both.txt; vpm-query --tool cube.vpmg --cloud hole.vpmc --poses both.txt -o /dev/null
2> vpm-query: warning: at pose 4 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
$ vpm-query --tool cube.vpmg --tool cube.vpmg --cloud hole.vpmc --poses both.txt -o /dev/null
2> vpm-query: warning: at pose 4 a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
$ for k in $(seq 200); do cat wait.txt; done | vpm-query --tool cube.vpmg --cloud hole.vpmc --poses - -o /dev/null
2> vpm-query: warning: at poses 0, 10 and 98 others of those looked at a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes
$ vpm-query --tool cube.vpmg --cloud hole.vpmc --poses both.txt -o /dev/null --measure paper
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.01 0 0 0.95 0 0 0 1' > device.txt; vpm-query --tool cube.vpmg --cloud hole.vpmc --poses device.txt --coupling stiffness=500,damping=5 --stiffness 2e4 -o /dev/null --quiet
2> vpm-query: warning: at poses 0, 1 and 9 others a quarter or more of the tool behind the surface lies where nothing was measured, and counts for nothing: move the camera, or fill the holes

# A tool in what points without a camera enclose counts whole, however deep; behind points of one side nobody knows, which is said.
$ cat > boxes.py <<< $'import itertools\nn = range(-15, 16)\nfaces = [(p, a, s) for a in range(3) for s in (-1, 1) for p in itertools.product(n, n)]\ndef rows(kept):\n    for (u, v), a, s in faces:\n        if kept(a, s):\n            at, to = [0.02 * u, 0.02 * v], [0, 0]\n            at.insert(a, 0.3 * s)\n            to.insert(a, s)\n            yield " ".join(map(str, at + to))\nfor name, kept in {"closed": lambda a, s: True, "wall": lambda a, s: (a, s) == (2, -1)}.items():\n    lines = list(rows(kept))\n    head = ["ply", "format ascii 1.0", f"element vertex {len(lines)}", *("property float " + p for p in "x y z nx ny nz".split()), "end_header"]\n    open(name + ".ply", "w").write("\\n".join(head + lines) + "\\n")'
$ python3 boxes.py && for n in closed wall; do vpm-normals $n.ply -o $n.vpmc; done
$ printf '0 0 0 0 0 0 1\n0.05 0 0.1 0 0 0 1\n0 0 -0.3 0 0 0 1\n0 0 0.7 0 0 0 1\n' > inside.txt
$ vpm-query --tool cube.vpmg --cloud closed.vpmc --poses inside.txt | grep -o '"inside":[0-9]*'
"inside":100
"inside":100
"inside":46
"inside":0
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,-0.15,0,0,0,1 | grep -o '"volume_fraction":0.[0-9]'
"volume_fraction":0.0
2> vpm-query: warning: at 1 of the poses the tool is behind points that show one side only: whether it is inside is not known, and nothing counts; points from all sides would tell, or depth images with their cameras
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses inside.txt | grep -o '"volume_fraction":0.[0-9]'
"volume_fraction":0.0
"volume_fraction":0.0
"volume_fraction":0.5
"volume_fraction":0.0
