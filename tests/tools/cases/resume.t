# An interrupted run loses nothing: its lines stand beside the output, and --resume goes on after the last whole one.

$ cp $SOURCE/tests/tools/inputs/* . && python3 $SOURCE/tests/tools/frames.py numbered steps 6
$ vpm-pack cube.off -o cube.vpmp --spheres 60 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet && vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ python3 -c 'import json; [print(json.dumps({"id": f"{k},\n\"", "pose": [0, 0, 0.9 + k / 4000, 0, 0, 0, 1]})) for k in range(400)]' > poses.jsonl
$ echo 'vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.jsonl "$@"' > ask.sh
$ for f in jsonl csv; do bash ask.sh -o whole.$f; done

# A disk that is full cuts a line; of what is kept, the whole lines count, in CSV also where a field has an end of line.
$ (ulimit -f 16; bash ask.sh -o cut.jsonl)
2> vpm-query: note: * lines are kept in cut.jsonl.part: --resume goes on after them (glob)
2> vpm-query: error: cannot write cut.jsonl: File too large
[4]
$ (ulimit -f 16; bash ask.sh -o cut.csv --quiet); ls cut.*
cut.csv.part
cut.csv.part.json
cut.jsonl.part
cut.jsonl.part.json
2> vpm-query: error: cannot write cut.csv: File too large
$ tail -c 1 cut.jsonl.part | grep -c . && head -n 3 cut.jsonl.part | cmp - <(head -n 3 whole.jsonl)
1
$ bash ask.sh -o cut.jsonl
2> vpm-query: error: cut.jsonl.part holds lines of a run that was interrupted: give --resume to go on after them, or --force to begin anew
[2]
$ for f in jsonl csv; do bash ask.sh -o cut.$f --resume --stats stats.json --force && cmp cut.$f whole.$f && $VALIDATE query-stats stats.json && grep -c '"poses": [123]..,' stats.json; done; ls cut.*
1
1
cut.csv
cut.jsonl

# After a run that has ended nothing is left to do.
$ cp cut.csv before.csv; touch -d 2001-01-01 cut.csv; bash ask.sh -o cut.csv --resume && cmp cut.csv before.csv && [ cut.csv -ot before.csv ]; ls cut.csv*
cut.csv
2> vpm-query: note: nothing is left to do, since the run of cut.csv has ended; --force makes it anew

# A run that is killed; the clock changes no result.
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '20 0 0 0.95 0 0 0 1' > path.txt; echo 'exec vpm-query --tool cube.vpmg --frames steps --trajectory path.txt --intrinsics 60,60,31.5,23.5 --rate 100 --quiet "$@"' > replay.sh
$ bash replay.sh > steps.jsonl; wc -l < steps.jsonl
2001
$ bash replay.sh --realtime -o killed.jsonl & for k in $(seq 3000); do [ "$(cat killed.jsonl.part 2>&- | wc -l)" -ge 5 ] && break; sleep 0.01; done; kill -KILL $!; wait $! 2>&-; ls killed.*
killed.jsonl.part
killed.jsonl.part.json
$ bash replay.sh -o killed.jsonl --resume && cmp killed.jsonl steps.jsonl && ls killed.*
killed.jsonl

# So it is with batches, with several tools, also within the lines of a pose, and where a pose depends on those before.
$ for o in "--batch 7" "--tool cube.vpmg" "--coherent" "--coupling stiffness=500,damping=5 --stiffness 2e4"; do bash ask.sh $o > all.jsonl; rm -f part.jsonl; (ulimit -f 17; bash ask.sh $o -o part.jsonl --quiet 2>&-); bash ask.sh $o -o part.jsonl --resume --quiet && cmp part.jsonl all.jsonl; done
2> vpm-query: note: coupling: mass 0.0125 kg, radius of gyration 0.0817 m; to be passive a device that renders this needs a damping of its own of 5.25 N s/m
$ for o in "" "--coupling stiffness=500,damping=5 --stiffness 2e4"; do bash replay.sh $o > all.jsonl; rm -f part.jsonl; (ulimit -f 4; bash replay.sh $o -o part.jsonl 2>&-); bash replay.sh $o -o part.jsonl --resume && cmp part.jsonl all.jsonl; done

# Lines of another run are refused: other options, other files, fewer poses. Without lines --resume begins the run.
$ (ulimit -f 16; bash ask.sh -o other.jsonl --quiet 2>&-); bash ask.sh -o other.jsonl --resume --stiffness 2 --measure paper
2> vpm-query: error: other.jsonl.part: its lines are of a run with other measure, stiffness; give the same options and files, or --force without --resume to begin anew
[2]
$ echo >> poses.jsonl && bash ask.sh -o other.jsonl --resume
2> vpm-query: error: other.jsonl.part: its lines are of a run with other poses; give the same options and files, or --force without --resume to begin anew
[2]
$ bash ask.sh -o other.jsonl --force && cmp other.jsonl whole.jsonl && ls other.*
other.jsonl
$ bash ask.sh -o begun.jsonl --resume && cmp begun.jsonl whole.jsonl

# What cannot go on is refused before the work begins.
$ bash ask.sh --resume
2> vpm-query: error: --resume needs --output: name the file of the run that was interrupted
[2]
$ bash ask.sh --resume -o x.jsonl --view x.html
2> vpm-query: error: --resume and --view exclude each other: leave one of them out
[2]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - --resume -o x.jsonl < poses.jsonl
2> vpm-query: error: --resume compares files with those of the run before: name one for --poses in place of -
[2]
$ ls x.*
2> ls: cannot access 'x.*': No such file or directory
[2]
