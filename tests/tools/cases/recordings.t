# Recordings whose poses, times or sizes are not as they should be.

$ cp $SOURCE/tests/tools/inputs/cube.off .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 30 --quiet
$ python3 $SOURCE/tests/tools/frames.py numbered steps 3 && python3 $SOURCE/tests/tools/frames.py timed tum 3
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.1 0 0 0.95 0 0 0 1' > still.txt
$ printf '%s\n' '1000 0 0 0.95 0 0 0 1' '1000.1 0 0 0.95 0 0 0 1' > still_tum.txt
$ cat > ask.sh <<< 'vpm-query --tool cube.vpmg --intrinsics 60,60,31.5,23.5 "$@" 2>&1 >/dev/null | grep -v "times real time\|have numbers, not times"; exit ${PIPESTATUS[0]}'
$ cat > fractions.py <<< 'import itertools, json, sys; print([round(v, 2) for v, _ in itertools.groupby(json.loads(l)["volume_fraction"] for l in sys.stdin)])'

# The camera's path is of another clock than the frames.
$ cp -r tum clock && sed -i 's/^/9/' clock/groundtruth.txt && bash ask.sh --frames clock --trajectory still_tum.txt
vpm-query: error: clock/groundtruth.txt: no frame (1000.000 to 1000.067 s) lies in the time of the camera's path (9999.000 to 91010.000 s); give --camera-poses of the frames' clock, or without times one for each frame
[1]
$ bash ask.sh --frames steps --trajectory still.txt --camera-poses tum/groundtruth.txt
vpm-query: error: tum/groundtruth.txt: no frame (0.000 to 0.067 s) lies in the time of the camera's path (999.000 to 1010.000 s); numbered frames begin at 0 s; give a pose without a time for each frame
[1]

# Lines of a camera's path without a pose, or given again, are passed over; those of a tool's path tell where it is.
$ cp -r tum lost && printf '%s\n' '999 0 0 0 0 0 0 1' '1000 nan nan nan nan nan nan nan' '1000.05 0 0 0 0 0 0 0' '1010 0 0 0 0 0 0 1' '1010 0 0 0 0 0 0 1' > lost/groundtruth.txt && bash ask.sh --frames lost --trajectory still_tum.txt
vpm-query: note: lost/groundtruth.txt: poses passed over, since their numbers are not finite or all zero: 2
vpm-query: note: lost/groundtruth.txt: lines passed over, since they give the line before again: 1
$ for f in tum lost; do vpm-query --tool cube.vpmg --intrinsics 60,60,31.5,23.5 --frames $f --trajectory still_tum.txt --quiet | python3 fractions.py; done
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
$ printf '%s\n' '0 0 0 0 0 0 1' 'nan nan nan nan nan nan nan' '0 0 0 0 0 0 1' > untimed.txt; bash ask.sh --frames steps --trajectory still.txt --camera-poses untimed.txt
vpm-query: note: untimed.txt: poses passed over, since their numbers are not finite or all zero: 1
vpm-query: warning: steps/frame-000001.depth.png: no pose of its camera; the loop goes on with frame-000000.depth.png
$ sed '1p' still.txt > doubled.txt; bash ask.sh --frames steps --trajectory doubled.txt --camera-pose 0,0,0,0,0,0,1
vpm-query: note: doubled.txt: lines passed over, since they give the line before again: 1
vpm-query: note: the camera does not move: steps is seen from --camera-pose
$ sed '2s/0.95/nan/' still.txt > nan.txt; bash ask.sh --frames steps --trajectory nan.txt
vpm-query: error: nan.txt, line 2: pose: the translation is not finite, or further than 2^100 m from the origin
[1]

# Times that do not ascend are refused with the cure.
$ tac still.txt > back.txt; bash ask.sh --frames steps --trajectory back.txt
vpm-query: error: back.txt, line 2: times must ascend, but 0.000000 s comes after 0.100000 s; sort the lines by their times
[1]
$ (cat still.txt; tail -n 1 still.txt | sed 's/0.95/0.96/') > twice.txt; bash ask.sh --frames steps --trajectory twice.txt
vpm-query: error: twice.txt, line 3: times must ascend, but 0.100000 s has two poses; remove one of the two lines
[1]
$ cp -r tum unsorted && tac tum/groundtruth.txt > unsorted/groundtruth.txt && bash ask.sh --frames unsorted --trajectory still_tum.txt
vpm-query: error: unsorted/groundtruth.txt, line 2: times must ascend, but 999.000000 s comes after 1010.000000 s; sort the lines by their times
[1]

# As ScanNet has them: frames in depth/, and their poses in pose/, which are used.
$ mkdir -p scan/depth scan/pose && for k in 0 1 2; do cp steps/frame-00000$k.depth.png scan/depth/$k.png; printf '%s\n' '1 0 0 0' '0 1 0 0' '0 0 1 -0.05' '0 0 0 1' > scan/pose/$k.txt; done
$ bash ask.sh --frames scan --trajectory still.txt
vpm-query: error: scan: no frames in it, but 3 in its folder depth; give --frames scan/depth
[1]
$ bash ask.sh --frames scan/depth --trajectory still.txt --verbose | grep camera
vpm-query: poses of the camera: pose/ beside the folder of the frames
$ for f in steps scan/depth; do vpm-query --tool cube.vpmg --intrinsics 60,60,31.5,23.5 --frames $f --trajectory still.txt --quiet | python3 fractions.py; done
[0.25, 0.3, 0.35]
[0.5, 0.55, 0.6]
$ (cd scan/depth && vpm-query --tool ../../cube.vpmg --intrinsics 60,60,31.5,23.5 --frames . --trajectory ../../still.txt --quiet) | python3 fractions.py
[0.5, 0.55, 0.6]

# Frames of another size than the first, for which the intrinsics are not, are said once.
$ cp -r steps sizes && sed 's/WIDTH, HEIGHT = .*/WIDTH, HEIGHT = 32, 24/' $SOURCE/tests/tools/frames.py > small.py && python3 small.py numbered small 3 && cp small/frame-00000[12].depth.png sizes/ && bash ask.sh --frames sizes --trajectory still.txt
vpm-query: warning: sizes/frame-000001.depth.png: has 32 x 24 pixels, and the first frame 64 x 48: the same intrinsics hardly fit both
