# Lines of results: what was given with a pose comes back, as JSON or CSV.

$ cp $SOURCE/tests/tools/inputs/cube.off $SOURCE/tests/tools/inputs/wall.png .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 30 --quiet && vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' '{"id":"a","pose":[0,0,0.95,0,0,0,1]}' '[0,0,0.95,0,0,0,1]' '{"id":7,"position":{"x":0,"y":0,"z":0.95},"orientation":{"x":0,"y":0,"z":0,"w":1}}' '{"id":"two, with \"quotes\"","time":3,"pose":[0,0,1,0,0,0,1]}' > ids.jsonl

# An id comes back in the line of its pose, whatever the way to ask; other lines stay as they are.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl -o ids.out.jsonl && cut -d, -f1-2 ids.out.jsonl | sed 's/"volume".*/"volume"/'
{"pose":0,"id":"a"
{"pose":1,"volume"
{"pose":2,"id":7
{"pose":3,"id":"two
$ $VALIDATE query-result ids.out.jsonl
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl --batch 3 | cmp - ids.out.jsonl
$ python3 -c 'import json; print(json.dumps({"poses": [json.loads(l) if l[0] == "{" else {"pose": json.loads(l)} for l in open("ids.jsonl")]}))' > list.json && vpm-query --tool cube.vpmg --cloud wall.vpmc --poses list.json | cmp - ids.out.jsonl
$ vpm-query --tool cube.vpmg --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl | python3 -c 'import json, sys; print([(r.get("id"), r["tool"]) for r in map(json.loads, sys.stdin)][:6])'
[('a', 0), ('a', 1), (None, 0), (None, 1), (7, 0), (7, 1)]
$ sed -E 's/"id":("([^"\\]|\\.)*"|7),//' ids.jsonl > plain.jsonl && vpm-query --tool cube.vpmg --cloud wall.vpmc --poses plain.jsonl | cmp - <(sed -E 's/"id":("([^"\\]|\\.)*"|7),//' ids.out.jsonl)

# A name that ends in .csv gives the same values as CSV, with one column for each number.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl -o ids.csv && head -n 1 ids.csv && cut -d, -f1-5 ids.csv | tail -n 1
pose,id,tool,time,frame,volume,volume_fraction,seen_free,unseen,out_of_view,force_x,force_y,force_z,torque_x,torque_y,torque_z,boundary,inside,points,closure,level,measure,level_reason,bodies,collides,above,contacts,volume_low,volume_high
3,"two, with ""quotes""",,
$ python3 $SOURCE/tests/tools/csv_same.py ids.out.jsonl ids.csv
4 True
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.02 0 0 0.97 0 0 0 1' > path.txt
$ for o in "--measure paper --poses ids.jsonl" "--tool cube.vpmg --poses ids.jsonl --batch 2" "--poses path.txt --stiffness 2e4 --coupling stiffness=500,damping=5" "--poses ids.jsonl --for-scene"; do vpm-query --tool cube.vpmg --cloud wall.vpmc $o --force --quiet -o x.jsonl && vpm-query --tool cube.vpmg --cloud wall.vpmc $o --force --quiet -o x.csv && python3 $SOURCE/tests/tools/csv_same.py x.jsonl x.csv; done
4 True
8 True
21 True
4 True
$ python3 $SOURCE/tests/tools/frames.py numbered steps 3; for o in "" "--stiffness 2e4 --coupling stiffness=500,damping=5"; do for f in y.jsonl y.csv; do vpm-query --tool cube.vpmg --frames steps --trajectory path.txt --intrinsics 60,60,31.5,23.5 $o --quiet --force -o $f; done; python3 $SOURCE/tests/tools/csv_same.py y.jsonl y.csv; done
21 True
21 True
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl -o ids.csv; vpm-query --tool cube.vpmg --cloud wall.vpmc --poses ids.jsonl -o ids.ply
2> vpm-query: error: ids.csv exists; name another output, or give --force to overwrite it
2> vpm-query: error: ids.ply: this output is JSON, and .ply is the ending of another kind of file; name it .json or .jsonl, or give --force
[2]

# A mesh is packed and built where a tool model is asked, with the answers of doing it by hand; what is no solid is refused.
$ vpm-pack cube.off -o by_hand.vpmp --spheres 1000 --quiet && vpm-graph by_hand.vpmp -o by_hand.vpmg --quiet && vpm-query --tool by_hand.vpmg --cloud wall.vpmc --poses ids.jsonl -o by_hand.jsonl
$ vpm-query --tool cube.off --cloud wall.vpmc --poses ids.jsonl | cmp - by_hand.jsonl
2> vpm-query: note: cube.off: packed with 1000 spheres for this run; vpm-pack and vpm-graph make a .vpmg to keep, of other units and numbers too
$ awk 'NR == 2 { print "ply\nformat ascii 1.0\nelement vertex " $1; for (k = 0; k < 3; ++k) print "property float " substr("xyz", k + 1, 1); print "element face " $2 "\nproperty list uchar int vertex_indices\nend_header" } NR > 2' cube.off > cube.ply; awk 'NR > 2 && NF == 3 { print "v", $0 } NF > 3 { for (k = 2; k <= NF; ++k) $k += 1; $1 = "f"; print }' cube.off > cube.obj; cp cube.ply nameless
$ for f in cube.ply cube.obj nameless; do vpm-query --tool $f --cloud wall.vpmc --poses ids.jsonl --quiet | cmp - by_hand.jsonl; vpm-query --tool by_hand.vpmg --solid $f --pose 0.1,0,0,0,0,0,1 | cut -d, -f2; done
"volume":0.003999999999952574
"volume":0.003999999999952574
"volume":0.003999999999952574
$ printf '<html>' > page.ply; vpm-query --tool page.ply --cloud wall.vpmc --poses ids.jsonl
2> vpm-query: error: page.ply: this is a web page; download the file itself
[1]
$ vpm-query --tool by_hand.vpmg --tool cube.off --cloud wall.vpmc --poses ids.jsonl --threads 1 --quiet | python3 -c 'import json, sys; rows = [json.loads(l) for l in sys.stdin]; print(len({json.dumps({k: v for k, v in r.items() if k != "tool"}) for r in rows}), len(rows))'
4 8
$ vpm-query --tool cube.off --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --view cube.html --quiet -o /dev/null && grep -c "<html" cube.html
1
$ cp $SOURCE/tests/tools/inputs/open.off . && vpm-query --tool open.off --cloud wall.vpmc --poses ids.jsonl
2> vpm-query: error: open.off: the mesh is open: * (glob)
[1]
$ sed 's/0[.]1/100/g' cube.off > large.off && vpm-query --tool large.off --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 -o /dev/null
2> vpm-query: warning: large.off: the mesh is 200 m across: * (glob)
2> vpm-query: note: large.off: packed with 1000 spheres for this run; * (glob)
2> vpm-query: warning: the tool is 346 m across and the scene * (glob)
