# Whether a tool collides with what a camera sees, or that nobody can know: a field for each line and an exit status for scripts.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ cat > told.py <<< 'import json, sys; [print(*(r[k] if k == "collides" else round(r[k], 2) for k in ("collides", "volume_fraction", "seen_free", "unseen", "out_of_view"))) for r in map(json.loads, sys.stdin)]'

# Free before the wall, in it, 30 cm behind it, half out of the image, behind the camera. Each line adds up to 1.
$ printf '%s\n' '0 0 0.7 0 0 0 1' '0 0 0.95 0 0 0 1' '0 0 1.4 0 0 0 1' '0.36 0 0.7 0 0 0 1' '0 0 -1 0 0 0 1' > all.txt
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides -o all.jsonl
[10]
$ python3 told.py < all.jsonl
no 0.0 1.0 0.0 0.0
yes 0.25 0.75 0.0 0.0
unknown 0.0 0.0 1.0 0.0
unknown 0.0 0.55 0.0 0.45
unknown 0.0 0.0 0.0 1.0
$ $VALIDATE query-result all.jsonl
$ python3 -c 'import json; print(max(abs(sum(r[k] for k in ("volume_fraction", "seen_free", "unseen", "out_of_view")) - 1) for r in map(json.loads, open("all.jsonl"))) < 1e-9)'
True
$ for p in "0 0 0.7" "0 0 0.95" "0 0 1.4" "0.36 0 0.7"; do vpm-query --tool cube.vpmg --cloud wall.vpmc --pose "$p 0 0 0 1" --collides -o /dev/null; echo $?; done
0
10
11
11

# Volumes above a limit, in m³, are named by their poses. The cube has 0.008 m³.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --fail-above 0.001 -o above.jsonl
2> vpm-query: note: pose 1: 0.00200119 m³, above 0.001
[10]
$ $VALIDATE query-result above.jsonl && grep -c '"above":false' above.jsonl
4
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --fail-above 0.003 -o /dev/null
$ vpm-query --tool cube.vpmg --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides --fail-above 0.001 -o /dev/null
2> vpm-query: note: pose 1, tool 0: 0.00200119 m³, above 0.001
2> vpm-query: note: pose 1, tool 1: 0.00200119 m³, above 0.001
[10]

# The limit is a part of the tool; without --collides nothing is answered.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose '0.36 0 0.7 0 0 0 1' --collides --unseen 0.6 -o /dev/null
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt | grep -c collides
0
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --unseen 0.6
2> vpm-query: error: --unseen needs --collides: it says when that is unknown
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides --unseen 2
2> vpm-query: error: --unseen: * (glob)
[2]

# The same by every way to ask, and as CSV; requests get the field, and an exit status of their own.
$ for o in "--batch 2" "--threads 2" "--tool cube.vpmg"; do vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides $o | python3 -c 'import json, sys; print([r["collides"] for r in map(json.loads, sys.stdin) if r.get("tool", 0) == 0])'; done
['no', 'yes', 'unknown', 'unknown', 'unknown']
['no', 'yes', 'unknown', 'unknown', 'unknown']
['no', 'yes', 'unknown', 'unknown', 'unknown']
[10]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides -o all.csv; python3 $SOURCE/tests/tools/csv_same.py all.jsonl all.csv
5 True
$ echo '{"pose":[0,0,0.95,0,0,0,1]}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --serve --collides | grep -o '"collides":"[a-z]*"'
"collides":"yes"
$ mkdir frames && cp wall.png frames/0.png && vpm-query --tool cube.vpmg --frames frames --trajectory all.txt --rate 1 --intrinsics 60,60,31.5,23.5 --quiet --collides | python3 -c "import json, sys; print([json.loads(l)['collides'] for l in sys.stdin])"
['no', 'yes', 'unknown', 'unknown', 'unknown']
[10]

# Only that, as soon as it is sure: the same answers and exit statuses, in lines that tell nothing else.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides-only -o only.jsonl
[10]
$ $VALIDATE query-result only.jsonl && head -n 1 only.jsonl && diff <(grep -o '"collides":"[a-z]*"' only.jsonl) <(grep -o '"collides":"[a-z]*"' all.jsonl)
{"pose":0,"level":100,"measure":"refined","collides":"no"}
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides-only --threads 1 --unseen 0.6 -o only.csv; cut -d, -f1,25 only.csv | tail -n 5
0,no
1,yes
2,unknown
3,no
4,unknown
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose '0 0 1.4 0 0 0 1' --collides-only --shadows solid | grep -o '"collides":"[a-z]*"'
"collides":"yes"
[10]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses all.txt --collides-only --batch 2
2> vpm-query: error: --collides-only does not go with poses in batches, chosen by --batch: leave it out
[2]

# Points without a camera tell what is outside, and what nobody knows since the scan is open: below a table top. The measure as printed does not.
$ python3 -c 'print("ply\nformat ascii 1.0\nelement vertex 3600", *("property float " + p for p in "x y z nx ny nz".split()), "end_header", *(f"{i / 100 - .295} {k / 100 - .295} -1 0 0 1" for i in range(60) for k in range(60)), sep="\n")' > table.ply && vpm-normals table.ply -o table.vpmc --quiet
$ printf '%s\n' '0 0 -0.8 0 0 0 1' '0 0 -0.95 0 0 0 1' '0 0 -1.11 0 0 0 1' '0 0 -1.7 0 0 0 1' '9 0 -1.7 0 0 0 1' > table.txt && vpm-query --tool cube.vpmg --cloud table.vpmc --poses table.txt --collides --quiet -o table.jsonl
2> vpm-query: warning: at 1 of the poses the tool is behind points that show one side only: whether it is inside is not known, and nothing counts; points from all sides would tell, or depth images with their cameras
[10]
$ python3 told.py < table.jsonl
no 0.0 1.0 0.0 0.0
yes 0.25 0.75 0.0 0.0
unknown 0.0 0.0 1.0 0.0
no 0.0 1.0 0.0 0.0
no 0.0 1.0 0.0 0.0
$ $VALIDATE query-result table.jsonl
$ vpm-query --tool cube.vpmg --cloud table.vpmc --poses table.txt --collides-only --threads 1 --quiet | grep -o '"collides":"[a-z]*"'
"collides":"no"
"collides":"yes"
"collides":"unknown"
"collides":"no"
"collides":"no"
[10]
$ vpm-query --tool cube.vpmg --cloud table.vpmc --pose '0 0 -1.11 0 0 0 1' --collides --unseen 1 --quiet -o /dev/null
2> vpm-query: warning: at 1 of the poses the tool is behind points that show one side only: whether it is inside is not known, and nothing counts; points from all sides would tell, or depth images with their cameras
$ vpm-query --tool cube.vpmg --cloud table.vpmc --poses table.txt --quiet -o table.csv && cut -d, -f 7-10 table.csv | sed -n '1p;2p'
volume_fraction,seen_free,unseen,out_of_view
0.0,1.0,0.0,0.0
2> vpm-query: warning: at 1 of the poses the tool is behind points that show one side only: whether it is inside is not known, and nothing counts; points from all sides would tell, or depth images with their cameras
$ printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' 'property float nx' 'property float ny' 'property float nz' end_header '0 0 1 0 0 -1' '0 1 1 0 0 -1' '1 0 1 0 0 -1' > points.ply && vpm-normals points.ply -o points.vpmc --quiet
$ vpm-query --tool cube.vpmg --cloud points.vpmc --pose '0 0 0.7 0 0 0 1' --collides | grep -o '"collides":"[a-z]*"\|seen_free'
seen_free
"collides":"no"
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose '0 0 0.7 0 0 0 1' --measure paper --collides | grep -o '"collides":"[a-z]*"\|seen_free'
"collides":"unknown"
[11]
