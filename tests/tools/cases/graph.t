# vpm-graph: from a packing to a tool model.

$ printf 'OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' > cube.off
$ sed 's/^1 1 1$/1 1 2/' cube.off > other.off
$ vpm-pack cube.off -o cube.vpmp --spheres 60 --scale 0.5 --quiet

# A model has levels, and the report describes them.
$ vpm-graph cube.vpmp -o cube.vpmg --levels 10,40,40,500 --report report.json
2> vpm-graph: note: --levels: the packing has 60 spheres; larger levels are left out
$ $VALIDATE graph-report report.json
$ python3 -c "import json; r = json.load(open('report.json')); print(r['spheres'], r['bridges'] == r['components_before'] - 1, r['volume'], [l['spheres'] for l in r['levels']])"
60 True 0.125 [10, 40, 60]
$ python3 -c "import json; r = json.load(open('report.json')); print(max(abs(l['share_sum'] / r['volume'] - 1) for l in r['levels']) < 1e-12)"
True

# The model keeps the solid's surface, unless it is left out. Readers that do not know it pass over it, and queries
# answer the same.
$ vpm-graph cube.vpmp -o small.vpmg --levels 10,40,40,500 --no-surface --quiet
$ python3 -c "import os; print(os.path.getsize('cube.vpmg') - os.path.getsize('small.vpmg') > 12 * 36, b'SRFV' in open('cube.vpmg', 'rb').read(), b'SRFV' in open('small.vpmg', 'rb').read())"
True True False
$ rm small.vpmg

# The tool pipes, and any number of threads gives the same bytes.
$ vpm-graph - -o - --levels 10,40,40,500 --threads 1 < cube.vpmp | cmp - cube.vpmg
2> vpm-graph: note: --levels: the packing has 60 spheres; larger levels are left out
$ vpm-graph cube.vpmp -o - --levels 10,40,40,500 --threads 4 | cmp - cube.vpmg
2> vpm-graph: note: --levels: the packing has 60 spheres; larger levels are left out

# The mesh must be the one that was packed, read in the same unit.
$ vpm-graph cube.vpmp -o cube.vpmg --force --mesh cube.off
$ vpm-graph cube.vpmp -o cube.vpmg --force --mesh other.off
2> vpm-graph: error: cube.vpmp was not made of other.off: their solids have the hashes * and *; pack this mesh, or leave --mesh out (glob)
[1]
$ vpm-graph - -o cube.vpmg --mesh - < cube.vpmp
2> vpm-graph: error: only one of the packing and --mesh can be standard input
[2]

# Unsuitable inputs are refused.
$ vpm-graph cube.vpmg -o out.vpmg
2> vpm-graph: error: cube.vpmg: * (glob)
[1]
$ vpm-graph missing.vpmp -o out.vpmg
2> vpm-graph: error: *missing.vpmp* (glob)
[1]
$ vpm-graph cube.vpmp -o cube.vpmp
2> vpm-graph: error: --output would overwrite the input cube.vpmp; name another output, or give --force
[2]
$ vpm-graph cube.vpmp
2> vpm-graph: error: --output is required (see vpm-graph --help)
[2]
$ vpm-graph cube.vpmp -o out.vpmg --epsilon -1
2> vpm-graph: error: --epsilon: * (glob)
[2]
$ vpm-graph cube.vpmp -o out.vpmg --levels 0
2> vpm-graph: error: --levels: * (glob)
[2]
$ ls
cube.off
cube.vpmg
cube.vpmp
other.off
report.json
