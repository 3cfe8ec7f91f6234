# Recordings of several cameras, replayed together.

$ cp $SOURCE/tests/tools/inputs/cube.off .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 30 --quiet
$ python3 $SOURCE/tests/tools/frames.py timed left 4 && python3 $SOURCE/tests/tools/frames.py timed right 3
$ printf '%s\n' '1000.02 depth/1000.000000.png' '1000.08 depth/1000.066667.png' > right/depth.txt && sed 's/ 0 / 0.02 /' right/groundtruth.txt > right.txt
$ echo '60 0 31.5 0 60 23.5 0 0 1' | xargs -n 3 > left/camera-intrinsics.txt && echo '90 0 31.5 0 90 23.5 0 0 1' | xargs -n 3 > right/camera-intrinsics.txt
$ printf '%s\n' '1000 0 0 0.95 0 0 0 1' '1000.15 0 0 0.95 0 0 0 1' > still.txt
$ echo 'vpm-query --tool cube.vpmg --frames left --frames right --poses still.txt "$@"' > ask.sh

# Each step sees the last frame of each camera, which is gone when its next one comes.
$ bash ask.sh --camera-poses left/groundtruth.txt --camera-poses right.txt -o both.jsonl --view both.html --stats stats.json
2> vpm-query: note: intrinsics 60,60,31.5,23.5 are read from camera-intrinsics.txt in left
2> vpm-query: note: intrinsics 90,90,31.5,23.5 are read from camera-intrinsics.txt in right
2> vpm-query: note: 151 steps in * s, * times real time; latency * us median, * us p99, * us longest; 6 frames used (glob)
$ python3 -c 'import itertools, json; print(*(f for f, _ in itertools.groupby(json.loads(l)["frame"] for l in open("both.jsonl"))), sep="\n")'
left/1000.000000.png
left/1000.000000.png;right/1000.000000.png
left/1000.033333.png;right/1000.000000.png
left/1000.066667.png;right/1000.000000.png
left/1000.066667.png;right/1000.066667.png
left/1000.100000.png;right/1000.066667.png
$ $VALIDATE query-result both.jsonl && $VALIDATE query-stats stats.json

# A step gives the result of its pose in a scene made afresh of these frames, in either order.
$ vpm-normals left/depth/1000.066667.png -o left.vpmc --intrinsics 60,60,31.5,23.5 --quiet && vpm-normals right/depth/1000.066667.png -o right.vpmc --intrinsics 90,90,31.5,23.5 --camera-pose 0.02,0,0,0,0,0,1 --quiet
$ vpm-query --tool cube.vpmg --cloud right.vpmc --cloud left.vpmc --pose 0,0,0.95,0,0,0,1 --quiet | cut -d, -f2- > afresh
$ grep 'left/1000.066667.png;right/1000.066667.png' both.jsonl | cut -d, -f4- | sort -u | cmp - afresh

# A camera that does not move has one pose, without a time: it is that of all its frames.
$ echo '0.02 0 0 0 0 0 1' > fixed.txt && bash ask.sh --camera-poses left/groundtruth.txt --camera-poses fixed.txt -o fixed.jsonl 2>&1 | grep fixed
vpm-query: note: right: the camera does not move: fixed.txt has one pose
$ cmp fixed.jsonl both.jsonl

# The page has the surface and the frustum of each camera, and what --remove took from them; nothing is in the way of what was removed.
$ echo '{"remove":["cube.off@0,0,1,0,0,0,1"]}' > still.jsonl; bash ask.sh --camera-poses left/groundtruth.txt --camera-poses right.txt --remove still.jsonl -o removed.jsonl --view removed.html --rate 30 2>&1 | grep remove
vpm-query: note: --remove: 2176 pixels removed from 6 images, with a margin of 0 m
$ python3 -c 'import json; print([[round(max(json.loads(l)[k] for l in open(f)), 3) + 0 for k in ("volume_fraction", "unseen")] for f in ("both.jsonl", "removed.jsonl")])'
[[0.357, 0.0], [0.0, 1.0]]
$ for f in both removed; do for w in '"type":"image"' '"removed":'; do grep -o $w $f.html | wc -l; done; done | xargs
2 0 2 7

# Its layers have the names of the recordings. A camera of which nothing has come yet shows nothing: no images before the first.
$ printf '%s\n' '999.95 0 0 0.95 0 0 0 1' '1000.15 0 0 0.95 0 0 0 1' > early.txt; vpm-query --tool cube.vpmg --frames left --frames right/ --poses early.txt --camera-poses left/groundtruth.txt --camera-poses right.txt --rate 100 --quiet -o early.jsonl --view early.html
2> vpm-query: warning: 5 steps came before the first frame that can be used: nothing is in their way
$ python3 -c "import base64, json, struct; p = open('early.html').read(); d = json.JSONDecoder().raw_decode(p, p.index('{', p.index('id=\"data\"')))[0]; print(d['title']); [print(l['name'], len(l['images']), [k for k, n in enumerate(struct.unpack('<21I', base64.b64decode(l['of_step']['data']))) if n >= len(l['images'])]) for l in d['layers'] if l['type'] == 'image']"
cube.vpmg in left, right
measured surface of left 6 [0, 1, 2, 3, 4]
measured surface of right 5 [0, 1, 2, 3, 4, 5, 6]

# Cameras are moved by their first images, as those of clouds.
$ sed 's/ 0.02 0 0 / 0.02 0 0.006 /' right.txt > off.txt && bash ask.sh --camera-poses left/groundtruth.txt --camera-poses off.txt --register -o moved.jsonl 2>&1 | grep -A2 -- --register
vpm-query: note: --register: the images disagree by 0.00 mm, and disagreed by 8.88 mm; they tell 3 of 6 motions of cameras against each other; the others stay
vpm-query: note: left: its camera is moved by 3.00 mm and 0.00? degrees, to * (glob)
vpm-query: note: right: its camera is moved by 3.00 mm and 0.00? degrees, to * (glob)
$ vpm-normals left/depth/1000.000000.png -o first.vpmc --intrinsics 60,60,31.5,23.5 --quiet && vpm-normals right/depth/1000.000000.png -o off.vpmc --intrinsics 90,90,31.5,23.5 --camera-pose 0.02,0,0.006,0,0,0,1 --quiet
$ vpm-query --tool cube.vpmg --cloud off.vpmc --cloud first.vpmc --pose 0,0,0.95,0,0,0,1 --register --quiet | cut -d, -f2- > afresh
$ grep 'left/1000.000000.png;right/1000.000000.png' moved.jsonl | cut -d, -f4- | sort -u | cmp - afresh
$ vpm-query --tool cube.vpmg --frames left --poses still.txt --register --quiet; sed 's/^.*$/left.vpmc/; s/^/1000.0 /' still.txt | head -1 > ready.txt; vpm-query --tool cube.vpmg --frames left --frames ready.txt --poses still.txt --register --quiet
2> vpm-query: error: --register makes the images of cameras agree: give several --frames
2> vpm-query: error: left.vpmc: --register does not move clouds that keep their poses; give the depth images, or --cloud for each camera
[1]

# What tells nothing of one camera among several is refused.
$ bash ask.sh --camera-poses right.txt
2> vpm-query: error: give --camera-poses once for each --frames, in their order, or not at all
[2]
$ bash ask.sh --camera-pose 0,0,0,0,0,0,1
2> vpm-query: error: --camera-pose would put the cameras of several --frames at one place: give --camera-poses for each
[2]
$ python3 $SOURCE/tests/tools/frames.py numbered numbered 2 && vpm-query --tool cube.vpmg --frames left --frames numbered --poses still.txt --quiet
2> vpm-query: error: numbered/frame-000000.depth.png: the frames of one camera have times, and those of another numbers; give a list of "time file" lines for each of them
[1]
