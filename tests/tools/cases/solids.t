# A tool among solids. The cube has an edge of 0.2 m, so what two of them share is known.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 60 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 20 --quiet && vpm-graph cube.vpmp -o bare.vpmg --no-surface --quiet
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ echo "import json, sys; print([round(json.loads(l)['volume'], 10) + 0 for l in sys.stdin])" > near.py
$ vpm-query --tool cube.vpmg --solid cube.vpmg@0.15,0,0,0,0,0,1 --pose 0,0,0,0,0,0,1 > one.jsonl && python3 near.py < one.jsonl && $VALIDATE query-result one.jsonl
[0.002]
$ for x in 0 0.2 0.3; do vpm-query --tool cube.vpmg --solid cube.vpmg --pose $x,0,0,0,0,0,1 | python3 near.py; done
[0.008]
[0.0]
[0.0]

# Force and torque have the units of clouds: against a wall much larger than the tool, stiffness times volume.
$ python3 -c "print('OFF 8 12 0'); [print(x, y, z) for z in (0, 1) for y in (-2, 2) for x in (-2, 2)]; print(*('3 0 2 3', '3 0 3 1', '3 4 5 7', '3 4 7 6', '3 0 1 5', '3 0 5 4', '3 2 6 7', '3 2 7 3', '3 0 4 6', '3 0 6 2', '3 1 3 7', '3 1 7 5'), sep='\n')" > wall.off
$ vpm-query --tool cube.vpmg --solid wall.off --pose 0.1,0.2,-0.05,0,0,0,1 --stiffness 1e5 --quiet | python3 -c "import json, sys; r = json.load(sys.stdin); print([round(x, 3) + 0 for x in r['force'] + r['torque']], r['closure'] <= 1e-8)"
[0.0, 0.0, -200.0, 0.0, 0.0, 0.0] True

# A mesh is taken for the solid, and for both.
$ vpm-query --tool cube.vpmg --solid cube.off@0.15,0,0,0,0,0,1 --pose 0,0,0,0,0,0,1 | cmp - one.jsonl
$ vpm-query --tool cube.off --solid cube.off@0.15,0,0,0,0,0,1 --pose 0,0,0,0,0,0,1 --quiet | python3 near.py
[0.002]

# Solids move with the pose, in the order of --solid, or stay.
$ printf '%s\n' '{"tool":[0,0,0,0,0,0,1],"solids":[[0.15,0,0,0,0,0,1],[0,0.1,0,0,0,0,1]]}' '{"id":"stay","pose":[0,0,0,0,0,0,1]}' '{"solids":[{"pose":[0.18,0,0,0,0,0,1]},{"position":{"x":0,"y":0,"z":9},"orientation":{"x":0,"y":0,"z":0,"w":1}}],"tool":{"pose":[0,0,0,0,0,0,1]}}' > moves.jsonl
$ vpm-query --tool cube.vpmg --solid cube.vpmg@0,0,0.19,0,0,0,1 --solid cube.off@9,9,9,0,0,0,1 --poses moves.jsonl > moved.jsonl && python3 near.py < moved.jsonl
[0.006, 0.0004, 0.0008]
$ vpm-query --tool cube.vpmg --solid cube.vpmg@0,0,0.19,0,0,0,1 --solid cube.off@9,9,9,0,0,0,1 --poses moves.jsonl --batch 3 | cmp - moved.jsonl
$ vpm-query --tool cube.vpmg --tool cube.vpmg --solid cube.vpmg@0,0,0.19,0,0,0,1 --solid cube.off@9,9,9,0,0,0,1 --poses moves.jsonl | sed -n 's/"tool":1,//p' | cmp - moved.jsonl
$ vpm-query --tool cube.vpmg --solid cube.vpmg@0,0,0.19,0,0,0,1 --solid cube.off@9,9,9,0,0,0,1 --poses moves.jsonl --dump-config > call.json && $VALIDATE config.vpm-query call.json && vpm-query --config call.json | cmp - moved.jsonl

# Bodies add up, whatever their order; --bodies lists the parts, which are what each gives alone.
$ echo 'a=cube.vpmg@0.15,0,0.9,0,0,0,1 b=cube.vpmg@0,-0.13,0.9,0.1,0,0,0.99498743710662 pose=0,0,0.95,0,0,0,1' > names
$ . ./names; vpm-query --tool cube.vpmg --cloud wall.vpmc --solid $a --solid $b --pose $pose > all.jsonl && vpm-query --tool cube.vpmg --solid $b --cloud wall.vpmc --solid $a --pose $pose | cmp - all.jsonl
$ . ./names; vpm-query --tool cube.vpmg --cloud wall.vpmc --solid $a --solid $b --pose $pose --bodies > parts.jsonl && $VALIDATE query-result parts.jsonl && sed 's/,"bodies":.*/}/' parts.jsonl | cmp - all.jsonl
$ . ./names; for s in "--cloud wall.vpmc" "--solid $a" "--solid $b"; do vpm-query --tool cube.vpmg $s --pose $pose; done > alone.jsonl; python3 -c "import json; r = json.load(open('parts.jsonl')); alone = [json.loads(l) for l in open('alone.jsonl')]; print([p == {'body': k} | {f: alone[k][f] for f in ('volume', 'force', 'torque')} for k, p in enumerate(r['bodies'])], abs(r['volume_fraction'] - sum(o['volume_fraction'] for o in alone)) < 4e-16)"
[True, True, True] True
$ . ./names; vpm-query --tool cube.vpmg --cloud wall.vpmc --solid $a --pose $pose --bodies -o parts.csv && python3 -c "import csv, json; r = next(csv.DictReader(open('parts.csv'))); print(len(json.loads(r['bodies'])), 0 <= float(r['closure']) <= 1e-8)"
2 True

# What cannot be measured is refused, with the cure.
$ vpm-query --tool cube.vpmg --solid bare.vpmg --pose 0,0,0,0,0,0,1; vpm-query --tool bare.vpmg --solid cube.vpmg --pose 0,0,0,0,0,0,1
2> vpm-query: error: bare.vpmg: the tool model keeps no surface, by which solids are measured; make it again by vpm-graph, without --no-surface
2> vpm-query: error: bare.vpmg: the tool model keeps no surface, by which solids are measured; make it again by vpm-graph, without --no-surface
[1]
$ vpm-query --tool cube.vpmg --solid cube.vpmg --poses moves.jsonl; vpm-query --tool cube.vpmg --cloud wall.vpmc --poses moves.jsonl
2> vpm-query: error: moves.jsonl, line 1: "solids" has 2 poses, but --solid is given 1 time; give one for each, or leave "solids" out
2> vpm-query: error: moves.jsonl, line 1: "solids" has 2 poses, but --solid is given 0 times; give one for each, or leave "solids" out
[1]
$ for l in '{"tool":[0,0,0,0,0,0,1],"solids":[]}' '{"tool":[0,0,0,0,0,0,1],"solids":[0,0,0,0,0,0,1]}' '{"tool":[0,0,0,0,0,0,1],"solids":[[0,0,0,0,0,0]]}' '{"tool":[0,0,0,0,0,0,1],"solids":[[0,0,0,0,0,0,0]]}' '{"tool":3}'; do echo "$l" | vpm-query --tool cube.vpmg --solid cube.vpmg --poses -; done
2> vpm-query: error: standard input, line 1: "solids" is no list of poses; write one for each solid, [[tx,ty,tz,qx,qy,qz,qw], …]
2> vpm-query: error: standard input, line 1: "solids" is no list of poses; write one for each solid, [[tx,ty,tz,qx,qy,qz,qw], …]
2> vpm-query: error: standard input, line 1: solid 0 of "solids": found 6 numbers, like a position with three angles; write tx ty tz qx qy qz qw, the last four by SciPy's Rotation.from_euler(...) or from_rotvec(...), with as_quat()
2> vpm-query: error: standard input, line 1: solid 0 of "solids": the quaternion has length 0.000000 instead of 1; give x,y,z,w of a unit quaternion
2> vpm-query: error: standard input, line 1: no pose in the object; it has "tool"; give "pose" (7 numbers) or "matrix" (4x4 by rows), or "position" with x, y, z and "orientation" with x, y, z, w
[1]
$ vpm-query --tool cube.vpmg --solid cube.vpmg@1,2,3 --pose 0,0,0,0,0,0,1
2> vpm-query: error: --solid: expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found 3 in '1,2,3'
[2]
$ vpm-query --tool cube.vpmg --solid gone.vpmg@1,2,3,0,0,0,1 --pose 0,0,0,0,0,0,1
2> vpm-query: error: cannot read gone.vpmg: No such file or directory
[1]
$ vpm-query --tool cube.vpmg --solid wall.vpmc --pose 0,0,0,0,0,0,1
2> vpm-query: error: wall.vpmc: this is a cloud (.vpmc); needed is a tool model (.vpmg), which vpm-graph writes
[1]
$ vpm-query --tool cube.vpmg --solid cube.vpmg --pose 0.1,0,0,0,0,0,1 --measure paper | grep -o '"measure":"paper"\|"closure"'
"measure":"paper"
$ vpm-query --tool cube.vpmg --solid cube.off --pose 0,0,0,0,0,0,1 --measure paper
2> vpm-query: error: the measure as printed takes the spheres of solids, and body 0, counted from 0, is a mesh without them; give its tool model (.vpmg) instead, or leave the measure out
[2]
$ vpm-query --tool cube.vpmg --solid cube.vpmg --pose 0,0,0,0,0,0,1 --for-scene
2> vpm-query: error: a level by scene or deadline is chosen by points, and the scene has solids only; leave that choice out, or add a cloud
[2]
$ vpm-query --tool cube.vpmg --solid - --pose 0,0,0,0,0,0,1
2> vpm-query: error: --solid is a file: standard input holds none
[2]

# Along paths solids move as the tool does, between poses too: each step has the answer of its poses alone.
$ printf '%s\n' '{"time":0,"tool":[0,0,0,0,0,0,1],"solids":[[0.19,0,0,0,0,0,1]]}' '{"time":0.02,"tool":[0.001,0,0,0,0,0,1],"solids":[[0.17,0,0,0,0,0,1]]}' > path.jsonl
$ vpm-query --tool cube.vpmg --solid cube.off --poses path.jsonl --coupling stiffness=500,damping=5 --stiffness 2e4 --quiet > steps.jsonl && $VALIDATE coupling-step steps.jsonl
$ python3 -c "import json; [print(json.dumps({'tool': s['tool'], 'solids': [[0.19 - 0.001 * s['step'], 0, 0, 0, 0, 0, 1]]})) for s in map(json.loads, open('steps.jsonl'))]" > alone.jsonl && wc -l < alone.jsonl
21
$ vpm-query --tool cube.vpmg --solid cube.off --poses alone.jsonl > answers.jsonl && python3 -c "import json; print(max(abs(json.loads(a)['volume'] - json.loads(b)['volume']) for a, b in zip(open('steps.jsonl'), open('answers.jsonl'))) < 1e-12)"
True
$ tail -n 1 steps.jsonl | python3 -c "import json; s = json.loads(input()); print(s['volume'] > 6e-4, s['tool'][0] < s['device'][0], s['force'][0] < 0)"
True True True
$ mkdir frames && cp wall.vpmc frames/0.0.vpmc && cp wall.vpmc frames/0.01.vpmc
$ vpm-query --tool cube.vpmg --solid cube.off --frames frames --poses path.jsonl --quiet > steps.jsonl && python3 -c "import json; print(max(abs(s['volume'] - 0.04 * (0.01 + 1.05e-3 * s['pose'])) for s in map(json.loads, open('steps.jsonl'))) < 1e-10)"
True
$ vpm-query --tool cube.vpmg --tool cube.vpmg --solid cube.off --frames frames --poses path.jsonl --quiet | sed -n 's/"tool":1,//p' | cmp - steps.jsonl
$ vpm-query --tool cube.vpmg --tool cube.vpmg --solid cube.off --frames frames --poses path.jsonl --poses path.jsonl
2> vpm-query: error: path.jsonl: "solids" move with the first path only; give them in path.jsonl
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.jsonl --coupling stiffness=500,damping=5 --stiffness 2e4
2> vpm-query: error: path.jsonl: "solids" has 1 pose, but --solid is given 0 times; give one for each, or leave "solids" out
[1]
$ vpm-query --tool cube.vpmg --frames frames --poses path.jsonl --camera-poses path.jsonl --quiet
2> vpm-query: error: path.jsonl: "solids" has 1 pose, but --solid is given 0 times; give one for each, or leave "solids" out
[1]

# A page has each solid at its poses: where it was made at those that leave the solids where they are, or once if none moves any.
$ vpm-query --tool cube.vpmg --solid cube.vpmg@0,0,0.19,0,0,0,1 --solid cube.off@9,9,9,0,0,0,1 --poses moves.jsonl --view moves.html --quiet | cmp - moved.jsonl && python3 $SOURCE/tests/tools/page_bodies.py moves.html
cube.vpmg in cube.vpmg, cube.off | overview side contact all
tool's mesh, solid cube.vpmg, solid cube.off
tool cube.vpmg [0.0, 0.0, 0.0] [0.0, 0.0, 0.0] [0.0, 0.0, 0.0]
solid cube.vpmg [0.15, 0.0, 0.0] [0.0, 0.0, 0.19] [0.18, 0.0, 0.0]
solid cube.off [0.0, 0.1, 0.0] [9.0, 9.0, 9.0] [0.0, 0.0, 9.0]
$ for more in "--batch 2" "--tool cube.off"; do vpm-query --tool cube.vpmg $more --solid cube.vpmg@0,0,0.19,0,0,0,1 --solid cube.off@9,9,9,0,0,0,1 --poses moves.jsonl --view more.html --force --quiet > /dev/null && python3 $SOURCE/tests/tools/page_bodies.py more.html | tail -n 2; done
solid cube.vpmg [0.15, 0.0, 0.0] [0.0, 0.0, 0.19] [0.18, 0.0, 0.0]
solid cube.off [0.0, 0.1, 0.0] [9.0, 9.0, 9.0] [0.0, 0.0, 9.0]
solid cube.vpmg [0.15, 0.0, 0.0] [0.0, 0.0, 0.19] [0.18, 0.0, 0.0]
solid cube.off [0.0, 0.1, 0.0] [9.0, 9.0, 9.0] [0.0, 0.0, 9.0]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --solid cube.vpmg@0.5,0,0.9,0,0,0,1 --pose 0.4,0,0.9,0,0,0,1 --view mixed.html --quiet > /dev/null && python3 $SOURCE/tests/tools/page_bodies.py mixed.html
cube.vpmg in wall.vpmc, cube.vpmg | overview camera side contact all
tool's mesh, solid cube.vpmg
tool cube.vpmg [0.4, 0.0, 0.9]
solid cube.vpmg [0.5, 0.0, 0.9]
$ vpm-query --tool cube.vpmg --solid cube.off --frames frames --poses path.jsonl --view frames.html --quiet > /dev/null && python3 $SOURCE/tests/tools/page_bodies.py frames.html | cut -c 1-60
cube.vpmg in frames, cube.off | overview camera side contact
tool's mesh, solid cube.off
tool cube.vpmg [0.0, 0.0, 0.0] [0.0, 0.0, 0.0] [0.0, 0.0, 0.
solid cube.off [0.19, 0.0, 0.0] [0.189, 0.0, 0.0] [0.188, 0.
$ vpm-query --tool cube.vpmg --solid cube.off --poses path.jsonl --coupling stiffness=500,damping=5 --stiffness 2e4 --view coupled.html --quiet > /dev/null && python3 $SOURCE/tests/tools/page_bodies.py coupled.html | cut -c 1-60
cube.vpmg in cube.off | overview side contact all
tool's mesh, solid cube.off
tool cube.vpmg [0.0, 0.0, 0.0] [0.0, 0.0, 0.0] [-0.001, 0.0,
solid cube.off [0.19, 0.0, 0.0] [0.189, 0.0, 0.0] [0.188, 0.

# Bodies of batches are those of single poses.
$ vpm-query --tool cube.vpmg --solid cube.vpmg --solid cube.off --poses moves.jsonl --bodies > one.jsonl && vpm-query --tool cube.vpmg --solid cube.vpmg --solid cube.off --poses moves.jsonl --bodies --batch 2 | cmp - one.jsonl
$ sed '2s/,"solids.*/}/' path.jsonl > uneven.jsonl && vpm-query --tool cube.vpmg --solid cube.off --frames frames --poses uneven.jsonl --quiet
2> vpm-query: error: uneven.jsonl, line 2: "solids" has 0 poses, and those before have 1; give every pose of a path as many, or none
[1]
$ sed 's/,"solids.*/}/' path.jsonl > still.jsonl && vpm-query --tool cube.vpmg --frames frames --poses still.jsonl --camera-poses path.jsonl --quiet
2> vpm-query: error: path.jsonl, line 2: "solids" do not move with the camera; give them with the tool's
[1]
