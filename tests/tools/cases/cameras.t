# Several cameras are one body. One sees the front of a slab of .3 m, the other its back.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ vpm-normals wall.png -o front.vpmc --intrinsics 60,60,31.5,23.5 --quiet && vpm-normals wall.png -o back.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,2.3,0,1,0,0 --quiet
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0 0 1.12 0 0 0 1' '0 0 1.3 0 0 0 1' '0 0 1.5 0 0 0 1' '0 3 1.5 0 0 0 1' > poses.txt

# What both hide is inside as a whole; what one sees free is free, and unseen is what none sees.
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud back.vpmc --poses poses.txt --bodies > both.jsonl && $VALIDATE query-result both.jsonl && python3 -c "import json; lines = [json.loads(l) for l in open('both.jsonl')]; print([(round(r['volume_fraction'], 2), round(r['seen_free'], 2), round(r['unseen'], 2), round(r['out_of_view'], 2)) for r in lines]); print([len(r['bodies']) for r in lines], [round(r['force'][2] / (r['volume'] or 1)) + 0 for r in lines])"
[(0.25, 0.75, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (0.5, 0.5, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)]
[1, 1, 1, 1, 1] [-1, 0, 1, 0, 0]

# Their order, and one that is given twice, change no byte; one alone is itself.
$ for a in "back front" "front back front"; do vpm-query --tool cube.vpmg $(printf -- '--cloud %s.vpmc ' $a) --poses poses.txt --bodies | cmp - both.jsonl; done
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud front.vpmc --poses poses.txt > twice.jsonl && vpm-query --tool cube.vpmg --cloud front.vpmc --poses poses.txt | cmp - twice.jsonl
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud back.vpmc --poses poses.txt --bodies --batch 4 --threads 2 | cmp - both.jsonl
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud back.vpmc --poses poses.txt --bodies --dump-config > call.json && $VALIDATE config.vpm-query call.json && vpm-query --config call.json | cmp - both.jsonl
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud back.vpmc --poses poses.txt --view both.html -o again.jsonl --quiet && grep -c '<html' both.html
1

# A camera whose pose or unit is wrong sees free what others show.
$ vpm-normals wall.png -o beyond.vpmc --intrinsics 60,60,31.5,23.5 --depth-scale 300 --quiet; vpm-query --tool cube.vpmg --cloud front.vpmc --cloud beyond.vpmc --cloud back.vpmc --pose 0,0,0.95,0,0,0,1 -o wrong.jsonl
2> vpm-query: warning: beyond.vpmc: 100 % of what it and another camera know is solid to one and free to the other: is its vpm-normals --camera-pose from camera to world, in metres, and vpm-normals --depth-scale right?

# Cameras that are wrong by little are moved until they agree, half way each, in any order; the wall tells nothing of motions along it.
$ vpm-normals wall.png -o near.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,0.006,0,0,0,1 --quiet && vpm-query --tool cube.vpmg --cloud front.vpmc --cloud near.vpmc --pose 0,0,0.95,0,0,0,1 --register -o moved.jsonl
2> vpm-query: note: --register: the images disagree by 0.00 mm, and disagreed by 8.88 mm; they tell 3 of 6 motions of cameras against each other; the others stay
2> vpm-query: note: front.vpmc: its camera is moved by 3.00 mm and 0.000 degrees, to 0.000000,0.000000,0.003000,0.0000000,0.0000000,0.0000000,1.0000000
2> vpm-query: note: near.vpmc: its camera is moved by 3.00 mm and 0.000 degrees, to 0.000000,0.000000,0.003000,0.0000000,0.0000000,0.0000000,1.0000000
$ vpm-query --tool cube.vpmg --cloud near.vpmc --cloud front.vpmc --pose 0,0,0.95,0,0,0,1 --register --quiet | cmp - moved.jsonl; vpm-query --tool cube.vpmg --cloud near.vpmc --cloud front.vpmc --pose 0,0,0.95,0,0,0,1 --register --dump-config > call.json && $VALIDATE config.vpm-query call.json; python3 -c "import json; print(round(json.load(open('moved.jsonl'))['volume_fraction'], 2))"
0.24
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud back.vpmc --poses poses.txt --register; vpm-query --tool cube.vpmg --cloud front.vpmc --poses poses.txt --register
2> vpm-query: error: front.vpmc: --register: it shows hardly a surface that another one shows too, within 5 % of the depth: nothing tells where its camera is; leave it out, or calibrate its camera
2> vpm-query: error: --register makes the images of cameras agree: give several --cloud
[2]

# Eight millimetres between two sides are uncertain where cameras disagree by more, also after those on one side were made to agree.
$ vpm-normals wall.png -o thin.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0,0,2.008,0,1,0,0 --quiet && vpm-query --tool cube.vpmg --cloud front.vpmc --cloud thin.vpmc --pose 0,0,0.95,0,0,0,1 -o two_sides.jsonl
$ vpm-normals wall.png -o behind.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose 0.01,0,2.008,0,1,0,0 --quiet; for more in '' --register; do vpm-query --tool cube.vpmg --cloud front.vpmc --cloud near.vpmc --cloud thin.vpmc --cloud behind.vpmc --pose 0,0,0.95,0,0,0,1 $more -o thin$more.jsonl 2>&1 | grep warning; done
vpm-query: warning: something about * mm thin is seen from both sides by cameras that disagree by 9.* mm: how much of it is in the way is uncertain; calibrate them better (glob)
vpm-query: warning: something about * mm thin is seen from both sides by cameras that disagree by 9.* mm: how much of it is in the way is uncertain; calibrate them better (glob)

# Points without a camera join no others.
$ printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' 'property float nx' 'property float ny' 'property float nz' end_header '0 0 1 0 0 -1' '0 1 1 0 0 -1' '1 0 1 0 0 -1' > points.ply && vpm-normals points.ply -o points.vpmc --quiet
$ vpm-query --tool cube.vpmg --cloud front.vpmc --cloud points.vpmc --poses poses.txt
2> vpm-query: error: points.vpmc: several clouds are one body by their cameras, but this one keeps none; give it as the only --cloud, or make it of the depth image by vpm-normals
[1]
