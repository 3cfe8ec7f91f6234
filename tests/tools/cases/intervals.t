# How sure an answer is: the same however poses are asked, and nothing else changes. The last pose is free.

$ cp $SOURCE/tests/tools/inputs/* . && cp $SOURCE/formats/golden/v1/surface.vpmg cube.vpmg && vpm-normals wall.png -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet
$ printf '%s\n' '0 0 0.95 0 0 0 1' '0.02 0 0.97 0 0 0.6 0.8' '0 0 0.5 0 0 0 1' > poses.txt
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.txt --interval > sure.jsonl && $VALIDATE query-result sure.jsonl
$ python3 -c "import json; print([(low <= r['volume'] <= high, high - low < 0.05 * 0.008, high > low) for r in map(json.loads, open('sure.jsonl')) for low, high in [r['volume_interval']]])"
[(True, True, True), (True, True, True), (True, True, False)]
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.txt > plain.jsonl; sed 's/"volume_interval":[^]]*],//' sure.jsonl | cmp - plain.jsonl
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.txt --interval --batch 2 --threads 2 | cmp - sure.jsonl; vpm-query --tool cube.vpmg --tool cube.vpmg --cloud wall.vpmc --poses poses.txt --interval | sed -n 's/"tool":1,//p' | cmp - sure.jsonl
$ sed 's/ /,/g; s/.*/{"pose":[&]}/' poses.txt | vpm-query --tool cube.vpmg --cloud wall.vpmc --interval --serve | cmp - sure.jsonl
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.txt --interval --dump-config > call.json && $VALIDATE config.vpm-query call.json && vpm-query --config call.json | cmp - sure.jsonl
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses poses.txt --interval -o sure.csv && python3 -c "import csv, json; print(all([float(r['volume_low']), float(r['volume_high'])] == json.loads(l)['volume_interval'] for r, l in zip(csv.DictReader(open('sure.csv')), open('sure.jsonl'))))"
True
$ vpm-query --tool cube.vpmg --solid cube.vpmg@0.15,0,0,0,0,0,1 --pose 0,0,0,0,0,0,1 --interval | python3 -c "import json, sys; r = json.load(sys.stdin); print(r['volume_interval'] == [r['volume']] * 2)"
True
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --pose 0,0,1,0,0,0,1 --interval --measure paper
2> vpm-query: error: intervals are a matter of the refined measure on the CPU; leave the other measure or device out
[2]
