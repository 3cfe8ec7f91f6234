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
