# Known solids, such as the robot itself, leave the depth image before it is a cloud.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 60 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ echo "import json, sys; print([round(json.loads(l)[k], 4) + 0 for l in sys.stdin for k in sys.argv[1:]])" > show.py

# A wall at 1 m that goes through the cube, as if the camera had seen its middle: all that the cube hides is unseen, and nothing is in its way.
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,1,0,0,0,1 | python3 show.py volume_fraction seen_free unseen
[0.4999, 0.5001, 0.0]
$ vpm-normals wall.png -o rest.vpmc --intrinsics 60,60,31.5,23.5 --remove cube.vpmg@0,0,1,0,0,0,1 --report report.json && $VALIDATE normals-report report.json
2> vpm-normals: note: --remove: 256 pixels removed, with a margin of 0 m
$ vpm-query --tool cube.vpmg --cloud rest.vpmc --pose 0,0,1,0,0,0,1 | python3 show.py volume_fraction seen_free unseen out_of_view
[0.0, 0.0, 1.0, 0.0]
$ python3 -c "import json; r = json.load(open('report.json')); print(r['points'] + r['removed'] + r['without_normal'] + r['invalid'])"
3072
$ vpm-normals wall.png -o mesh.vpmc --intrinsics 60,60,31.5,23.5 --remove cube.off@0,0,1,0,0,0,1 --quiet && vpm-query --tool cube.vpmg --cloud mesh.vpmc --pose 0,0,1,0,0,0,1 | python3 show.py volume_fraction seen_free unseen out_of_view
[0.0, 0.0, 1.0, 0.0]
$ vpm-normals wall.png --report - --intrinsics 60,60,31.5,23.5 --remove cube.vpmg@0,0,1,0,0,0,1 --remove cube.vpmg@0.2,0,1,0,0,0,1 --remove-margin time=0.03,speed=1.5,calibration=0.005 > r.json
2> vpm-normals: note: --remove: 910 pixels removed, with a margin of 0.05 m, of 0.03 s at 1.5 m/s and 0.005 m of calibration
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --remove cube.vpmg@0,0,1,0,0,0,1 --dump-config > call.json && $VALIDATE config.vpm-normals call.json

# What is probably wrong is said.
$ vpm-normals wall.png --report - --intrinsics 60,60,31.5,23.5 --remove cube.vpmg@0,0,0.5,0,0,0,1 > r.json
2> vpm-normals: note: --remove: 1156 pixels removed, with a margin of 0 m
2> vpm-normals: warning: --remove: cube.vpmg lies in view and explains no pixel: its pose is probably wrong; it takes the mesh to the world, in metres
$ vpm-normals wall.png --report - --intrinsics 60,60,31.5,23.5 --remove cube.vpmg@0,0,-3,0,0,0,1 > r.json
2> vpm-normals: note: --remove: 0 pixels removed, with a margin of 0 m
2> vpm-normals: note: --remove: cube.vpmg is out of view
$ vpm-normals wall.png --report - --intrinsics 60,60,31.5,23.5 --remove cube.vpmg > r.json
2> vpm-normals: note: --remove: 3071 pixels removed, with a margin of 0 m
2> vpm-normals: warning: --remove: the camera is inside of cube.vpmg, which hides all that it sees: leave that solid out
2> vpm-normals: error: wall.png: all of its 3071 measured pixels are removed with solids
[1]

# Wrong calls are refused, with the cure.
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --remove cube.vpmg@1,2,3
2> vpm-normals: error: --remove: expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found 3 in '1,2,3'
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --remove gone.vpmg
2> vpm-normals: error: cannot read gone.vpmg: No such file or directory
[1]
$ for m in -0.1 nan time=0.03 late=1 time=,speed=1 0.1,0.2; do vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --remove cube.vpmg --remove-margin=$m; done
2> vpm-normals: error: --remove-margin -0.1: '-0.1' is no number from 0 on; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
2> vpm-normals: error: --remove-margin nan: 'nan' is no number from 0 on; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
2> vpm-normals: error: --remove-margin time=0.03: a time needs the speed of the solids; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
2> vpm-normals: error: --remove-margin late=1: 'late=1' is unknown; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
2> vpm-normals: error: --remove-margin time=,speed=1: '' is no number from 0 on; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
2> vpm-normals: error: --remove-margin 0.1,0.2: '0.1,0.2' is no number from 0 on; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
[2]
$ vpm-normals wall.png -o x.vpmc --intrinsics 60,60,31.5,23.5 --remove-margin 0.1
2> vpm-normals: error: --remove-margin needs --remove, which names the solids
[2]
$ vpm-normals wall.png --export wall.ply --intrinsics 60,60,31.5,23.5 && vpm-normals wall.ply -o x.vpmc --remove cube.vpmg
2> vpm-normals: error: wall.ply: points without a camera: --remove takes pixels out of depth images; give the depth image
[1]

# Solids that move leave recorded frames: the tool is in its own picture, and is in nobody's way. Before that it stands in the wall.
$ python3 $SOURCE/tests/tools/frames.py timed tum 4 && printf '%s\n' '1000 0 0 1 0 0 0 1' '1000.1 0.1 0 1 0 0 0 1' > path.txt
$ printf '%s\n' '{"remove":["cube.vpmg"]}' '{"time":1000,"solids":[[0,0,1,0,0,0,1]]}' '{"time":1000.1,"solids":[[0.1,0,1,0,0,0,1]]}' > tool.jsonl
$ cat > least.py <<< 'import json, sys; r = [json.loads(l) for l in sys.stdin]; print(len(r), *[round(f([l[k] for l in r]), 3) + 0 for k in ("volume_fraction", "seen_free") for f in (min, max)])'
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --quiet | python3 least.py
4 0.5 0.65 0.35 0.5
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove tool.jsonl > removed.jsonl
2> vpm-query: note: --remove: 1056 pixels removed from 4 images, with a margin of 0 m
2> vpm-query: note: 4 steps in * s, * times real time; latency * us median, * us p99, * us longest; 4 frames used (glob)
$ python3 least.py < removed.jsonl && $VALIDATE query-result removed.jsonl
4 0.0 0.0 0.0 0.0
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove tool.jsonl --quiet -o kept.jsonl && cmp kept.jsonl removed.jsonl
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove tool.jsonl --remove-margin time=0.02,calibration=0.005 2>&1 > wide.jsonl | grep remove
vpm-query: note: --remove: 1628 pixels removed from 4 images, with a margin of up to 0.025 m, of 0.02 s at the speed of each solid, and 0.005 m of calibration
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove tool.jsonl --quiet --threads 1 --realtime | cmp - removed.jsonl
$ vpm-normals tum -o clouds --intrinsics 60,60,31.5,23.5 --quiet && vpm-query --tool cube.vpmg --frames clouds --poses path.txt --rate 30 --remove tool.jsonl --quiet | python3 least.py
4 0.0 0.0 0.0 0.0
$ (echo '{"remove":["cube.off@0,0,1,0,0,0,1"]}') > still.jsonl && vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove still.jsonl 2>&1 > r.jsonl | grep remove
vpm-query: note: --remove: 1024 pixels removed from 4 images, with a margin of 0 m
$ (head -1 tool.jsonl; sed -n 's/"time":1000[.0-9]*,//p' tool.jsonl; sed -n 's/"time":1000[.0-9]*,//p' tool.jsonl) > lines.jsonl && vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove lines.jsonl 2>&1 > r.jsonl | grep remove
vpm-query: note: --remove: 1056 pixels removed from 4 images, with a margin of 0 m
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove tool.jsonl --remove-margin 0.1 --dump-config > call.json && $VALIDATE config.vpm-query call.json

# A pose that is probably wrong is said; files that are no such, or end before the frames, are refused.
$ sed 's/,0,1,/,0,0.6,/' tool.jsonl > wrong.jsonl && vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --rate 30 --remove wrong.jsonl 2>&1 > r.jsonl | grep remove
vpm-query: note: --remove: 3136 pixels removed from 4 images, with a margin of 0 m
vpm-query: warning: --remove: cube.vpmg lies in view and explains no pixel: its pose is probably wrong; it takes the mesh to the world, in metres
$ sed 's/1000.1/1000.02/' tool.jsonl > short.jsonl && vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove short.jsonl
2> vpm-query: error: short.jsonl: its poses end at 1000.020 s, but tum/depth/1000.066667.png is of 1000.067 s; give poses for the time of all frames, on their clock
[1]
$ head -2 lines.jsonl > few.jsonl && vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove few.jsonl
2> vpm-query: error: few.jsonl: 1 lines of poses without times, but 4 frames; give a line for each frame, or times
[1]
$ for l in '[]' '{"remove":[]}' '{"remove":[3]}' '{"remove":["gone.vpmg"]}' '{"remove":["cube.vpmg@1,2"]}' ''; do echo "$l" > bad.jsonl; vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove bad.jsonl; done
2> vpm-query: error: bad.jsonl, line 1: no list "remove" of solids; the first line names the solids: {"remove":["hand.vpmg","link.stl"]}
2> vpm-query: error: bad.jsonl, line 1: no list "remove" of solids; the first line names the solids: {"remove":["hand.vpmg","link.stl"]}
2> vpm-query: error: bad.jsonl, line 1: a solid that is no text; the first line names the solids: {"remove":["hand.vpmg","link.stl"]}
2> vpm-query: error: cannot read gone.vpmg: No such file or directory
2> vpm-query: error: --remove: expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found 2 in '1,2'
2> vpm-query: error: bad.jsonl: it is empty; the first line names the solids: {"remove":["hand.vpmg","link.stl"]}
[1]
$ for l in '{"time":1}' '{"time":1000,"solids":[[0,0,1,0,0,0,1],[0,0,1,0,0,0,1]]}' '{"time":1000,"solids":[[0,0,1,0,0,0,3]]}' '{"solids":[[0,0,1,0,0,0,1]]}' '{"time":1000,"solids":[[0,0,1,0,0,0,1]]}' '{"time":'; do (head -2 tool.jsonl; echo "$l") > bad.jsonl; vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove bad.jsonl; done
2> vpm-query: error: bad.jsonl, line 3: no "solids", the poses of the solids at a time; write {"time":0.1,"solids":[[tx,ty,tz,qx,qy,qz,qw], …]}
2> vpm-query: error: bad.jsonl, line 3: "solids" has 2 poses, and "remove" 1 solids; give one for each
2> vpm-query: error: bad.jsonl, line 3: solid 0 of "solids": the quaternion has length 3.000000 instead of 1; give x,y,z,w of a unit quaternion
2> vpm-query: error: bad.jsonl, line 3: either every line has a time or none
2> vpm-query: error: bad.jsonl, line 3: times must ascend
2> vpm-query: error: bad.jsonl, line 3: no "solids", the poses of the solids at a time; write {"time":0.1,"solids":[[tx,ty,tz,qx,qy,qz,qw], …]}
[1]
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove gone.jsonl; vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove tool.jsonl --remove-margin -1
2> vpm-query: error: cannot read gone.jsonl: No such file or directory
2> vpm-query: error: --remove-margin -1: '-1' is no number from 0 on; give metres, such as 0.02, or time=S,speed=M/S,calibration=M
[2]
$ vpm-query --tool cube.vpmg --frames tum --poses path.txt --intrinsics 60,60,31.5,23.5 --remove-margin 1; vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,1,0,0,0,1 --remove tool.jsonl
2> vpm-query: error: --remove-margin needs --remove: it names the solids and their poses
2> vpm-query: error: --remove does not go with poses in a cloud, chosen because --frames is not given: leave it out
[2]
