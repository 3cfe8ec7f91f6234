# Poses are spread over threads: the same bytes for any number of them, in the order of the poses, as they come.

$ cp $SOURCE/tests/tools/inputs/* . && python3 $SOURCE/tests/tools/frames.py numbered steps 6
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 50 --quiet
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ python3 -c 'import json; [print(json.dumps({"id": k, "pose": [k % 40 * 1e-2 - 0.2, 0, 0.6 + k * 3e-3, 0, 0, 0, 1]})) for k in range(150)]' > poses.jsonl
$ echo 'vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.jsonl --quiet "$@"' > ask.sh
$ bash ask.sh --threads 1 -o one.jsonl 2>&-; python3 -c 'import json; print([json.loads(l)["id"] for l in open("one.jsonl")] == list(range(150)))'
True
$ for n in 2 4; do bash ask.sh --threads $n -o many.jsonl --force 2>&-; cmp one.jsonl many.jsonl; done

# So it is with every way to ask.
$ for o in "--batch 7" "--bodies --solid cube.off@0,0,0.9,0,0,0,1" "--measure paper" "--collides --level 50" "--spheres-out balls.csv"; do for n in 1 4; do bash ask.sh $o --threads $n -o $n.jsonl --force 2>&-; cat balls.csv 2>&- >> $n.jsonl; rm -f balls.csv; done; cmp 1.jsonl 4.jsonl; done
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '1 0 0 0.95 0 0 0 1' > steps.txt
$ for n in 1 4; do vpm-query --tool cube.vpmg --frames steps --poses steps.txt --rate 10 --intrinsics 60,60,31.5,23.5 --quiet --threads $n -o $n.jsonl --force; done; cmp 1.jsonl 4.jsonl
$ bash ask.sh --threads 4 -o part.jsonl --stats stats.json 2>&- ; python3 -c 'import json; s = json.load(open("stats.json")); print(s["threads"], s["poses"])'
4 150

# Poses before one that cannot be read are answered, and the error is the same.
$ (head -n 5 poses.jsonl; echo '[0, 0, "x"]'; tail -n 5 poses.jsonl) > bad.jsonl
$ for n in 1 4; do vpm-query --tool cube.vpmg --cloud wall.vpmc --poses bad.jsonl --threads $n | cmp - <(head -n 5 one.jsonl); done
2> vpm-query: error: bad.jsonl, line 6: a pose must be a list of numbers
2> vpm-query: error: bad.jsonl, line 6: a pose must be a list of numbers
[1]

# Answers come while the next poses are waited for.
$ mkfifo pipe; vpm-query --tool cube.vpmg --cloud wall.vpmc --poses pipe --threads 4 -o come.jsonl --quiet & exec 3> pipe; head -n 5 poses.jsonl >&3; for k in $(seq 1000); do [ "$(cat come.jsonl.part 2>&- | wc -l)" -ge 5 ] && break; sleep 0.01; done; wc -l < come.jsonl.part; exec 3>&-; wait; cmp come.jsonl <(head -n 5 one.jsonl)
5

# A run that was interrupted goes on with another number.
$ (ulimit -f 16; bash ask.sh --threads 4 -o cut.jsonl 2>&-); bash ask.sh --threads 2 -o cut.jsonl --resume 2>&- && cmp cut.jsonl one.jsonl
