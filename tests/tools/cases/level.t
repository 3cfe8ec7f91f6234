# Choice of the level: by error, by deadline, by the scene.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 300 --quiet
$ vpm-graph cube.vpmp -o cube.vpmg --levels 10,60 --calibrate --report graph.json && $VALIDATE graph-report graph.json
$ vpm-graph cube.vpmp -o plain.vpmg --levels 10,60
$ vpm-graph cube.vpmp -o single.vpmg --calibrate
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' '0 0 0 0.8 0 0 0 1' '1 0 0 0.95 0 0 0 1' '2 0 0 1 0 0 0 1' > path.txt

# The error falls from level to level; other numbers of threads give the same bytes.
$ python3 -c "import json; w = [l['calibration']['worst'] for l in json.load(open('graph.json'))['levels']]; print(w[0] > w[1] > w[2] > 0)"
True
$ vpm-graph cube.vpmp -o - --levels 10,60 --calibrate --threads 1 | cmp - cube.vpmg

# The coarsest level that keeps an error is taken; the result line names it and the reason.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 5% -o e.jsonl && $VALIDATE query-result e.jsonl
$ python3 -c "import json; print([(r['level'], r['level_reason']) for r in map(json.loads, open('e.jsonl'))])"
[(10, 'max-error'), (10, 'max-error'), (10, 'max-error')]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 0.05 | cmp - e.jsonl
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --level 10 | cmp - <(sed 's/,"level_reason":"max-error"//' e.jsonl)

# Points in spheres are counted by the measure as printed only.
$ grep -c '"points":' e.jsonl
0
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --measure paper | grep -c '"points":'
3

# Points without a camera are denoised unless --raw-points is given, those of frames too.
$ python3 -c "n = range(-40, 41); print('ply', 'format ascii 1.0', f'element vertex {len(n) ** 2}', *('property float ' + p for p in 'x y z nx ny nz'.split()), 'end_header', *(f'{i / 100} {k / 100} {1 + (i + k) % 2 / 200} 0 0 -1' for i in n for k in n), sep='\n')" > wall.ply && vpm-normals wall.ply -o points.vpmc --quiet
$ for raw in '' --raw-points; do vpm-query --tool cube.vpmg --cloud points.vpmc --poses path.txt $raw -o points$raw.jsonl && $VALIDATE query-result points$raw.jsonl; done
$ cmp -s points.jsonl points--raw-points.jsonl || python3 -c "import json; a, b = ([json.loads(l)['volume_fraction'] for l in open(f)] for f in ('points.jsonl', 'points--raw-points.jsonl')); print(max(abs(x - y) for x, y in zip(a, b)) < 0.01, max(a) > 0.1)"
True True
$ vpm-query --tool cube.vpmg --cloud points.vpmc --poses path.txt --measure paper --raw-points | cmp - <(vpm-query --tool cube.vpmg --cloud points.vpmc --poses path.txt --measure paper)
$ mkdir points && cp wall.ply points/0.ply && for raw in '' --raw-points; do vpm-query --tool cube.vpmg --frames points --trajectory path.txt --rate 1 $raw --quiet | python3 -c "import json, sys; print([json.loads(l)['volume'] for l in sys.stdin])" | cmp - <(python3 -c "import json; print([json.loads(l)['volume'] for l in open('points$raw.jsonl')])"); done

# Points with a camera are denoised likewise.
$ python3 -c "w, h = 80, 60; print('VERSION .7', 'FIELDS x y z', 'SIZE 4 4 4', 'TYPE F F F', 'COUNT 1 1 1', f'WIDTH {w}', f'HEIGHT {h}', 'VIEWPOINT 0 0 0 1 0 0 0', f'POINTS {w * h}', 'DATA ascii', *(f'{(u - 40) / 60 * z} {(v - 30) / 60 * z} {z}' for v in range(h) for u in range(w) for z in [1 + (7 * u + 5 * v) % 11 / 2000]), sep='\n')" > seen.pcd && vpm-normals seen.pcd -o seen.vpmc --quiet
$ for raw in '' --raw-points; do vpm-query --tool cube.vpmg --cloud seen.vpmc --poses path.txt $raw -o seen$raw.jsonl; done
$ cmp -s seen.jsonl seen--raw-points.jsonl || python3 -c "import json; a, b = ([json.loads(l)['volume_fraction'] for l in open(f)] for f in ('seen.jsonl', 'seen--raw-points.jsonl')); print(max(abs(x - y) for x, y in zip(a, b)) < 0.01, max(a) > 0.1)"
True True
$ mkdir seen && cp seen.pcd seen/0.pcd && for raw in '' --raw-points; do vpm-query --tool cube.vpmg --frames seen --trajectory path.txt --rate 1 $raw --quiet | python3 -c "import json, sys; print([json.loads(l)['volume'] for l in sys.stdin])" | cmp - <(python3 -c "import json; print([json.loads(l)['volume'] for l in open('seen$raw.jsonl')])"); done

# A generous deadline changes nothing but the reason; an impossible one takes the coarsest level and says so.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --deadline-us 1e7 -o d.jsonl --stats stats.json && $VALIDATE query-result d.jsonl && $VALIDATE query-stats stats.json
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt | cmp - <(sed 's/,"level_reason":"deadline"//' d.jsonl)
$ python3 -c "import json; print(json.load(open('stats.json'))['deadline'])"
{'kept': 1.0, 'us': 10000000.0}
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 1% --deadline-us 0.001 | python3 -c "import json, sys; print([(r['level'], r['level_reason']) for r in map(json.loads, sys.stdin)])"
[(10, 'deadline missed'), (10, 'deadline missed'), (10, 'deadline missed')]

# The scene's level is as fine as the points resolve: they are 17 mm apart.
$ vpm-query --tool plain.vpmg --cloud wall.vpmc --poses path.txt --for-scene -o s.jsonl --stats stats.json --force && $VALIDATE query-result s.jsonl && $VALIDATE query-stats stats.json
2> vpm-query: note: the scene resolves spheres from 0.01* m (points 0.01* m apart, noise * m) to *: the level of 60 is enough (glob)
$ vpm-pack cube.off -o scene.vpmp --for-scene wall.vpmc --report pack.json && $VALIDATE pack-report pack.json
2> vpm-pack: note: the scene asks for spheres from 0.01* m (points 0.01* m apart, noise * m) to * (glob)
2> vpm-pack: note: packed * of the 1000 spheres asked for: no further sphere of at least --min-radius fits (glob)
2> vpm-pack: note: 81 spheres fill 73.1 % of a solid of 200 x 200 x 200 mm
$ python3 -c "import json; r = json.load(open('pack.json')); print(r['r_min'] >= r['scene']['smallest_radius'] > 0.01)"
True

# Impossible choices are refused.
$ vpm-query --tool plain.vpmg --cloud wall.vpmc --poses path.txt --max-error 1%
2> vpm-query: error: the tool model has no calibration; make it again with vpm-graph --calibrate
[1]
$ vpm-query --tool single.vpmg --cloud wall.vpmc --poses path.txt --max-error 1%
2> vpm-query: error: the tool model has one level only; make it again with vpm-graph --levels
[1]
$ vpm-query --tool single.vpmg --cloud wall.vpmc --poses path.txt --deadline-us 100
2> vpm-query: error: the tool model has one level only, so that a deadline cannot choose; make it again with vpm-graph --levels
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 0.0001%
2> vpm-query: error: no level of the tool model keeps an error of 0.0001 %; the best has * %: allow as much, or pack more spheres (glob)
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 5%%
2> vpm-query: error: --max-error 5%%: give a fraction of the tool's volume like 0.5% or 0.005
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 120%
2> vpm-query: error: the error must lie between 0 and 1 (0 % and 100 %)
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error 1% --measure paper
2> vpm-query: error: --max-error is about the refined measure, which calibrations measure; leave --measure paper out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --level 10 --for-scene
2> vpm-query: error: --level and --for-scene exclude each other: leave one of them out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --deadline-us 0
2> vpm-query: error: --deadline-us must be a positive number of microseconds
[2]
