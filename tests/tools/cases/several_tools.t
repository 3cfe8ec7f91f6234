# Every pose is asked of every tool; each tool's lines are those of the tool alone, pose by pose.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 200 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 50 --calibrate
$ vpm-pack cube.off -o small.vpmp --spheres 60 --quiet && vpm-graph small.vpmp -o small.vpmg --levels 50 --calibrate
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' '0 0 0 0.8 0 0 0 1' '1 0 0 0.95 0 0 0 1' '2 0 0 1 0 0 0 1' > path.txt
$ vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt -o both.jsonl --stats stats.json
$ $VALIDATE query-result both.jsonl && $VALIDATE query-stats stats.json
$ python3 -c "import json; print([(r['pose'], r['tool']) for r in map(json.loads, open('both.jsonl'))], json.load(open('stats.json'))['levels'])"
[(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] [200, 60]
$ for t in cube small; do vpm-query --tool $t.vpmg --cloud wall.vpmc --poses path.txt; done | sort > alone.jsonl && sed 's/"tool":[01],//' both.jsonl | sort | cmp - alone.jsonl
$ for batch in 2 100; do vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt --batch $batch | cmp - both.jsonl; done
$ vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt --dump-config > call.json && $VALIDATE config.vpm-query call.json && vpm-query --config call.json | cmp - both.jsonl
$ vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 | cmp - <(sed -n '3,4s/"pose":1/"pose":0/p' both.jsonl)

# Levels are chosen for each tool; a level that is named must exist in all.
$ vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt --level 50 | python3 -c "import json, sys; print({json.loads(l)['level'] for l in sys.stdin})"
{50}
$ vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt --max-error 50% | python3 -c "import json, sys; print({(r['level'], r['level_reason']) for r in map(json.loads, sys.stdin)})"
{(50, 'max-error')}
$ vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt --level 60
2> vpm-query: error: * (glob)
[2]
$ for o in '--deadline-us 100' '--coherent' '--spheres-out s.ply'; do vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses path.txt $o; done
2> vpm-query: error: --deadline-us does not go with several tools in a cloud, chosen by more than one --tool: leave it out
2> vpm-query: error: --coherent does not go with several tools in a cloud, chosen by more than one --tool: leave it out
2> vpm-query: error: --spheres-out does not go with several tools in a cloud, chosen by more than one --tool: leave it out
[2]
$ vpm-query --tool - --tool - --cloud wall.vpmc --poses path.txt
2> vpm-query: error: only one of --tool, --cloud, --pairs, --poses and --joints can be standard input
[2]
$ : > empty.txt && vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses empty.txt
2> vpm-query: error: empty.txt: * (glob)
[1]

# Through recorded frames: one path for all tools, or one for each; each tool's lines are those of the tool alone.
$ python3 $SOURCE/tests/tools/frames.py numbered steps 6
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.2 0 0 0.95 0 0 0 1' > still.txt; printf '%s\n' '0 0 0 1.0 0 0 0 1' '0.2 0 0.01 0.9 0 0 0 1' > moving.txt
$ echo 'vpm-query --frames steps --intrinsics 60,60,31.5,23.5 --quiet "$@"' > replay.sh
$ bash replay.sh --tool cube.vpmg --tool small.vpmg --poses still.txt --poses moving.txt -o paths.jsonl --stats stats.json --force && $VALIDATE query-result paths.jsonl && $VALIDATE query-stats stats.json && head -n 3 paths.jsonl | grep -o '"pose":.,"tool":.'
"pose":0,"tool":0
"pose":0,"tool":1
"pose":1,"tool":0
$ (bash replay.sh --tool cube.vpmg --poses still.txt; bash replay.sh --tool small.vpmg --poses moving.txt) | sort > alone.jsonl && sed 's/"tool":[01],//' paths.jsonl | sort | cmp - alone.jsonl
$ (bash replay.sh --tool cube.vpmg --trajectory still.txt; bash replay.sh --tool small.vpmg --trajectory still.txt) | sort > alone.jsonl && bash replay.sh --tool cube.vpmg --tool small.vpmg --trajectory still.txt | sed 's/"tool":[01],//' | sort | cmp - alone.jsonl
$ printf '%s\n' '0.1 0 0.005 0.95 0 0 0 1' '0.3 0 0 0.95 0 0 0 1' > later.txt; bash replay.sh --tool cube.vpmg --tool small.vpmg --poses moving.txt --poses later.txt | python3 -c "import json, sys; lines = [json.loads(l) for l in sys.stdin]; print(len(lines), lines[-1]['time'])"
202 0.1

# Paths that cannot be walked side by side.
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0 0 0.96 0 0 0 1' > two.txt; printf '%s\n' '0 0 0.95 0 0 0 1' > one.txt; printf '%s\n' '7 0 0 0.95 0 0 0 1' '8 0 0 0.95 0 0 0 1' > far.txt
$ for p in two.txt far.txt; do bash replay.sh --tool cube.vpmg --tool small.vpmg --poses still.txt --poses $p; done
2> vpm-query: error: only one of still.txt and two.txt has times; give times to both, or to none
2> vpm-query: error: the paths of the tools share no time; give paths of one recording
[1]
$ bash replay.sh --tool cube.vpmg --tool small.vpmg --poses one.txt --poses two.txt
2> vpm-query: error: one.txt has 1 poses, and two.txt 2; give each a pose for every step, or times
[1]
$ bash replay.sh --tool cube.vpmg --tool small.vpmg --poses one.txt --poses two.txt --poses two.txt
2> vpm-query: error: --poses is given 3 times and --tool 2 times: give one path for all tools, or one for each
[2]
$ bash replay.sh --tool cube.vpmg --poses one.txt --poses two.txt
2> vpm-query: error: --poses has several values; leave all but one out: only several --tool with --frames have a path each
[2]
$ bash replay.sh --tool cube.vpmg --tool small.vpmg --poses one.txt --coupling stiffness=500,damping=5 --stiffness 2e4
2> vpm-query: error: --coupling does not go with several tools in recorded frames, chosen by --frames and more than one --tool: leave it out
[2]
