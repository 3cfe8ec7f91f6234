# A recorded stream of frames against a path of the tool.

$ cp $SOURCE/tests/tools/inputs/cube.off .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 30 --quiet
$ python3 $SOURCE/tests/tools/frames.py numbered steps 6 && python3 $SOURCE/tests/tools/frames.py timed tum 6 && python3 $SOURCE/tests/tools/frames.py numbered dark 101
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.2 0 0 0.95 0 0 0 1' > still.txt
$ printf '%s\n' '999.95 0 0 0.95 0 0 0 1' '1000.25 0 0 0.95 0 0 0 1' > still_tum.txt

# The wall comes nearer by 5 % of the cube with each frame; each frame is held until the next one, 33 or 34 steps.
$ cat > volumes.py <<< 'import itertools, json, sys; print([(f, round(v, 2), len(list(g))) for (f, v), g in itertools.groupby((json.loads(l) for l in sys.stdin), lambda r: (r["frame"], r["volume_fraction"]))])'
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 -o steps.jsonl --stats stats.json
2> vpm-query: note: frames have numbers, not times: they begin with the path, at --frame-rate
2> vpm-query: note: 201 steps in * s, * times real time; latency * us median, * us p99, * us longest; 6 frames used (glob)
$ python3 volumes.py < steps.jsonl
[('frame-000000.depth.png', 0.25, 34), ('frame-000001.depth.png', 0.3, 33), ('frame-000002.depth.png', 0.35, 33), ('frame-000003.depth.png', 0.4, 34), ('frame-000004.depth.png', 0.45, 33), ('frame-000005.depth.png', 0.5, 34)]
$ $VALIDATE query-result steps.jsonl && $VALIDATE query-stats stats.json

# A step gives the result of its pose in the cloud of its frame.
$ vpm-normals steps/frame-000002.depth.png -o two.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ vpm-query --tool cube.vpmg --cloud two.vpmc --pose 0,0,0.95,0,0,0,1 | cut -d, -f2- > one
$ grep 000002 steps.jsonl | cut -d, -f4- | sort -u | cmp - one

# The clock and the number of threads change no result.
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --realtime --quiet --stats stats.json --force | cmp - steps.jsonl
$ $VALIDATE query-stats stats.json && python3 -c 'import json; r = json.load(open("stats.json"))["replay"]; print(r["real_time_factor"] < 1.01, "start_delay_us" in r, r["deadline_us"], sum(b["steps"] for b in r["latency_histogram"]))'
True True 1000.0 201
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --threads 1 --quiet | cmp - steps.jsonl

# Frames are seen late by their latency, some are passed over at a low rate, and they go back and forth if asked for.
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --frame-latency 0.05 --quiet | python3 volumes.py
[('', 0.0, 50), ('frame-000000.depth.png', 0.25, 34), ('frame-000001.depth.png', 0.3, 33), ('frame-000002.depth.png', 0.35, 33), ('frame-000003.depth.png', 0.4, 34), ('frame-000004.depth.png', 0.45, 17)]
2> vpm-query: warning: 50 steps came before the first frame that can be used: nothing is in their way
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --rate 10 --quiet --stats stats.json --force | python3 volumes.py
[('frame-000000.depth.png', 0.25, 1), ('frame-000003.depth.png', 0.4, 1), ('frame-000005.depth.png', 0.5, 1)]
$ python3 -c 'import json; f = json.load(open("stats.json"))["replay"]["frames"]; print(f["listed"], f["used"], f["unseen"])'
6 3 3
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --frame-rate 60 --repeat-frames --quiet | python3 volumes.py | grep -o 00000. | tr -d '\n' && echo
000000000001000002000003000004000005000004000003000002000001000000000001000002

# A list of times and a path share a clock; the camera's path lies beside the frames.
$ vpm-query --tool cube.vpmg --frames tum --trajectory still_tum.txt --intrinsics 60,60,31.5,23.5 --quiet | python3 volumes.py
[('', 0.0, 50), ('1000.000000.png', 0.25, 34), ('1000.033333.png', 0.3, 33), ('1000.066667.png', 0.35, 33), ('1000.100000.png', 0.4, 34), ('1000.133333.png', 0.45, 33), ('1000.166667.png', 0.5, 84)]
2> vpm-query: warning: 50 steps came before the first frame that can be used: nothing is in their way
$ vpm-query --tool cube.vpmg --frames tum --trajectory still.txt --intrinsics 60,60,31.5,23.5
2> vpm-query: error: the path (0.000 to 0.200 s) and the frames (1000.000 to 1000.167 s) share no time; --align-starts lets both begin together
[1]
$ vpm-query --tool cube.vpmg --frames tum/depth.txt --trajectory still.txt --intrinsics 60,60,31.5,23.5 --align-starts --quiet | python3 volumes.py | cut -d, -f1-3
[('1000.000000.png', 0.25, 34)
$ vpm-query --tool cube.vpmg --frames tum --trajectory still.txt --intrinsics 60,60,31.5,23.5 --align-starts --camera-pose 0,0,0.01,0,0,0,1 2>&1 | python3 -c 'import sys; print(*[l for l in sys.stdin.read().splitlines() if "camera" in l], sep="\n")'
vpm-query: note: the camera does not move: tum is seen from --camera-pose

# Frames that are late, missing, empty, broken or without a camera pose are reported, and the loop goes on with the last
# good frame.
$ cp -r tum bad && grep -v 1000.033333 tum/depth.txt > bad/depth.txt && vpm-query --tool cube.vpmg --frames bad --trajectory still_tum.txt --intrinsics 60,60,31.5,23.5 -o late.jsonl --quiet
2> vpm-query: warning: bad/depth/1000.066667.png: came late; the loop went on with the frame before
2> vpm-query: warning: 50 steps came before the first frame that can be used: nothing is in their way
$ python3 $SOURCE/tests/tools/frames.py numbered holes 9 && rm holes/frame-000001.depth.png && cp $SOURCE/tests/tools/inputs/wall.png holes/frame-000002.depth.png && truncate -s 60 holes/frame-000002.depth.png && : > holes/frame-000003.depth.png && echo '-inf nan 0 0' > holes/frame-000005.pose.txt && cp dark/frame-000100.depth.png holes/frame-000006.depth.png
$ vpm-query --tool cube.vpmg --frames holes --trajectory still.txt --frame-rate 100 --intrinsics 60,60,31.5,23.5 -o holes.jsonl --stats stats.json --force --quiet
2> vpm-query: warning: holes/frame-000002.depth.png: * (glob)
2> vpm-query: warning: holes/frame-000003.depth.png: the file is empty; give a depth image or a cloud; the loop goes on with frame-000000.depth.png
2> vpm-query: warning: holes/frame-000005.depth.png: no pose of its camera; the loop goes on with frame-000004.depth.png
2> vpm-query: warning: holes/frame-000006.depth.png: no pixel holds a measurement: all are 0; the loop goes on with frame-000004.depth.png
2> vpm-query: warning: 1 frames of holes are missing; the loop went on with those before
$ python3 volumes.py < holes.jsonl
[('frame-000000.depth.png', 0.25, 40), ('frame-000004.depth.png', 0.45, 30), ('frame-000007.depth.png', 0.6, 10), ('frame-000008.depth.png', 0.65, 121)]
$ $VALIDATE query-stats stats.json && python3 -c 'import json; f = json.load(open("stats.json"))["replay"]["frames"]; print({k: f[k] for k in ("listed", "used", "missing", "late", "lost", "empty", "broken")})'
{'listed': 8, 'used': 4, 'missing': 1, 'late': 0, 'lost': 1, 'empty': 1, 'broken': 2}
$ mkdir none && cp dark/frame-000100.depth.png none/1.png && vpm-query --tool cube.vpmg --frames none --trajectory still.txt --intrinsics 60,60,31.5,23.5 --quiet
2> vpm-query: error: none: no frame can be used; the last one: none/1.png: no pixel holds a measurement: all are 0
[1]

# Frames go with the other kinds of queries: coherent poses, deadlines, a virtual coupling.
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --coherent --quiet | cmp - steps.jsonl
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --deadline-us 1e6 --quiet --stats stats.json --force | $VALIDATE query-result - && $VALIDATE query-stats stats.json
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --coupling stiffness=500,damping=5 --stiffness 2e4 --quiet | tee coupled.jsonl | $VALIDATE coupling-step - && tail -n 1 coupled.jsonl | python3 -c 'import json; s = json.loads(input()); print(s["step"], s["frame"], s["tool"][2] < 0.95)'
200 frame-000005.depth.png True

# vpm-normals makes clouds of a recording, whose steps give the same; their times and the camera's poses go with them.
$ vpm-normals steps -o clouds --intrinsics 60,60,31.5,23.5
2> vpm-normals: note: 6 clouds are in clouds
$ vpm-query --tool cube.vpmg --frames clouds --trajectory still.txt --quiet | sed 's/[.]vpmc"/.png"/' | cmp - steps.jsonl
$ vpm-normals tum -o clouds_tum --intrinsics 60,60,31.5,23.5 --depth-scale 2000 --quiet && vpm-query --tool cube.vpmg --frames clouds_tum --trajectory still_tum.txt --quiet -o /dev/null --stats stats.json --force && ls clouds_tum | head -n 2
1000.000000.vpmc
1000.033333.vpmc
2> vpm-query: warning: 50 steps came before the first frame that can be used: nothing is in their way
$ vpm-normals holes -o clouds_holes --intrinsics 60,60,31.5,23.5
2> vpm-normals: warning: holes/frame-000002.depth.png: * (glob)
2> vpm-normals: warning: holes/frame-000003.depth.png: the file is empty; give a depth image or a cloud; it is left out
2> vpm-normals: warning: holes/frame-000005.depth.png: no pose of its camera; it is left out
2> vpm-normals: warning: holes/frame-000006.depth.png: no pixel holds a measurement: all are 0; it is left out
2> vpm-normals: warning: 1 frames of holes are missing
2> vpm-normals: note: 4 clouds are in clouds_holes, and 4 frames could not be used
$ vpm-query --tool cube.vpmg --frames clouds_holes --trajectory still.txt --frame-rate 100 --quiet | python3 volumes.py
[('frame-000000.depth.vpmc', 0.25, 40), ('frame-000004.depth.vpmc', 0.45, 30), ('frame-000007.depth.vpmc', 0.6, 10), ('frame-000008.depth.vpmc', 0.65, 121)]
2> vpm-query: warning: 5 frames of clouds_holes are missing; the loop went on with those before
$ vpm-query --tool cube.vpmg --frames clouds --trajectory still.txt --quiet -o /dev/null --view clouds.html

# Wrong usage is refused.
$ vpm-normals steps -o clouds --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: --output clouds has files in it already; name another folder, or give --force
[2]
$ vpm-normals tum -o tum/. --intrinsics 60,60,31.5,23.5 --force
2> vpm-normals: error: --output tum/. is the folder of the frames: name another one
[2]
$ cp $SOURCE/tests/tools/inputs/wall.png one.png; mkdir single; for frame in one.png tum/../one.png; do vpm-normals $frame -o single --intrinsics 60,60,31.5,23.5; done
2> vpm-normals: error: --output single is a folder, and one.png is one frame: name a file, such as single/one.vpmc
2> vpm-normals: error: --output single is a folder, and tum/../one.png is one frame: name a file, such as single/one.vpmc
[2]
$ ls single
$ vpm-normals steps --report - --intrinsics 60,60,31.5,23.5
2> vpm-normals: error: the input is a recording: give -o FOLDER for its clouds
[2]
$ vpm-normals clouds -o again; vpm-normals none -o nothing --intrinsics 60,60,31.5,23.5 --quiet; vpm-normals two.vpmc -o x.vpmc --camera-poses still.txt
2> vpm-normals: error: clouds holds clouds already: give it to vpm-query --frames
2> vpm-normals: warning: none/1.png: no pixel holds a measurement: all are 0; it is left out
2> vpm-normals: error: none: no frame can be used; the last one: none/1.png: no pixel holds a measurement: all are 0
2> vpm-normals: error: --camera-poses is for a recording: give one frame's pose by --camera-pose
[2]
$ vpm-query --tool cube.vpmg --frames clouds --trajectory still.txt --intrinsics 60,60,31.5,23.5
2> vpm-query: error: the frames of clouds are clouds, which hold their camera and its pose: give --intrinsics, --camera-pose and --camera-poses to vpm-normals, which makes them
[2]
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --depth-scale 5000; vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --flip
2> vpm-query: error: --depth-scale is gone from vpm-query: make clouds of the frames first, by vpm-normals FRAMES -o CLOUDS --depth-scale, and give --frames CLOUDS
2> vpm-query: error: --flip is gone from vpm-query: make clouds of the frames first, by vpm-normals FRAMES -o CLOUDS --flip, and give --frames CLOUDS
[2]
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --coupling stiffness=500,damping=5,rate=500 --rate 1000 --stiffness 2e4
2> vpm-query: error: --rate and the rate of --coupling differ; give one of them
[2]
$ vpm-query --tool cube.vpmg --cloud two.vpmc --poses still.txt --realtime
2> vpm-query: error: --realtime does not go with poses in a cloud, chosen because --frames is not given: leave it out
[2]
$ vpm-query --tool cube.vpmg --frames steps
2> vpm-query: error: --poses is missing: give the path of the haptic device, or with --frames the path of the tool
[2]
$ vpm-query --tool cube.vpmg --frames steps --cloud two.vpmc --trajectory still.txt
2> vpm-query: error: --cloud does not go with recorded frames, chosen by --frames: leave it out
[2]
$ vpm-query --tool cube.vpmg --frames steps --trajectory still.txt
2> vpm-query: note: frames have numbers, not times: they begin with the path, at --frame-rate
2> vpm-query: error: steps/frame-000000.depth.png: a depth image needs --intrinsics: fx,fy,cx,cy in pixels, or a file with them
[2]
$ mkdir bare && vpm-query --tool cube.vpmg --frames bare --trajectory still.txt
2> vpm-query: error: bare: no frames in it; wanted are .png, .exr, .tif, .pgm, .pfm, .npy, .pcd, .ply or .vpmc files, or depth.txt with "time file" lines
[1]
$ vpm-query --tool cube.vpmg --frames gone --trajectory still.txt
2> vpm-query: error: cannot read gone: No such file or directory
[1]

# Times that hardly are those of a camera are doubted.
$ mkdir dates && for k in 0 1 2; do cp steps/frame-00000$k.depth.png dates/2024010112000$k.png; done && vpm-query --tool cube.vpmg --frames dates --trajectory still.txt --align-starts --intrinsics 60,60,31.5,23.5 --quiet -o /dev/null
2> vpm-query: warning: the frames are 0.001 s apart, as their names or their list tell their times, which is unusual; if that is wrong, give a list of "seconds file" lines

# A time without poses, across which they are interpolated, is said: of the tool, and of the camera where frames lie in it.
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.01 0 0 0.95 0 0 0 1' '0.02 0 0 0.95 0 0 0 1' '1 0 0 0.95 0 0 0 1' > gap.txt && vpm-query --tool cube.vpmg --frames steps --trajectory gap.txt --intrinsics 60,60,31.5,23.5 --quiet -o /dev/null
2> vpm-query: warning: gap.txt: no pose from 0.020 to 1.000 s, more than ten times as long as from one pose to the next elsewhere; poses in between are interpolated
$ sed 's/0.95/0/' gap.txt > camera.txt && vpm-query --tool cube.vpmg --frames steps --trajectory still.txt --camera-poses camera.txt --intrinsics 60,60,31.5,23.5 --quiet -o /dev/null
2> vpm-query: warning: camera.txt: no pose from 0.020 to 1.000 s, more than ten times as long as from one pose to the next elsewhere; poses in between are interpolated

# A path that misses what the frames see is warned about like poses in a cloud, with the cure.
$ printf '%s\n' '0 0 0 -0.95 0 0 0 1' '0.2 0 0 -0.95 0 0 0 1' > behind.txt && printf '%s\n' '0 0 0 0.3 0 0 0 1' '0.2 0 0 0.3 0 0 0 1' > before.txt && printf '%s\n' '0 9 0 0.95 0 0 0 1' '0.2 9 0 0.95 0 0 0 1' > beside.txt
$ for t in behind before beside; do vpm-query --tool cube.vpmg --frames steps --trajectory $t.txt --intrinsics 60,60,31.5,23.5 --quiet -o /dev/null; done
2> vpm-query: warning: at every pose the tool is behind the camera; it would be there with inverse poses (from tool to world), or with vpm-normals --axes opengl --camera-pose 0,0,0,0,0,0,1
2> vpm-query: warning: at no pose is the tool within its size of the surface; are poses and scene in the same frame and unit?
2> vpm-query: warning: at no pose is the tool in the camera's view; are poses and scene in the same frame and unit?
$ vpm-pack cube.off -o large.vpmp --scale 1000 --spheres 50 --quiet && vpm-graph large.vpmp -o large.vpmg --quiet && vpm-query --tool large.vpmg --frames steps --trajectory still.txt --intrinsics 60,60,31.5,23.5 --quiet -o /dev/null
2> vpm-pack: warning: cube.off: the mesh is 200 m across: if its unit is the millimetre, give --scale 1
2> vpm-query: warning: the tool is 346 m across and the scene 1.31 m: if the mesh is in metres, give vpm-pack --scale 1
$ cp -r steps moved && for f in moved/*.pose.txt; do printf '%s\n' '1 0 0 4' '0 1 0 0' '0 0 1 0' '0 0 0 1' > $f; done; vpm-query --tool cube.vpmg --frames moved --trajectory still.txt --intrinsics 60,60,31.5,23.5 --quiet -o /dev/null
2> vpm-query: warning: at no pose is the tool in the camera's view; it would be there with poses in the world's frame, not the camera's
