# Motions: a haptic device holds the tool by a spring and a damper; poses follow each other.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet

# The path goes from free space to 40 mm into the wall in half a second, and rests for a second: 1501 steps at 1 kHz.
$ printf '%s\n' '10 0 0 0.85 0 0 0 1' '10.5 0 0 0.94 0 0 0 1' '11.5 0 0 0.94 0 0 0 1' > device.txt
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses device.txt --coupling stiffness=500,damping=5 --stiffness 2e4 -o steps.jsonl --stats stats.json
2> vpm-query: note: coupling: mass 0.0125 kg, radius of gyration 0.0817 m; to be passive a device that renders this needs a damping of its own of 5.25 N s/m
$ $VALIDATE coupling-step steps.jsonl && $VALIDATE query-stats stats.json && wc -l < steps.jsonl
1501

# At rest spring and contact balance; the tool stays closer to the surface than the device, and energy adds up.
$ tail -n 1 steps.jsonl | python3 -c 'import json; s = json.loads(input()); pull = 500 * (s["device"][2] - s["tool"][2]); print(abs(pull + s["force"][2]) < 1e-3 * pull, abs(pull + s["rendered_force"][2]) < 1e-3 * pull, 0.9 < s["tool"][2] < 0.94)'
True True True
$ tail -n 1 steps.jsonl | python3 -c 'import json; e = json.loads(input())["energy"]; print(abs(e["supplied"] - e["stored"] - e["dissipated"] - e["absorbed"] - e["lost"]) < 1e-12, e["lost"] >= 0)'
True True

# Any number of threads gives the same bytes; a path without times has a step for each pose.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses device.txt --coupling stiffness=500,damping=5,rate=1000,mass=0.0125 --stiffness 2e4 --threads 1 --quiet | cmp - steps.jsonl
$ cut -d' ' -f2- device.txt | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - --coupling stiffness=500,damping=5 --stiffness 2e4 --quiet | wc -l
3

# Coherent poses: a tool that has passed wholly behind the wall is still inside. A single pose counts only places within
# the tool radius behind the wall.
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0 0 1.05 0 0 0 1' '0 0 1.12 0 0 0 1' '0 0 1.3 0 0 0 1' > deep.txt
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --coherent | python3 -c 'import json, sys; print([round(json.loads(line)["volume_fraction"], 2) for line in sys.stdin])'
[0.25, 0.75, 1.0, 1.0]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt | python3 -c 'import json, sys; print([round(json.loads(line)["volume_fraction"], 2) for line in sys.stdin])'
[0.25, 0.75, 0.75, 0.0]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --coherent --batch 2
2> vpm-query: error: --coherent does not go with poses in batches, chosen by --batch: leave it out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses deep.txt --coherent --measure paper
2> vpm-query: error: coherent poses are a matter of the refined measure on the CPU; leave the other measure or device out
[2]

# Parameters that cannot stand the scene's stiffness are warned about, with a cure.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses device.txt --coupling stiffness=500,damping=5 --stiffness 1e7 -o /dev/null --quiet
2> vpm-query: warning: --coupling is stable against contacts up to 6.05e+04 N/m, but with --stiffness 1e+07 this tool can make one of 9.42e+05 N/m: take rate=4242 or more, a larger mass, or less --stiffness

# Wrong usage is refused.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses device.txt --coupling stiffness=500 --stiffness 2e4
2> vpm-query: error: --coupling stiffness=500: give stiffness=N/m,damping=N s/m and, if wanted, mass=kg,rate=Hz
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses device.txt --coupling stiffness=500,damping=-1 --stiffness 2e4
2> vpm-query: error: --coupling stiffness=500,damping=-1: give stiffness=N/m,damping=N s/m and, if wanted, mass=kg,rate=Hz
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses device.txt --coupling stiffness=500,damping=5
2> vpm-query: error: --coupling needs --stiffness: give the scene's stiffness in N/m^3
[2]
$ sed 1p device.txt | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - --coupling stiffness=500,damping=5 --stiffness 2e4 2>&1 >doubled.jsonl | grep -v coupling: ; cmp doubled.jsonl steps.jsonl
vpm-query: note: standard input: lines passed over, since they give the line before again: 1
$ printf '%s\n' '1 0 0 0.85 0 0 0 1' '1 0 0 0.9 0 0 0 1' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - --coupling stiffness=500,damping=5 --stiffness 2e4
2> vpm-query: error: standard input, line 2: times must ascend, but 1.000000 s has two poses; remove one of the two lines
[1]
