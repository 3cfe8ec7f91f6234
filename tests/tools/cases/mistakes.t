# Mistakes of scripts and fingers are reported before anything is lost.

$ cp $SOURCE/tests/tools/inputs/* .
$ vpm-pack cube.off -o cube.vpmp --spheres 30 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 10,20
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5
$ printf '%s\n' '0 0 0 0.8 0 0 0 1' '1 0 0 0.95 0 0 0 1' > path.txt

# No output replaces an input without --force.
$ vpm-pack cube.off -o new.vpmp --spheres 3 --report cube.off
2> vpm-pack: error: --report would overwrite the input cube.off; name another output, or give --force
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt -o path.txt
2> vpm-query: error: --output would overwrite the input path.txt; name another output, or give --force
[2]
$ echo '0 wall.png' > list.txt; vpm-query --tool cube.vpmg --frames list.txt --trajectory path.txt -o list.txt
2> vpm-query: error: --output would overwrite the input list.txt; name another output, or give --force
[2]
# What a run keeps its lines in is no input, and no other output, even with --force.
$ cp path.txt kept.part.json; vpm-query --tool cube.vpmg --cloud wall.vpmc --poses kept.part.json -o kept --force
2> vpm-query: error: --output keeps its lines in kept.part.json until they are done, which is the input kept.part.json; name another output
[2]
$ cmp kept.part.json path.txt; rm kept.part.json
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt -o kept --stats kept.part
2> vpm-query: error: --output keeps its lines in kept.part until they are done, which --stats names; name another file
[2]
$ ln -s wall.png link.png; vpm-normals wall.png -o new.vpmc --intrinsics 60,60,31.5,23.5 --report link.png
2> vpm-normals: error: --report would overwrite the input wall.png; name another output, or give --force
[2]
$ cmp cube.off $SOURCE/tests/tools/inputs/cube.off && cmp wall.png $SOURCE/tests/tools/inputs/wall.png && wc -l < path.txt
2
$ cp cube.off gone.off; vpm-pack gone.off --spheres 3 --report gone.off --force --quiet; head -c 1 gone.off
{

# No output replaces another output.
$ vpm-pack cube.off --spheres 3 --report same.json --export ./same.json
2> vpm-pack: error: --report and --export would both be written to ./same.json; name two files
[2]
$ vpm-graph cube.vpmp -o - --report -
2> vpm-graph: error: only one output can be standard output: --output or --report
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --stats -
2> vpm-query: error: only one output can be standard output: --output or --stats
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt -o both.json --stats both.json
2> vpm-query: error: --output and --stats would both be written to both.json; name two files
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt -o /dev/null --stats /dev/null

# An empty variable is not a value.
$ vpm-normals wall.png -o new.vpmc --intrinsics 60,60,31.5,23.5 --camera-pose "$POSE"
2> vpm-normals: error: --camera-pose: its value is empty; give one, or leave the option out (see vpm-normals --help)
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --max-error ''
2> vpm-query: error: --max-error: its value is empty; give one, or leave the option out (see vpm-query --help)
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --level=
2> vpm-query: error: --level: its value is empty; give one, or leave the option out (see vpm-query --help)
[2]
$ echo '{"output": ""}' > empty.json; vpm-pack cube.off --spheres 3 --report - --config empty.json
2> vpm-pack: error: --config empty.json: --output: its value is empty; give one, or leave the option out (see vpm-pack --help)
[2]

# A file without poses is refused.
$ echo '# none' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -
2> vpm-query: error: standard input: no pose in it; each line gives one: tx ty tz qx qy qz qw, or JSON
[1]
$ echo '0 wall.png' > list.txt; : > none.txt; vpm-query --tool cube.vpmg --frames list.txt --trajectory none.txt
2> vpm-query: error: none.txt: no pose in it; each line gives one: tx ty tz qx qy qz qw, or JSON
[1]

# Numbers that are not numbers, or out of range, are refused.
$ vpm-pack cube.off -o new.vpmp --spheres -5
2> vpm-pack: error: --spheres: -5 is not a whole number from 1 to 4294967294 (see vpm-pack --help)
[2]
$ vpm-pack cube.off -o new.vpmp --spheres 18446744073709551616
2> vpm-pack: error: --spheres: 18446744073709551616 is not a whole number from 1 to 4294967294 (see vpm-pack --help)
[2]
$ vpm-pack cube.off -o new.vpmp --inertia-error nan
2> vpm-pack: error: --inertia-error: nan is not a number greater than 0 (see vpm-pack --help)
[2]
$ vpm-graph cube.vpmp -o new.vpmg --epsilon 1mm
2> vpm-graph: error: --epsilon: 1mm is not a number greater than 0 (see vpm-graph --help)
[2]
$ vpm-graph cube.vpmp -o new.vpmg --levels 10,0
2> vpm-graph: error: --levels: 0 is not a whole number from 1 to 4294967295 (see vpm-graph --help)
[2]
$ vpm-query --tool cube.vpmg --frames . --trajectory path.txt --rate nan
2> vpm-query: error: --rate: nan is not a number from 1 to 1e+06 (see vpm-query --help)
[2]
$ vpm-graph --levels 10,20 cube.vpmp -o - | cmp - cube.vpmg

# Options that do not go together are refused; default values, which --dump-config writes, count as not given.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --dump-config | python3 -c "import json, sys; print(sorted(json.load(sys.stdin).keys() & {'batch', 'level', 'frame-rate', 'frame-latency'}))"
['batch', 'frame-latency', 'frame-rate', 'level']
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --dump-config > all.json && vpm-query --config all.json --for-scene --quiet | wc -l
2
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --frame-rate 9 --rate 5 --align-starts
2> vpm-query: error: --rate, --frame-rate and --align-starts do not go with poses in a cloud, chosen because --frames is not given: leave them out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --poses path.txt
2> vpm-query: error: --pose and --poses exclude each other: leave one of them out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc
2> vpm-query: error: --pose or --poses is missing: give one of them
[2]
$ vpm-query --cloud wall.vpmc --poses path.txt
2> vpm-query: error: --tool is missing: give the .vpmg that vpm-graph wrote
[2]
$ vpm-query --tool cube.vpmg --poses path.txt
2> vpm-query: error: --cloud is missing: give the .vpmc that vpm-normals wrote, or --solid or --frames
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --realtime
2> vpm-query: error: --realtime does not go with poses in a cloud, chosen because --frames is not given: leave it out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --frame-latency 1
2> vpm-query: error: --frame-latency does not go with poses in a cloud, chosen because --frames is not given: leave it out
[2]

# Lines that are not poses are refused: binary files, times and number signs in JSON, a time too many.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses .
2> vpm-query: error: cannot read .: Is a directory
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses missing.txt
2> vpm-query: error: cannot read missing.txt: No such file or directory
[1]
$ echo '{"name": "part#3", "time": 5, "pose": [0, 0, 0.95, 0, 0, 0, 1]}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - | wc -l
1
$ for p in '[0, 0, 0.95, 0, 0, 0, 1]' '[7, 0, 0, 0.95, 0, 0, 0, 1]' '0 0 0.95 0 0 0 1 # here'; do echo "$p" | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - | md5sum; done | uniq | wc -l
1
$ echo '{"time": 1, "pose": [1, 0, 0, 0.95, 0, 0, 0, 1]}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -
2> vpm-query: error: standard input, line 1: found 8 numbers; a pose has 7 (tx ty tz qx qy qz qw), 8 (with a time before them) or 16 (4x4, row by row), or 12 without the last row
[1]
$ echo '{"time": "now", "pose": [0, 0, 0.95, 0, 0, 0, 1]}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -
2> vpm-query: error: standard input, line 1: "time" must be a number of seconds
[1]

# Empty cells shift no numbers, a leading zero makes no octal number, and a byte order mark is passed over.
$ for p in '0,0,,0.95,0,0,0,1' ',0,0.95,0,0,0,1' '0,0,0.95,0,0,0,1,'; do echo "$p" | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -; done
2> vpm-query: error: standard input, line 1: number 3 is missing: nothing stands between the commas
2> vpm-query: error: standard input, line 1: number 1 is missing: nothing stands between the commas
2> vpm-query: error: standard input, line 1: number 8 is missing: nothing stands between the commas
[1]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --level 010
2> vpm-query: error: --level: 010 begins with a zero; write it without (see vpm-query --help)
[2]
$ printf '\xEF\xBB\xBF0 0 0.95 0 0 0 1\n' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - | cmp - <(echo '0, 0, 0.95, 0 0 0 1' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -)
$ echo '1e300 0 0 0 0 0 1' | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses -
2> vpm-query: error: standard input, line 1: pose: the translation is not finite, or further than 2^100 m from the origin
[1]

# Options that are gone are refused with what to do instead, those of a configuration too.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --standby-us 100
2> vpm-query: error: --standby-us is gone: leave it out; a device no longer stands by between poses, and results are the same
[2]
$ echo '{"standby-us": 0}' > old.json; vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --config old.json
2> vpm-query: error: --standby-us is gone: leave it out; a device no longer stands by between poses, and results are the same
[2]
$ for gone in count no; do vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --$gone-points; done
2> vpm-query: error: --count-points is gone: leave it out; --measure paper counts them
2> vpm-query: error: --no-points is gone: leave it out; points are counted by --measure paper only
[2]
$ echo '{"no-points": true}' > old.json; vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --config old.json
2> vpm-query: error: --no-points is gone: leave it out; points are counted by --measure paper only
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses path.txt --reuse 0.001
2> vpm-query: error: --reuse is gone: leave it out; a coarser --level trades accuracy for speed
[2]

# Help that cannot be written is an error.
$ vpm-pack --help > /dev/full
2> vpm-pack: error: cannot write to standard output
[4]

# A packing of a repaired mesh is recognised by the mesh.
$ vpm-pack cube.off --repair voxel=20 --spheres 5 -o voxels.vpmp --quiet
$ vpm-graph voxels.vpmp -o voxels.vpmg --mesh cube.off

# A value that a script has left empty is refused, whatever follows it.
$ vpm-pack cube.off -o x.vpmp --report= --quiet; ls ./--quiet 2>&1 | wc -l
1
2> vpm-pack: error: --report: its value is empty; give one, or leave the option out (see vpm-pack --help)
[2]
$ vpm-pack cube.off --spheres 5 -o x.vpmp --link part
2> vpm-pack: error: --link is a name in .yml, .xrdf, .urdf and .srdf; give --export with one of these
[2]

# Two outputs do not share a stream, however it is named; notes do not go into an output file if standard error is
# closed.
$ for out in /dev/stdout /dev/fd/1 /proc/self/fd/1; do vpm-pack cube.off --spheres 5 -o - --report $out; done
2> vpm-pack: error: only one output can be standard output: --output or --report
2> vpm-pack: error: only one output can be standard output: --output or --report
2> vpm-pack: error: only one output can be standard output: --output or --report
[2]
$ (echo first; vpm-pack cube.off --spheres 5 --export five.csv --report /dev/fd/1) > both.txt; head -n 2 both.txt
first
{
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 200 x 200 x 200 mm
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 --for-scene -o closed.jsonl 2>&-; head -c 8 closed.jsonl
{"pose":

# Numbers may be written as CLI11 reads them, which JSON does not.
$ vpm-pack cube.off --scale .1 --spheres 5 -o small.vpmp && vpm-graph small.vpmp --mesh cube.off -o small.vpmg && echo made
made
2> vpm-pack: note: 5 spheres fill 56.4 % of a solid of 20 x 20 x 20 mm
$ vpm-graph cube.vpmp --levels 010 -o x.vpmg
2> vpm-graph: error: --levels: 010 begins with a zero; write it without (see vpm-graph --help)
[2]
$ vpm-graph small.vpmp --levels 2,99 -o x.vpmg
2> vpm-graph: note: --levels: the packing has 5 spheres; larger levels are left out
$ vpm-normals wall.png --window 011 -o x.vpmc
2> vpm-normals: error: --window: 011 begins with a zero; write it without (see vpm-normals --help)
[2]
$ python3 -c 'print("{\"spheres\": " + 100000 * "[" + 100000 * "]" + "}")' > deep.json; vpm-pack cube.off --config deep.json -o x.vpmp
2> vpm-pack: error: --config deep.json: the configuration is nested too deeply (see vpm-pack --help)
[2]
$ vpm-pack cube.off --spheres 3 --spheres 4 -o x.vpmp
2> vpm-pack: error: --spheres has several values; leave all but one out (see vpm-pack --help)
[2]
$ vpm-pack cube.off --spheres 3 -o $NO_SUCH_VARIABLE --report
2> vpm-pack: error: --output: its value is missing; --report is an option
[2]
$ echo '{"coverage": -1e999}' > large.json; vpm-pack cube.off --config large.json -o x.vpmp
2> vpm-pack: error: --config large.json: the configuration is not readable: one of its numbers is beyond what a double holds (see vpm-pack --help)
[2]
$ vpm-pack cube.off --repair flood --max-hole 50 -o x.vpmp
2> vpm-pack: error: --max-hole 50 m is more than the mesh is across, 0.346 m: nothing of it would be reached from outside; is it in metres?
[2]

# Numbers of a pose, intrinsics or a range may stand between blanks and in brackets, in a configuration as lists.
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,0.95,0,0,0,1 -o commas.jsonl
$ for p in '0 0 0.95 0 0 0 1' '[0, 0, 0.95, 0, 0, 0, 1]'; do vpm-query --tool cube.vpmg --cloud wall.vpmc --pose "$p" | cmp - commas.jsonl; done
$ echo '{"pose": [0, 0, 0.95, 0, 0, 0, 1]}' | vpm-query --tool cube.vpmg --cloud wall.vpmc --config - | cmp - commas.jsonl
$ vpm-normals wall.png -o - --intrinsics '60 60 31.5 23.5' | cmp - wall.vpmc
$ echo '{"intrinsics": [60, 60, 31.5, 23.5], "camera-pose": [1, 2, 3, 0, 0, 0, 1], "range": [0.1, 5]}' > lists.json; vpm-normals wall.png --export lists.ply --config lists.json && vpm-normals wall.png --export options.ply --intrinsics '[60, 60, 31.5, 23.5]' --camera-pose '1 2 3 0 0 0 1' --range '0.1 5' && cmp lists.ply options.ply
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose '0 0 0.95'
2> vpm-query: error: --pose: expected 7 numbers tx,ty,tz,qx,qy,qz,qw but found 3 in '0 0 0.95'
[2]

# Files of the current folder are no libraries, whatever their names.
$ for library in libpng16.so.16 libtbb.so.12 libstdc++.so.6 libvpm.so.0 libvpm_voxels.so; do echo none > $library; done
$ for program in vpm-pack vpm-graph vpm-normals vpm-query vpm-bench; do $program --version; done
vpm-pack 0.1.0
vpm-graph 0.1.0
vpm-normals 0.1.0
vpm-query 0.1.0
vpm-bench 0.1.0
$ vpm-query --tool cube.off --solid cube.off --pose 0,0,0,0,0,0,1 -o here.jsonl --quiet && rm lib*.so*
