# Poses are spread over threads: the same bytes for any number of them, in the order of the poses, as they come.

$ cp $SOURCE/tests/tools/inputs/* . && python3 $SOURCE/tests/tools/frames.py numbered steps 6
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 50 --quiet
$ vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ python3 -c 'import json; [print(json.dumps({"id": k, "pose": [k % 40 * 1e-2 - 0.2, 0, 0.6 + k * 3e-3, 0, 0, 0, 1]})) for k in range(150)]' > poses.jsonl
$ echo 'vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.jsonl --quiet "$@"' > ask.sh
$ bash ask.sh --threads 1 -o one.jsonl 2>&-; python3 -c 'import json; print([json.loads(l)["id"] for l in open("one.jsonl")] == list(range(150)))'
True
$ for n in 2 3 16; do bash ask.sh --threads $n -o many.jsonl --force 2>&-; cmp one.jsonl many.jsonl; done

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

# Lines that need those around them, lists and arrays among plain lines change nothing, wherever they stand.
$ python3 $SOURCE/tests/tools/pose_files.py
$ for f in windows over-lines list words mixed array bad-list bad-words bad-end bad-array; do for n in 1 2 3 16; do vpm-query --tool cube.vpmg --cloud wall.vpmc --poses $f --threads $n > $n.jsonl 2> $n.txt; echo $? >> $n.txt; cmp $n.jsonl 1.jsonl; cmp $n.txt 1.txt; done; cat $f | vpm-query --tool cube.vpmg --cloud wall.vpmc --poses - --threads 3 2>&- | cmp - 1.jsonl; wc -l < 1.jsonl; grep -h error 1.txt; done
150
150
150
150
150
150
40
vpm-query: error: bad-list, line 41, pose 2: pose: the quaternion has length 0.000000 instead of 1; give x,y,z,w of a unit quaternion
40
vpm-query: error: bad-words, line 41: column 7 is not a number: one
40
vpm-query: error: bad-end, line 41: a bracket that opens here is not closed; close it, or write a pose on each line
90
vpm-query: error: bad-array, pose 91: the quaternion has length 0.000000 instead of 1; give x,y,z,w of a unit quaternion

# Answers come while the next poses are waited for.
$ mkfifo pipe; vpm-query --tool cube.vpmg --cloud wall.vpmc --poses pipe --threads 4 -o come.jsonl --quiet & exec 3> pipe; head -n 5 poses.jsonl >&3; for k in $(seq 1000); do [ "$(cat come.jsonl.part 2>&- | wc -l)" -ge 5 ] && break; sleep 0.01; done; wc -l < come.jsonl.part; exec 3>&-; wait; cmp come.jsonl <(head -n 5 one.jsonl)
5

# So they do where a line needs the next one, or none comes for the next pose.
$ printf '%s\n' '[0, 0, 0.9, 0, 0, 0, 1]' '[0, 0, 0.9,' '0, 0, 0, 1]' '# a pause' > start; mkfifo again; vpm-query --tool cube.vpmg --cloud wall.vpmc --poses again --threads 4 -o again.jsonl --quiet & exec 3> again; cat start >&3; for k in $(seq 1000); do [ "$(cat again.jsonl.part 2>&- | wc -l)" -ge 2 ] && break; sleep 0.01; done; wc -l < again.jsonl.part; cat start >&3; exec 3>&-; wait; wc -l < again.jsonl
2
4

# A run that was interrupted goes on with another number.
$ (ulimit -f 16; bash ask.sh --threads 4 -o cut.jsonl 2>&-); bash ask.sh --threads 2 -o cut.jsonl --resume 2>&- && cmp cut.jsonl one.jsonl

# A pose that is refused ends a run with several threads as with one, also where it comes in a list before plain lines.
$ one='"solids":[[0,0,9,0,0,0,1]]'; two='"solids":[[0,0,9,0,0,0,1],[0,0,9,0,0,0,1]]'; tool='"tool":[0,0,0.9,0,0,0,1]'; (echo "[{$tool,$one},{$tool,$two}]"; for k in $(seq 20); do echo "{$tool,$one}"; done) > listed.jsonl
$ for n in 1 3; do vpm-query --tool cube.vpmg --cloud wall.vpmc --solid cube.vpmg --poses listed.jsonl --threads $n > listed.$n 2> said.$n; echo $?; done; cmp listed.1 listed.3 && cmp said.1 said.3; wc -l < listed.3
1
1
1
