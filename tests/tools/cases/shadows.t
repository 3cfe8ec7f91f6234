# Places that a depth image does not show: options for what counts of them.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0 0 1.05 0 0 0 1' '0 0 1.12 0 0 0 1' '0 0 1.3 0 0 0 1' > deep.txt

# Places near behind the wall count, which is the default, or all of them.
$ for s in near solid; do vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --shadows $s -o $s.jsonl; python3 -c "import json; print([round(json.loads(line)['volume_fraction'], 2) for line in open('$s.jsonl')])"; done
[0.25, 0.75, 0.75, 0.0]
[0.25, 0.75, 1.0, 1.0]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt | cmp - near.jsonl
$ echo '{"shadows": "solid"}' > solid.json && vpm-query --config solid.json --tool cube.vpmg --cloud wall.vpmc --poses deep.txt | cmp - solid.jsonl
$ for batch in 1 3; do for threads in 1 2; do vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --shadows solid --batch $batch --threads $threads | cmp - solid.jsonl; done; done
$ mkdir frames && cp wall.png frames/0.png && vpm-query --tool cube.vpmg --frames frames --trajectory deep.txt --rate 1 --intrinsics 60,60,31.5,23.5 --shadows solid --quiet | python3 -c "import json, sys; print([json.loads(l)['volume'] for l in sys.stdin])" | cmp - <(python3 -c "import json; print([json.loads(l)['volume'] for l in open('solid.jsonl')])")

# Page, header and help tell the rule in the same words.
$ vpm-query --help > help.txt; python3 -c "import re, sys; rule = 'counts of the places that a depth image does not show. near: those at most the tool radius behind what it shows, and further behind those that a surface which cuts the tool supports. solid: all of them'; print([rule in re.sub(r'[\s/\x60]+', ' ', open(f).read()).replace(' near :', ' near:').replace(' solid :', ' solid:') for f in sys.argv[1:]])" help.txt $SOURCE/tools/query/README.md $SOURCE/libvpm/include/vpm/query_types.h
[True, True, True]

# Points without a camera hide nothing, and the measure as printed ignores the option.
$ printf '%s\n' ply 'format ascii 1.0' 'element vertex 3' 'property float x' 'property float y' 'property float z' 'property float nx' 'property float ny' 'property float nz' end_header '0 0 1 0 0 -1' '0 1 1 0 0 -1' '1 0 1 0 0 -1' > points.ply && vpm-normals points.ply -o points.vpmc --quiet
$ vpm-query --tool cube.vpmg --cloud points.vpmc --poses deep.txt --shadows solid
2> vpm-query: error: of points without a camera nobody knows what they hide: solid shadows need a cloud that keeps its depth image
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --shadows solid --measure paper
2> vpm-query: error: solid shadows are a matter of the refined measure; leave the other measure out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --shadows all
2> vpm-query: error: --shadows: all not in {near,solid} (see vpm-query --help)
[2]

# Nothing counts before the first good frame.
$ mkdir late && cp wall.png late/1.png && truncate -s 60 late/1.png && cp wall.png late/2.png && vpm-query --tool cube.vpmg --frames late --trajectory deep.txt --rate 1 --frame-rate 1 --intrinsics 60,60,31.5,23.5 --shadows solid 2>/dev/null | python3 -c "import json, sys; print([round(json.loads(l)['volume_fraction'], 2) for l in sys.stdin])"
[0.0, 0.75, 1.0, 1.0]
