# Requests on standard input: tool and scene stay ready, one answer for each line, and what is refused ends nothing else.

$ cp $SOURCE/tests/tools/inputs/cube.off $SOURCE/tests/tools/inputs/wall.png .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 30 --quiet && vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' '{"id":"a","pose":[0,0,0.95,0,0,0,1]}' '[0,0,1,0,0,0,1]' '{"id":7,"position":{"x":0,"y":0,"z":0.97},"orientation":{"x":0,"y":0,"z":0,"w":1}}' > ids.jsonl

# Answers are those of --poses, also after requests that are refused.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl -o ids.out.jsonl && vpm-query --tool cube.vpmg --cloud wall.vpmc --serve < ids.jsonl | cmp - ids.out.jsonl
$ (printf '%s\n' 'no' '{"id":1}' '' '{"id":2,"pose":[0,0,1]}' '{"id":3,"pose":[0,0,1,0,0,0,2e300]}' '{"id":4,"pose":[0,0,"x",0,0,0,1]}' '{"id":5,"cloud":"gone.vpmc"}' '{"id":6,"cloud":7}' '{"id":8,"solids":[[0,0,1,0,0,0,1]],"pose":[0,0,1,0,0,0,1]}' '{"id":9,"id":10,"pose":[0,0,1,0,0,0,1]}' '3' '{"id":11,"pose":[0,0,1,0,0,0,1],"camera_pose":[0,0,0,0,0,0,1]}' '{"cloud":"cube.off"}' '{"cloud":"-"}'; cat ids.jsonl) | vpm-query --tool cube.vpmg --cloud wall.vpmc --serve > mixed.jsonl; tail -n 3 mixed.jsonl | cmp - ids.out.jsonl && head -n -3 mixed.jsonl
{"error":"not JSON","hint":"write {\"pose\": [tx,ty,tz,qx,qy,qz,qw]} or {\"cloud\": \"scene.vpmc\"}, with an \"id\" if wanted"}
{"id":1,"error":"no pose in the object; it has \"id\"","hint":"give \"pose\" (7 numbers) or \"matrix\" (4x4 by rows), or \"position\" with x, y, z and \"orientation\" with x, y, z, w"}
{"id":2,"error":"found 3 numbers","hint":"a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by row), or 12 without the last row"}
{"id":3,"error":"pose: the quaternion is not finite"}
{"id":4,"error":"a pose must be a list of numbers"}
{"id":5,"error":"cannot read gone.vpmc: No such file or directory"}
{"id":6,"error":"\"cloud\" is no name of a file","hint":"write {\"pose\": [tx,ty,tz,qx,qy,qz,qw]} or {\"cloud\": \"scene.vpmc\"}, with an \"id\" if wanted"}
{"id":8,"error":"\"solids\" has 1 pose, but --solid is given 0 times","hint":"give one for each, or leave \"solids\" out"}
{"error":"ambiguous: it gives \"id\" twice","hint":"leave one of them out"}
{"error":"a request is an object of JSON","hint":"write {\"pose\": [tx,ty,tz,qx,qy,qz,qw]} or {\"cloud\": \"scene.vpmc\"}, with an \"id\" if wanted"}
{"id":11,"error":"a camera's pose without its image","hint":"give \"cloud\" beside it"}
{"error":"cube.off: this is a mesh in OFF","hint":"give a depth image or a cloud, or the mesh to vpm-pack"}
{"error":"standard input holds the requests","hint":"name a file"}
$ printf '%s\n' '{"id":1,"pose":[0,0,1,0,0,0,1],"solds":[]}' '{"id":2,"psoe":[0,0,1,0,0,0,1]}' '{"id":3,"pose":[0,0,1,0,0,0,1],"weight":1}' '{"id":4,"pose":[0,0,1e400,0,0,0,1]}' '{"id":5' '{"id":7,"pose":[0,0,1,0,0,0,1],"header":{"stamp":{"sec":1,"nanosec":0}}}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --serve | cut -d, -f1-3 | sed 's/0\.004.*/0.004/'
{"id":1,"error":"there is no key 'solds'","hint":"is 'solids' meant?"}
{"id":2,"error":"there is no key 'psoe'","hint":"is 'pose' meant?"}
{"id":3,"error":"there is no key 'weight'","hint":"write {\"pose\": [tx
{"error":"not readable: one of its numbers is beyond what a double holds"}
{"error":"not JSON","hint":"write {\"pose\": [tx,ty
{"pose":0,"id":7,"volume":0.004
$ head -n -3 mixed.jsonl > refused.jsonl && $VALIDATE serve-answer refused.jsonl && $VALIDATE query-result ids.out.jsonl
$ python3 -c 'import json; print([(a.get("id"), "hint" in a) for a in map(json.loads, open("mixed.jsonl")) if "error" in a])'
[(None, True), (1, True), (2, True), (3, False), (4, False), (5, False), (6, True), (8, True), (None, True), (None, True), (11, True), (None, True), (None, True)]

# A scene comes by its name: a cloud, or an image with --intrinsics, seen from where the request says.
$ printf '%s\n' '{"id":"early","pose":[0,0,0.95,0,0,0,1]}' '{"id":"scene","cloud":"wall.vpmc"}' '{"id":"a","pose":[0,0,0.95,0,0,0,1]}' '{"cloud":"wall.png","camera_pose":[0,0,0.05,0,0,0,1],"pose":[0,0,1,0,0,0,1]}' | vpm-query --tool cube.vpmg --serve --intrinsics 60,60,31.5,23.5 | python3 -c 'import json, sys; print(*[json.dumps({k: (round(v, 3) if k == "volume_fraction" else v) for k, v in json.loads(l).items() if k in ("id", "error", "hint", "cloud", "points", "volume_fraction", "pose")}) for l in sys.stdin], sep="\n")'
{"id": "early", "error": "there is no scene yet", "hint": "give \"cloud\", here or in a request before"}
{"id": "scene", "cloud": "wall.vpmc", "points": 3071}
{"pose": 0, "id": "a", "volume_fraction": 0.25}
{"pose": 1, "volume_fraction": 0.25}

# A time before the seven numbers is passed over, as in files of poses; the id may be any value of JSON.
$ printf '%s\n' '{"id":{"a":[1,null]},"pose":[5,0,0,0.95,0,0,0,1]}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --serve | grep -o '"id":.*volume"' && printf '%s\n' '[5,0,0,0.95,0,0,0,1]' | vpm-query --tool cube.vpmg --cloud wall.vpmc --serve | cut -d, -f2- | cmp - <(head -n 1 ids.out.jsonl | cut -d, -f3-)
"id":{"a":[1,null]},"volume"

# Solids stand where they were given, or move with a request.
$ printf '%s\n' '{"id":1,"pose":[0,0,0.85,0,0,0,1]}' '{"id":2,"tool":[0,0,0.85,0,0,0,1],"solids":[[0.15,0,0.85,0,0,0,1]]}' > moved.jsonl; for o in "--poses moved.jsonl" --serve; do vpm-query --tool cube.vpmg --cloud wall.vpmc --solid cube.off@0.1,0,0.85,0,0,0,1 $o < moved.jsonl > answers${o:0:7}; done; cmp answers--poses answers--serve; python3 -c 'import json; print([round(json.loads(l)["volume"] * 1e6, 3) for l in open("answers--serve")])'
[4000.0, 2000.0]

# Each answer comes before the next request is written.
$ cat > talk.py <<< 'import json, subprocess as s; p = s.Popen(["vpm-query", "--tool", "cube.vpmg", "--cloud", "wall.vpmc", "--serve"], stdin=s.PIPE, stdout=s.PIPE, text=True); ask = lambda q: (p.stdin.write(json.dumps(q) + "\n"), p.stdin.flush(), json.loads(p.stdout.readline()))[2]; print([ask({"id": k, "pose": [0, 0, 0.95 + k / 100, 0, 0, 0, 1]})["id"] for k in range(3)]); p.stdin.close(); print(p.wait())'
$ python3 talk.py
[0, 1, 2]
0

# Wrong usage.
$ vpm-query --tool cube.vpmg --cloud - --serve < wall.vpmc
2> vpm-query: error: --serve reads its requests from standard input: name files for --tool and --cloud
[2]
$ vpm-query --tool cube.vpmg --tool cube.vpmg --serve < ids.jsonl
2> vpm-query: error: --serve answers for one tool: give one --tool
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --serve -o x.csv < ids.jsonl
2> vpm-query: error: --serve answers in JSON: let the name of --output end in .jsonl
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --serve --poses ids.jsonl
2> vpm-query: error: --poses does not go with requests, chosen by --serve: leave it out
[2]
