# Which parts of an assembly share volume. The cube has an edge of 0.2 m.

$ mkdir parts && cp $SOURCE/tests/tools/inputs/*.off . && cp cube.off open.off parts && cp cube.off parts/again.off && echo hello > parts/notes.txt
$ echo "import json, sys; print(*([*l['parts'], float('%.6g' % l['volume']), float('%.6g' % l['volume_fraction']), [round(x, 4) + 0 for x in l['centroid']], l.get('allowed'), l.get('above'), l['unit']] for l in map(json.loads, sys.stdin)), sep='\n')" > near.py

# A mesh that is no solid is named with the cure, and hides no pair of others.
$ vpm-query --pairs parts > pairs.jsonl
2> vpm-query: error: part 'open.off' is left out: parts/open.off: the mesh is open: 3 edges of one triangle in 1 hole, a loop through (0.1, 0.1, 0.1); give --repair to fill planar and small holes
2> vpm-query: note: 2 parts, 1 pair shares volume
2> vpm-query: error: 1 of 3 parts is left out for what is said above
[1]
$ python3 near.py < pairs.jsonl && $VALIDATE pair-result pairs.jsonl
['again.off', 'cube.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
$ vpm-query --pairs parts --repair --quiet | python3 near.py
['again.off', 'cube.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
['again.off', 'open.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
['cube.off', 'open.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
$ vpm-query --pairs parts --repair voxel=24 | python3 near.py
['again.off', 'cube.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
['again.off', 'open.off', 0.00795797, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
['cube.off', 'open.off', 0.00795797, 1.0, [0.0, 0.0, 0.0], None, None, 'm']
2> vpm-query: note: 3 parts, 3 pairs share volume
$ vpm-query --pairs parts --fail-above 0.007 --quiet -o found.csv || echo $?; cat found.csv | cut -d, -f1,2,11,12
10
part_a,part_b,above,unit
again.off,cube.off,true,m
2> vpm-query: error: part 'open.off' is left out: parts/open.off: the mesh is open: 3 edges of one triangle in 1 hole, a loop through (0.1, 0.1, 0.1); give --repair to fill planar and small holes
$ vpm-query --pairs parts --fail-above 0.009 --quiet | python3 near.py
['again.off', 'cube.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, False, 'm']
2> vpm-query: error: part 'open.off' is left out: parts/open.off: the mesh is open: 3 edges of one triangle in 1 hole, a loop through (0.1, 0.1, 0.1); give --repair to fill planar and small holes
2> vpm-query: error: 1 of 3 parts is left out for what is said above
[1]
$ rm parts/open.off; vpm-query --pairs parts --fail-above 0.009 | sed 's/"above":false,//' | cmp - pairs.jsonl
2> vpm-query: note: 2 parts, 1 pair shares volume
$ ln -s gone.off parts/link.off; vpm-query --pairs parts | cmp - pairs.jsonl; rm parts/link.off
2> vpm-query: error: part 'link.off' is left out: cannot read parts/link.off: No such file or directory
2> vpm-query: note: 2 parts, 1 pair shares volume
2> vpm-query: error: 1 of 3 parts is left out for what is said above

# Parts that touch share nothing, as a tool and solids do; a corner of .08 mm is told.
$ printf '%s\n' '{"unit":"m","parts":[{"mesh":"cube.off","name":"a"},{"mesh":"cube.off","name":"b","pose":[0.2,0.05,0.1,0,0,0,1]},{"mesh":"cube.off","name":"c","pose":[-0.19992,-0.19992,-0.19992,0,0,0,1]}]}' > touching.json && vpm-query --pairs touching.json --fail-above 0 --quiet | python3 near.py
['a', 'c', 5.12e-13, 6.4e-11, [-0.1, -0.1, -0.1], None, True, 'm']
[10]
$ vpm-pack cube.off -o touch.vpmp --spheres 10 --quiet && vpm-graph touch.vpmp -o touch.vpmg && vpm-query --tool touch.vpmg --solid cube.off --pose 0.2,0.05,0.1,0,0,0,1 --collides --fail-above 0 | grep -o '"collides.*'
"collides":"no","above":false}
$ vpm-query --pairs parts --unit mm | python3 near.py
['again.off', 'cube.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'mm']
2> vpm-query: warning: parts/again.off: the mesh is 0.0002 m across: if it was scaled to metres twice, give another --unit
2> vpm-query: note: 2 parts, 1 pair shares volume

# Poses, press fits and pairs that may overlap.
$ echo '{"unit": "mm", "parts": [{"mesh": "mm.off", "name": "hub"}, {"mesh": "mm.off", "name": "shaft 1", "pose": [199, 0, 0, 0, 0, 0, 1]}, {"mesh": "mm.off", "name": "shaft 2", "pose": {"position": {"x": 0, "y": 200, "z": 0}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}}, {"mesh": "mm.off", "name": "pin", "pose": [0, 0, -199.9, 0, 0, 0, 1]}], "allowed": [{"parts": ["shaft *", "hub"], "volume": 40000}, {"parts": ["hub", "p*n"]}]}' > fit.json
$ python3 -c "print(*(l if k < 2 or k > 9 else ' '.join(str(1000 * float(x)) for x in l.split()) for k, l in enumerate(open('cube.off').read().splitlines())), sep='\n')" > mm.off
$ vpm-query --pairs fit.json --fail-above 0 > fit.jsonl; python3 near.py < fit.jsonl; $VALIDATE assembly fit.json; $VALIDATE pair-result fit.jsonl
['hub', 'shaft 1', 40000.0, 0.005, [99.5, 0.0, 0.0], 40000.0, False, 'mm']
['hub', 'pin', 4000.0, 0.0005, [0.0, 0.0, -99.95], 'any', False, 'mm']
['shaft 1', 'pin', 20.0, 2.5e-06, [99.5, 0.0, -99.95], None, True, 'mm']
2> vpm-query: note: 'shaft 1' and 'pin' share 20 mm³, above 0
2> vpm-query: note: 4 parts, 3 pairs share volume
$ for n in 1 2 7; do vpm-query --pairs fit.json --fail-above 0 --threads $n --quiet | cmp - fit.jsonl; done
[10]
$ echo '{"id": "shaft 1", "pose": [198.9, 0, 0, 0, 0, 0, 1]}' > moved.jsonl; vpm-query --pairs fit.json --poses moved.jsonl --fail-above 0 | python3 near.py
['hub', 'shaft 1', 44000.0, 0.0055, [99.45, 0.0, 0.0], 40000.0, True, 'mm']
['hub', 'pin', 4000.0, 0.0005, [0.0, 0.0, -99.95], 'any', False, 'mm']
['shaft 1', 'pin', 22.0, 2.75e-06, [99.45, 0.0, -99.95], None, True, 'mm']
2> vpm-query: note: 'hub' and 'shaft 1' share 44000 mm³, above 40000
2> vpm-query: note: 'shaft 1' and 'pin' share 22 mm³, above 0
2> vpm-query: note: 4 parts, 3 pairs share volume
[10]
$ vpm-query --pairs - --fail-above 0 --quiet < fit.json | cmp - fit.jsonl
[10]
$ vpm-query --pairs fit.json --fail-above 0 --dump-config > call.json && $VALIDATE config.vpm-query call.json && vpm-query --config call.json --quiet | cmp - fit.jsonl
[10]

# Contacts: three pins in a block, in mm; the last sums what was not asked for.
$ echo '{"unit": "mm", "parts": [{"mesh": "block.off"}, {"mesh": "pins.off"}]}' > comb.json; echo "import json; print(*([[round(v, 3) + 0 for v in (c['volume'], *c['centroid'], *c['normal'], c['area'], c['depth'])] + [c['patches']] for c in json.loads(open('comb.jsonl').readline())['contacts']]), sep='\n')" > contacts.py
$ vpm-query --pairs comb.json --contacts --quiet -o comb.jsonl && python3 contacts.py && $VALIDATE pair-result comb.jsonl
[200.0, 51.0, 20.0, 19.75, 0.0, 0.0, 1.0, 400.0, 0.5, 1]
[50.0, 16.0, 15.0, 19.75, 0.0, 0.0, 1.0, 100.0, 0.5, 1]
[12.5, 77.5, 12.5, 19.75, 0.0, 0.0, 1.0, 25.0, 0.5, 1]
$ vpm-query --pairs comb.json --contacts 1 --quiet --force -o comb.jsonl && python3 contacts.py && $VALIDATE pair-result comb.jsonl
[200.0, 51.0, 20.0, 19.75, 0.0, 0.0, 1.0, 400.0, 0.5, 1]
[62.5, 28.3, 14.5, 19.75, 0.0, 0.0, 1.0, 125.0, 0.5, 2]
$ vpm-query --pairs comb.json --contacts 0
2> vpm-query: error: --contacts: 0 is not a whole number from 1 to 1048576 (see vpm-query --help)
[2]

# A model is in metres, whatever the unit of the others.
$ vpm-pack cube.off -o cube.vpmp --spheres 10 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet && vpm-graph cube.vpmp -o bare.vpmg --no-surface --quiet
$ echo '{"unit": "mm", "parts": [{"mesh": "mm.off"}, {"mesh": "cube.vpmg", "pose": [0, 0, 150, 0, 0, 0, 1]}]}' | vpm-query --pairs - --quiet | python3 near.py
['mm.off', 'cube.vpmg', 2000000.0, 0.25, [0.0, 0.0, 75.0], None, None, 'mm']
$ echo '{"parts": [{"mesh": "cube.off"}, {"mesh": "bare.vpmg"}, {"mesh": "gone.stl"}, {"mesh": "near.py"}]}' | vpm-query --pairs -
2> vpm-query: error: part 'bare.vpmg' is left out: bare.vpmg: the tool model keeps no surface, by which solids are measured; make it again by vpm-graph, without --no-surface
2> vpm-query: error: part 'gone.stl' is left out: cannot read gone.stl: No such file or directory
2> vpm-query: error: part 'near.py' is left out: near.py: this is no mesh in a format that is read here: OBJ, OFF, PLY, STL, OM, COLLADA, glTF, 3MF or FBX; save it as OBJ, PLY or STL in the program that wrote it
2> vpm-query: note: 1 part, 0 pairs share volume
2> vpm-query: error: 3 of 4 parts are left out for what is said above
[1]

# What is not said clearly is refused.
$ p='{"mesh": "cube.off", "name": "a"}, {"mesh": "cube.off", "name": "housing"}'; for j in '' '[]' '{"parts": [' '{}' '{"parts": 3}' '{"parts": [{"mesh": "cube.off"}]}' '{"parts": [{"mesh": "cube.off"}, {"mesh": "cube.off"}]}' "{\"parst\": [$p]}" "{\"parts\": [$p], \"colour\": 1}" '{"parts": [{"mesh": "cube.off", "psoe": []}]}' '{"parts": [{"name": "x"}]}' '{"parts": [{"mesh": 3}]}' '{"parts": [{"mesh": "cube.off", "pose": [0, 0, 0]}]}' '{"parts": [{"mesh": "cube.off", "pose": [NaN, 0, 0, 0, 0, 0, 1]}]}' '{"parts": [{"mesh": "cube.off", "pose": [1e999, 0, 0, 0, 0, 0, 1]}]}' '{"parts": [{"mesh": "cube.off", "pose": [0, 0, 0, 0, 0, 0, 2]}]}' "{\"parts\": [$p], \"unit\": \"inch\"}" "{\"parts\": [$p], \"allowed\": [{\"parts\": [\"a\", \"housin\"]}]}" "{\"parts\": [$p], \"allowed\": [{\"parts\": [\"a\"]}]}" "{\"parts\": [$p], \"allowed\": [{\"parts\": [\"a\", \"z*\"]}]}" "{\"parts\": [$p], \"allowed\": [{\"parts\": [\"a\", \"*\"], \"volume\": -1}]}" "{\"parts\": [$p], \"parts\": []}"; do echo "$j" | vpm-query --pairs -; done
2> vpm-query: error: standard input: it is not JSON: it cannot be read from line 2 on
2> vpm-query: error: standard input: it is no object; write {"parts": …}
2> vpm-query: error: standard input: it is not JSON: it cannot be read from line 2 on
2> vpm-query: error: standard input: there is no part; an assembly has two closed meshes (.stl, .obj, .ply, …) or models (.vpmg) at least, each in a file of its own
2> vpm-query: error: standard input: "parts" is no list; write it in brackets, [ … ]
2> vpm-query: error: standard input: there is one part only; an assembly has two closed meshes (.stl, .obj, .ply, …) or models (.vpmg) at least, each in a file of its own
2> vpm-query: error: standard input: parts 0 and 1 have one name, 'cube.off'; give each a "name" of its own
2> vpm-query: error: standard input: there is no key 'parst'; is 'parts' meant?
2> vpm-query: error: standard input: there is no key 'colour'; known are parts, unit, allowed
2> vpm-query: error: standard input, part 0: there is no key 'psoe'; is 'pose' meant?
2> vpm-query: error: standard input, part 0: "mesh" is missing; name the part's file
2> vpm-query: error: standard input, part 0: "mesh" is no text; write it in quotation marks
2> vpm-query: error: standard input, part 0: "pose": found 3 numbers; a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by row), or 12 without the last row
2> vpm-query: error: standard input: it is not JSON: it cannot be read from line 1 on
2> vpm-query: error: standard input: it is not readable: one of its numbers is beyond what a double holds
2> vpm-query: error: standard input, part 0: "pose": the quaternion has length 2.000000 instead of 1; give x,y,z,w of a unit quaternion
2> vpm-query: error: standard input: "unit" is 'inch'; give m, cm, mm, um, in or ft
2> vpm-query: error: standard input, allowed pair 0: there is no part 'housin'; is 'housing' meant?
2> vpm-query: error: standard input, allowed pair 0: "parts" is no list of two names; write {"parts": ["shaft", "hub"]}
2> vpm-query: error: standard input, allowed pair 0: there is no part 'z*'; the parts are a, housing
2> vpm-query: error: standard input, allowed pair 0: "volume" is no number of at least 0; give the volume that the two may share, in the unit's cube
2> vpm-query: error: standard input: it is ambiguous: it gives "parts" twice; leave one of them out
[1]
$ mkdir empty; vpm-query --pairs empty; cp cube.off empty; vpm-query --pairs empty; vpm-query --pairs gone; vpm-query --pairs cube.off
2> vpm-query: error: empty: there is no part; an assembly has two closed meshes (.stl, .obj, .ply, …) or models (.vpmg) at least, each in a file of its own
2> vpm-query: error: empty: there is one part only; an assembly has two closed meshes (.stl, .obj, .ply, …) or models (.vpmg) at least, each in a file of its own
2> vpm-query: error: cannot read gone: No such file or directory
2> vpm-query: error: --pairs cube.off is a mesh: give the folder of all parts, or a description (assembly.json)
[2]
$ mkdir -p deep/a/b deep/.old; cp cube.off deep; cp cube.off deep/other.off; cp cube.off deep/a; cp cube.off deep/a/b; cp cube.off deep/.old; echo x > deep/a/notes.txt; vpm-query --pairs deep --quiet | wc -l; vpm-query --pairs deep > pairs.jsonl
1
2> vpm-query: note: deep: 2 parts in its folders are left out, since a folder's own files are its parts
2> vpm-query: note: 2 parts, 1 pair shares volume
$ for l in '{"id": "hubb", "pose": [0, 0, 0, 0, 0, 0, 1]}' '0 0 0 0 0 0 1' '{"id": 3, "pose": [0, 0, 0, 0, 0, 0, 1]}' '' '{"id": "hub", "pose": [NaN, 0, 0, 0, 0, 0, 1]}'; do echo "$l" | vpm-query --pairs fit.json --poses -; done
2> vpm-query: error: standard input, line 1: there is no part 'hubb'; is 'hub' meant?
2> vpm-query: error: standard input, line 1: the pose has no "id" that names its part; write {"id": "hub", "pose": […]}
2> vpm-query: error: standard input, line 1: the pose has no "id" that names its part; write {"id": "hub", "pose": […]}
2> vpm-query: error: standard input: no pose in it; each line gives one: tx ty tz qx qy qz qw, or JSON
2> vpm-query: error: standard input, line 1: not JSON; write each pose as [tx,ty,tz,qx,qy,qz,qw], or in an object as "pose"
[1]
$ printf '%s\n' '{"id": "hub", "pose": [0, 0, 0, 0, 0, 0, 1]}' '{"id": "hub", "pose": [0, 0, 1, 0, 0, 0, 1]}' | vpm-query --pairs fit.json --poses -
2> vpm-query: error: standard input, line 2: the part 'hub' has two poses; leave one of them out
[1]
$ vpm-query --pairs fit.json --unit cm
2> vpm-query: error: --unit cm, but fit.json is in mm: leave --unit out
[2]
$ vpm-query --pairs fit.json --unit inch
2> vpm-query: error: --unit: inch not in {m,cm,mm,um,in,ft} (see vpm-query --help)
[2]
$ vpm-query --pairs fit.json --fail-above -1
2> vpm-query: error: --fail-above: -1 is not a number from 0 to 1e+300 (see vpm-query --help)
[2]
$ vpm-query --pairs fit.json --repair glue
2> vpm-query: error: --repair glue: give holes, voxel, voxel=RES, flood or flood=RES
[2]
$ vpm-query --pairs fit.json --tool cube.vpmg --stiffness 5
2> vpm-query: error: --tool and --stiffness do not go with pairs of an assembly, chosen by --pairs: leave them out
[2]
$ vpm-query --tool cube.vpmg --solid cube.off --pose 0,0,0,0,0,0,1 --fail-above 1 --unit mm
2> vpm-query: error: --unit does not go with poses in a cloud, chosen because --frames is not given: leave it out
[2]
$ vpm-query --pairs - --poses - < fit.json
2> vpm-query: error: only one of --tool, --cloud, --pairs, --poses and --joints can be standard input
[2]

# Sizes in the wrong unit draw one warning, with the cure; a tiny part beside others is right.
$ mkdir large; for k in 1 2 3 4 5 6 7; do sed "3s/\$/$k/" mm.off > large/$k.off; done; vpm-query --pairs large --quiet | wc -l
21
2> vpm-query: warning: large/1.off: the mesh is 200 m across: if its unit is the millimetre, give --unit mm
$ mkdir mixed; cp mm.off mixed/box.off; python3 -c "print(*(l if k < 2 or k > 9 else ' '.join(str(float(x) / 1000) for x in l.split()) for k, l in enumerate(open('mm.off').read().splitlines())), sep='\n')" > mixed/ball.off; vpm-query --pairs mixed --unit mm | python3 near.py
['ball.off', 'box.off', 0.008, 1.0, [0.0, 0.0, 0.0], None, None, 'mm']
2> vpm-query: note: 2 parts, 1 pair shares volume
