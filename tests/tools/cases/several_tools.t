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
2> vpm-query: error: only one of --tool, --cloud, --poses and --trajectory can be standard input
[2]
$ : > empty.txt && vpm-query --tool cube.vpmg --tool small.vpmg --cloud wall.vpmc --poses empty.txt
2> vpm-query: error: empty.txt: * (glob)
[1]
