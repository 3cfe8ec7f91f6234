# vpm-pack: spheres that grow together, the inertia as a limit, and runs that end without an output.

$ printf 'OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' > cube.off
$ sed 's/^\(.*\) 1$/\1 1.7/' cube.off > box.off
$ vpm-pack box.off -o greedy.vpmp --spheres 30 --report greedy.json
2> vpm-pack: note: 30 spheres fill 62 % of a solid of 1 x 1 x 1.7 m
$ vpm-pack box.off -o grown.vpmp --spheres 30 --grow --report grown.json
2> vpm-pack: note: 30 spheres fill 63.3 % of a solid of 1 x 1 x 1.7 m
$ python3 -c 'import json; a, b = json.load(open("greedy.json")), json.load(open("grown.json")); print(b["spheres"], b["certified"], b["coverage"] > a["coverage"], abs(b["coverage"] * b["volume_mesh"] - b["volume_spheres"]) < 1e-12)'
30 True True True
$ vpm-pack box.off -o - --spheres 30 --grow --threads 1 | cmp - grown.vpmp
2> vpm-pack: note: 30 spheres fill 63.3 % of a solid of 1 x 1 x 1.7 m
$ $VALIDATE pack-report grown.json
$ vpm-pack box.off --spheres 30 --grow --inertia-error 0.02 --dump-config > config.json && $VALIDATE config.vpm-pack config.json

# The inertia tensor of the packing comes near to the box's.
$ vpm-pack box.off --spheres 5000 --inertia-error 0.1 --report inertia.json --export inertia.csv
2> vpm-pack: note: 174 spheres fill 73.4 % of a solid of 1 x 1 x 1.7 m
$ $VALIDATE pack-report inertia.json
$ python3 -c 'import json; r = json.load(open("inertia.json")); print(r["stop_reason"], r["inertia_error"] <= 0.1, r["spheres"] < 5000)'
inertia_error True True
$ vpm-pack box.off --inertia-error 0 -o none.vpmp
2> vpm-pack: error: --inertia-error: *(see vpm-pack --help) (glob)
[2]

# Thin solids are packed, or refused with the reason.
$ sed 's/^\(.*\) 1$/\1 0.0001/' cube.off > sheet.off && vpm-pack sheet.off --spheres 20 --report - | python3 -c 'import json, sys; r = json.load(sys.stdin); print(r["spheres"], round(r["r_max"], 9), r["partly_searched"])'
20 5e-05 False
2> vpm-pack: note: 20 spheres fill 1.05e-05 % of a solid of 1 x 1 x 0.0001 m
$ sed 's/^\(.*\) 1$/\1 0.000001/' cube.off > foil.off && vpm-pack foil.off -o foil.vpmp
2> vpm-pack: error: foil.off: no sphere fits: the solid is nowhere wider than 1/131072 of its longest side, the smallest sphere that is searched for; pack it in parts
[1]

# A packing that fails its certificate leaves no output of any kind.
$ vpm-pack-broken cube.off -o broken.vpmp --export broken.csv --report broken.json
2> vpm-pack: error: cube.off: the packing does not hold its certificate (* nothing is written. * (glob)
[1]

# An interrupted run leaves no output and no half-written file.
$ timeout --signal=INT 1 vpm-pack cube.off -o half.vpmp --spheres 10000000; test $? -ge 124 && echo interrupted
interrupted
$ ls -A
box.off
config.json
cube.off
foil.off
greedy.json
greedy.vpmp
grown.json
grown.vpmp
inertia.csv
inertia.json
sheet.off
