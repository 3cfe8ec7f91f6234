# From a mesh and a depth image to volume, force and torque. Every report and result keeps its schema.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 200 --validate --report pack.json
2> vpm-pack: note: voxels: 0.776272 of the volume covered, 0 voxels of spheres outside, 0 of two spheres
2> vpm-pack: note: 200 spheres fill 77.6 % of a solid of 200 x 200 x 200 mm
$ vpm-graph cube.vpmp -o cube.vpmg --levels 50 --report graph.json
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --report normals.json
$ printf '%s\n' '0 0 0 0.8 0 0 0 1' '1 0 0 0.95 0 0 0 1' '2 0 0 1 0 0 0 1' > path.txt
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt -o result.jsonl --stats stats.json
$ $VALIDATE pack-report pack.json && $VALIDATE graph-report graph.json && $VALIDATE normals-report normals.json
$ $VALIDATE query-result result.jsonl && $VALIDATE query-stats stats.json

# The wall is at 1 m and the cube's half side 0.1 m: nothing, a quarter, and half of it is behind the wall.
$ python3 -c 'import json; print([round(json.loads(line)["volume_fraction"], 2) for line in open("result.jsonl")])'
[0.0, 0.25, 0.5]
$ python3 -c 'import json; print([round(x, 4) + 0.0 for x in json.loads(open("result.jsonl").readlines()[1])["force"]])'
[0.0, 0.0, -0.002]

# A single pose gives the same line as the path; results of the printed measure keep their schema too.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.8,0,0,0,1 | cmp - <(head -n 1 result.jsonl)
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --measure paper --level 50 | $VALIDATE query-result -

# The tools pipe, and identical input gives identical bytes.
$ vpm-pack - -o - --spheres 200 < cube.off | tee piped.vpmp | vpm-graph - -o - --levels 50 | cmp - cube.vpmg
2> vpm-pack: note: 200 spheres fill 77.6 % of a solid of 200 x 200 x 200 mm
$ vpm-normals - -o - --intrinsics 60,60,31.5,23.5 < wall.png | vpm-query --tool cube.vpmg --cloud - --poses path.txt | cmp - result.jsonl
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - --threads 1 < path.txt | cmp - result.jsonl

# Configurations keep their schemas, and give the same call again.
$ for t in pack graph normals query bench; do for o in $(vpm-$t --help-all | sed -nE 's/^  (-., )?--([a-z-]+).*/\2/p' | grep -vE '^(help|help-all|version|config|dump-config)$'); do grep -q "\"$o\"" $(dirname $VALIDATE)/../../formats/schemas/config.vpm-$t.json || echo vpm-$t --$o; done; done
$ for t in pack graph normals query bench; do vpm-$t --dump-config > $t.json && $VALIDATE config.vpm-$t $t.json; done
$ vpm-graph cube.vpmp -o again.vpmg --levels 50 --dump-config > call.json && $VALIDATE config.vpm-graph call.json && vpm-graph --config call.json && cmp again.vpmg cube.vpmg
$ vpm-normals wall.png -o again.vpmc --intrinsics 60,60,31.5,23.5 --dump-config > call.json && $VALIDATE config.vpm-normals call.json && vpm-normals --config call.json && cmp again.vpmc wall.vpmc

# Benchmarks keep their schema.
$ vpm-bench accuracy --quick --quiet --out bench && $VALIDATE bench-results bench/accuracy.json

# Files of another kind are refused as inputs, and not replaced as outputs.
$ vpm-query --tool wall.vpmc --cloud wall.vpmc --poses path.txt
2> vpm-query: error: wall.vpmc: this is a cloud (.vpmc); needed is a tool model (.vpmg), which vpm-graph writes
[1]
$ vpm-graph cube.vpmg -o other.vpmg
2> vpm-graph: error: cube.vpmg: this is a tool model (.vpmg); needed is a packing (.vpmp), which vpm-pack writes
[1]
$ vpm-graph cube.vpmp -o wall.vpmc
2> vpm-graph: error: wall.vpmc exists and is a cloud (.vpmc); name another output, or give --force to overwrite it
[2]
$ vpm-pack cube.off -o path.txt --spheres 5
2> vpm-pack: error: path.txt exists; name another output, or give --force to overwrite it
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt -o cube.vpmg
2> vpm-query: error: --output would overwrite the input cube.vpmg; name another output, or give --force
[2]
$ vpm-pack open.off -o new.vpmp
2> vpm-pack: error: open.off: the mesh is open: 3 edges of one triangle in 1 hole, a loop through (0.1, 0.1, 0.1); * (glob)
[1]
$ vpm-query --tool missing.vpmg --cloud wall.vpmc --poses path.txt
2> vpm-query: error: cannot read missing.vpmg: No such file or directory
[1]
$ ls
again.vpmc
again.vpmg
arm.urdf
bench
bench.json
block.off
call.json
cube.off
cube.vpmg
cube.vpmp
graph.json
normals.json
open.off
pack.json
path.txt
pins.off
piped.vpmp
query.json
result.jsonl
stats.json
wall.png
wall.vpmc
