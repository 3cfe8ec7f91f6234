# Contacts of a tool, a cube with an edge of 0.2 m, with the bodies of its scene: a wall that a camera sees, and solids.

$ cp $SOURCE/tests/tools/inputs/* . && cp $SOURCE/formats/golden/v1/surface.vpmg cube.vpmg && vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' 'import json, sys' 'for r in map(json.loads, sys.stdin):' '  for l in (r["contacts"], r["contacts"][::-1]):' '    assert sum(c["volume"] for c in l) == r["volume"]' '    assert all([sum(c[f][k] for c in l) for k in range(3)] == r[f] for f in ("force", "torque"))' '  if r["contacts"]: print(*([c["body"], c["patches"]] + [round(x, 3) + 0 for x in (1000 * c["volume"], *c["centroid"], *c["normal"], c["area"], c["depth"])] for c in r["contacts"]), sep="\n")' > sums.py
$ echo 'scene="--cloud wall.vpmc --solid cube.off@0.15,0,0.9,0,0,0,1 --solid cube.off@-0.17,0.03,0.95,0,0,0,1"' > names
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0 0 0.7 0 0 0 1' '0 0 0.5 0 0 0 1' > poses.txt
$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt --contacts > contacts.jsonl && python3 sums.py < contacts.jsonl && $VALIDATE query-result contacts.jsonl
[0, 1, 2.0, 0.0, 0.0, 1.024, 0.0, 0.0, 1.0, 0.046, 0.05]
[1, 1, 1.5, 0.075, 0.0, 0.925, 0.923, -0.231, -0.308, 0.032, 0.05]
[2, 1, 1.02, -0.085, 0.015, 0.95, -0.974, 0.172, -0.146, 0.035, 0.03]








$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt --contacts 1 --stiffness 3e4 | python3 sums.py
[0, 1, 2.0, 0.0, 0.0, 1.024, 0.0, 0.0, 1.0, 0.046, 0.05]
[None, 2, 2.52, 0.01, 0.006, 0.935, -0.255, -0.096, -0.962, 0.016, 0.05]









# They change nothing else, and are the same however poses are asked.
$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt > plain.jsonl; python3 -c "import json; print([all(abs(x - y) < 1e-15 for f in ('force', 'torque') for x, y in zip(a[f], b[f])) and {k: v for k, v in a.items() if k not in ('force', 'torque', 'contacts')} == {k: v for k, v in b.items() if k not in ('force', 'torque')} for a, b in (map(json.loads, l) for l in zip(open('contacts.jsonl'), open('plain.jsonl')))])"
[True, True, True]
$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt --contacts --batch 2 --threads 2 | cmp - contacts.jsonl; vpm-query --tool cube.vpmg --tool cube.vpmg $scene --poses poses.txt --contacts --batch 2 | sed -n 's/"tool":1,//p' | cmp - contacts.jsonl
$ . ./names; sed 's/ /,/g; s/.*/{"pose":[&]}/' poses.txt | vpm-query --tool cube.vpmg $scene --contacts --serve | cmp - contacts.jsonl
$ for k in 0 1; do echo "$k wall.vpmc"; done > list.txt; awk '{print NR - 1, $0}' poses.txt > path.txt; vpm-query --tool cube.vpmg --frames list.txt --poses path.txt --rate 1 --contacts --quiet | python3 sums.py
[0, 1, 2.0, 0.0, 0.0, 1.024, 0.0, 0.0, 1.0, 0.046, 0.05]








$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt --contacts --dump-config > call.json && $VALIDATE config.vpm-query call.json && vpm-query --config call.json | cmp - contacts.jsonl
$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt --contacts -o contacts.csv && python3 -c "import csv, json; print(all(json.loads(r['contacts']) == json.loads(l)['contacts'] for r, l in zip(csv.DictReader(open('contacts.csv')), open('contacts.jsonl'))))"
True
$ . ./names; vpm-query --tool cube.vpmg $scene --poses poses.txt --contacts --view page.html --quiet > /dev/null && python3 -c "import json; p = open('page.html').read(); d = json.JSONDecoder().raw_decode(p, p.index('{', p.index('id=\"data\"')))[0]; print([(l['step'], l['count']) for l in d['layers'] if l['name'] == 'contacts'], 'contacts' in [c['name'] for c in d['columns']])"
[(0, 3)] True
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,1,0,0,0,1 --contacts --measure paper
2> vpm-query: error: contacts are a matter of the refined measure on the CPU; leave the other measure or device out
[2]
