# Robots: vpm-pack --urdf and vpm-query --urdf. The wall is the plane z = 1 m.

$ cp $SOURCE/tests/tools/inputs/* . && vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet

# Poses and volumes are those of geometry: slide and hand are .01 m deep in the wall, then the hand points .15 m into it, then into the base.
$ printf '%s\n' '{"reach":0.16,"id":"touch"}' '[0.15,-1.5707963267948966]' '[-0.6,1.5707963267948966]' '[0,2.5]' > joints.jsonl
$ vpm-query --urdf arm.urdf --joints joints.jsonl --cloud wall.vpmc -o found.jsonl && $VALIDATE robot-result found.jsonl
2> vpm-query: note: joints that a line does not name are at 0: turn
2> vpm-query: warning: configuration 3: joint 'turn' is beyond its limits, -2 to 2; are values in radians and metres?
2> vpm-query: note: configurations: 4, at 1 of which links share volume; pairs of links: 1
$ python3 -c 'import json; [print(l.get("id"), [round(p["volume"] * 1e6) for p in l["links"]], round(l["volume"] * 1e6), [round(l["force"][2] * 1e6)], [round(x, 3) + 0 for x in l["links"][2]["pose"][:3]], [(s["links"], round(s["volume"] * 1e6, 3)) for s in l["self"]], l.get("beyond_limits")) for l in map(json.loads, open("found.jsonl"))]'
touch [0, 200, 200] 401 [-401] [0.0, 0.0, 0.96] [] None
None [0, 0, 1500] 1500 [-1500] [0.0, 0.0, 0.95] [] None
None [0, 0, 0] 0 [0] [0.0, 0.0, 0.2] [(['base', 'hand'], 1000.0)] None
None [0, 0, 0] 0 [0] [0.0, 0.0, 0.8] [] ['turn']

# The sum is that of the links, its torque about the origin.
$ python3 -c 'import json; l = [json.loads(l) for l in open("found.jsonl")][1]; f = [p["force"] for p in l["links"]]; print(max(abs(sum(x[k] for x in f) - l["force"][k]) for k in range(3)) < 1e-15, abs(sum(p["volume"] for p in l["links"]) - l["volume"]) < 1e-15)'
True True
$ vpm-query --urdf arm.urdf --joints joints.jsonl --quiet -o self.csv --fail-above 1e-4 || echo $?; cut -d, -f1,10 self.csv
10
configuration,self_volume
0,0.0
1,0.0
2,0.0009999999999923995
3,0.0
2> vpm-query: warning: configuration 3: joint 'turn' is beyond its limits, -2 to 2; are values in radians and metres?
$ echo '<robot name="arm"><disable_collisions link1="hand" link2="base"/></robot>' > arm.srdf; vpm-query --urdf arm.urdf --joints joints.jsonl --quiet --srdf arm.srdf 2>&1 | python3 -c 'import json, sys; print([l["self"] for l in map(json.loads, (x for x in sys.stdin if x[0] == "{"))][2][0]["links"])'
['slide', 'hand']
$ vpm-query --urdf arm.urdf --joints joints.jsonl --dump-config > call.json && $VALIDATE config.vpm-query call.json

# A solid of the scene is measured by its surface.
$ echo '{"reach":0.16}' | vpm-query --urdf arm.urdf --joints - --solid cube.off@0,0,1.1,0,0,0,1 --quiet | python3 -c 'import json, sys; print([round(p["volume"] * 1e6, 6) for p in json.load(sys.stdin)["links"]])'
[0.0, 200.0, 100.0]

# With --contacts links and pairs list theirs, which add up; the hand is 0.15 m deep in the wall, then half of it in the base.
$ vpm-query --urdf arm.urdf --joints joints.jsonl --cloud wall.vpmc --contacts 2 --stiffness 3e4 --quiet -o touch.jsonl 2>&- && $VALIDATE robot-result touch.jsonl
$ python3 -c 'import json; L = [json.loads(l) for l in open("touch.jsonl")]; P = [p for l in L for p in l["links"]]; print(all(sum(c["volume"] for c in p["contacts"]) == p["volume"] and all(sum(c[f][k] for c in p["contacts"]) == p[f][k] for f in ("force", "torque") for k in range(3)) for p in P)); print(*((c["body"], c["patches"], [round(x, 3) + 0 for x in c["normal"]]) for c in L[1]["links"][2]["contacts"])); print(*((s["links"], round(s["volume"] * 1e6, 3), [round(c["volume"] * 1e6, 3) for c in s["contacts"]], [round(x, 3) + 0 for x in s["contacts"][0]["centroid"]]) for l in L for s in l["self"]))'
True
(0, 1, [0.0, 0.0, 1.0])
(['base', 'hand'], 1000.0, [1000.0], [0.0, 0.0, 0.05])
$ vpm-query --urdf arm.urdf --joints joints.jsonl --contacts 2 --quiet -o touch.csv 2>&-; python3 -c 'import csv, json; print([(len(json.loads(r["self"])), r["hand_contacts"]) for r in csv.DictReader(open("touch.csv"))])'
[(0, ''), (0, ''), (1, ''), (0, '')]

# The page of --view has each link with its mesh and what it has in the scene and shares with others, with a scene and without.
$ for o in "--cloud wall.vpmc" ""; do vpm-query --urdf arm.urdf --joints joints.jsonl $o --contacts --view page.html --quiet -o - 2>&1 > /dev/null | grep -v limits; python3 -c "import base64, json, struct; p = open('page.html').read(); d = json.JSONDecoder().raw_decode(p, p.index('{', p.index('id=\"data\"')))[0]; n = lambda c: [round(1e6 * x) for x in struct.unpack('<4f', base64.b64decode(c['values']['data']))]; print(d['title'], [l['name'] for l in d['layers'] if l['type'] == 'mesh'], sum(l['type'] == 'spheres' for l in d['layers']), [n(c) for c in d['columns'] if c['name'] == 'volume'], sorted({l['name'] for l in d['layers'] if l['type'] == 'lines'}))"; rm page.html; done
base, slide, hand in wall.vpmc ["tool's mesh of base", "tool's mesh of slide", "tool's mesh of hand"] 3 [[0, 0, 1000, 0], [200, 0, 0, 0], [200, 1500, 1000, 0]] ['contacts of base', 'contacts of hand', 'contacts of slide']
base, slide, hand ["tool's mesh of base", "tool's mesh of slide", "tool's mesh of hand"] 0 [[0, 0, 1000, 0], [0, 0, 0, 0], [0, 0, 1000, 0]] ['contacts of base', 'contacts of hand']

# An interrupted run goes on, unless a link's mesh changed.
$ seq 0 59 | awk '{print "[" $1/100 ",0.1]"}' > many.jsonl; cp cube.off link.off; sed 's/<box size=".1 .2 .1"/<mesh filename="link.off"/' arm.urdf > meshes.urdf; echo 'vpm-query --urdf meshes.urdf --joints many.jsonl --quiet "$@"' > ask.sh; for f in jsonl csv; do bash ask.sh -o whole.$f; (ulimit -f 8; bash ask.sh -o cut.$f); bash ask.sh -o cut.$f --resume && cmp cut.$f whole.$f; done; ls cut.*
cut.csv
cut.jsonl
2> vpm-query: error: cannot write cut.jsonl: File too large
2> vpm-query: error: cannot write cut.csv: File too large
$ (ulimit -f 8; bash ask.sh -o other.jsonl 2>&-); sed -i "s/0[.]1/0.2/" link.off; bash ask.sh -o other.jsonl --resume
2> vpm-query: error: other.jsonl.part: its lines are of a run with other meshes; give the same options and files, or --force without --resume to begin anew
[2]

# Lines that are none, and robots that are none, are named with the cure.
$ for l in '[1]' '{"reech":1}' '{"reach":"far"}' '7' '[1,' '[1,1e308]'; do echo "$l" | vpm-query --urdf arm.urdf --joints -; done
2> vpm-query: error: standard input, line 1: the number of values is 1, that of movable joints 2; give one for each of reach, turn
2> vpm-query: error: standard input, line 1: the robot has no joint 'reech'; is 'reach' meant?
2> vpm-query: error: standard input, line 1: the value of joint 'reach' is no number; write {"joint": 0.5, …}, or [0.5, …] with a value for each movable joint
2> vpm-query: error: standard input, line 1: it is no object and no array; write {"joint": 0.5, …}, or [0.5, …] with a value for each movable joint
2> vpm-query: error: standard input, line 1: it is not JSON: it cannot be read from line 1 on; write {"joint": 0.5, …}, or [0.5, …] with a value for each movable joint
2> vpm-query: error: standard input, line 1: the value of joint 'turn' is not finite, or beyond 2^40; values are in radians and metres
[1]
$ echo nothing > none.urdf; echo '<robot><link' > half.urdf; for f in none half; do vpm-query --urdf $f.urdf --joints joints.jsonl; done
2> vpm-query: error: none.urdf: this is no XML; give a URDF file
2> vpm-query: error: half.urdf: this is no XML from line 1 on; give a URDF file
[1]
$ sed 's/".2 .2 .2"/"-1 1 1"/' arm.urdf > bad.urdf; vpm-pack --urdf bad.urdf --export x.yml; sed 's/<box size=".2 .2 .2"/<mesh filename="package:\/\/parts\/m.stl"/' arm.urdf > lost.urdf; vpm-pack --urdf lost.urdf --export x.yml
2> vpm-pack: error: bad.urdf: a size of link 'base' is not positive; sizes are metres above 0
2> vpm-pack: error: lost.urdf: package 'parts', of which link 'base' has a mesh, is not found; give --package-path the folder that holds the folder parts
[1]

# Exactly as many spheres as asked, in each format.
$ vpm-pack --urdf arm.urdf --robot-spheres 17 --outer --inflate 0.001 --export a.csv --export a.yml --export a.xrdf --export a.srdf --export a.urdf --report r.json && $VALIDATE robot-report r.json
2> vpm-pack: note: 17 spheres hold 3 links of 'arm'
$ tail -n +2 a.csv | wc -l; grep -c radius a.yml a.xrdf a.srdf a.urdf; grep -c '<joint' a.urdf
17
a.yml:17
a.xrdf:17
a.srdf:17
a.urdf:17
2
$ tail -n +2 a.csv | cut -d, -f1 | uniq -c | awk '{print $1, $2}'
10 "base"
4 "slide"
3 "hand"
$ vpm-pack --urdf arm.urdf --spheres 4 -o packings --quiet && ls packings && vpm-graph packings/hand.vpmp -o hand.vpmg --levels 2 --quiet && vpm-pack hand.vpmg --level 2 --export two.csv && tail -n +2 two.csv | wc -l
base.vpmp
hand.vpmp
slide.vpmp
2
2> vpm-pack: note: wrote 2 spheres of hand.vpmg
$ vpm-pack hand.vpmg --level 3 --export three.csv; vpm-pack packings/hand.vpmp --level 3 --export three.csv --quiet && tail -n +2 three.csv | wc -l
3
2> vpm-pack: error: hand.vpmg: --level 3 is none of the model's levels; give one of 2, 4
$ vpm-pack --urdf arm.urdf --robot-spheres 2 --export x.yml; vpm-pack --urdf arm.urdf --export x.glb; vpm-pack cube.off --outer -o x.vpmp; vpm-pack cube.off --level 3 --export x.csv; vpm-pack hand.vpmg -o x.vpmp; vpm-pack cube.off --urdf arm.urdf --export x.yml
2> vpm-pack: error: --robot-spheres 2 are too few: there are 3 links with geometry; give one for each at least
2> vpm-pack: error: --export x.glb knows no links: give a .yml, .xrdf, .urdf, .srdf or .csv
2> vpm-pack: error: --output does not go with --outer: leave it out
2> vpm-pack: error: --level does not go with a mesh: leave it out
2> vpm-pack: error: hand.vpmg: this is a tool model (.vpmg); it is ready for vpm-query
2> vpm-pack: error: --urdf takes the place of the mesh cube.off: give one of them
[2]
$ vpm-pack cube.off --outer --spheres 8 --export hold.csv --report hold.json && $VALIDATE outer-report hold.json && sed -n 2p hold.csv | cut -d, -f4
0.086602541
2> vpm-pack: note: 8 spheres hold all of the solid, proven in 512 cells; 82.1 % of its volume lies in them outside of it, and none reaches further than 36.6 mm out
$ vpm-pack --urdf arm.urdf --robot-spheres 5 --export a.yml --export a.srdf --dump-config > call.json && $VALIDATE config.vpm-pack call.json
