# A list of inputs: each has an output of its own, as a run for it alone writes it.

$ cp $SOURCE/tests/tools/inputs/* . && for f in a b; do python3 $SOURCE/tests/tools/frames.py numbered $f 3; done; ls a/*.png b/*.png > frames.txt
$ vpm-pack cube.off -o cube.vpmp --spheres 60 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ printf '%s\n' '0 0 0 0.85 0 0 0 1' '1 0 0 1 0 0 0 1' > poses.txt
$ echo 'vpm-normals --list frames.txt -o clouds --intrinsics 60,60,31.5,23.5 "$@"' > normals.sh; bash normals.sh
  inputs   there    made    anew  failed   seconds  per second
       6       0       6       0       0 * (glob)
$ for f in a b; do for k in 0 1 2; do vpm-normals $f/frame-00000$k.depth.png -o one.vpmc --force --intrinsics 60,60,31.5,23.5 && cmp one.vpmc clouds/$f/frame-00000$k.depth.vpmc; done; done
$ find clouds -name '*.vpmc' | sort > clouds.txt; echo 'vpm-query --list clouds.txt --tool cube.vpmg --poses poses.txt -o results "$@"' > query.sh; bash query.sh --jobs 3 --quiet
$ vpm-query --cloud clouds/b/frame-000001.depth.vpmc --tool cube.vpmg --poses poses.txt | cmp - results/clouds/b/frame-000001.depth.jsonl && find results -name '*.jsonl' | wc -l
6
$ printf 'cube.off\n# no line\n\nblock.off\n' > meshes.txt; vpm-pack --list meshes.txt -o packings --spheres 30 --scale 0.01 --report packings/{}.json --jobs 1 | sed 1d; ls packings
       2       0       2       0       0 * (glob)
block.json
block.vpmp
cube.json
cube.vpmp
$ vpm-pack block.off -o one.vpmp --spheres 30 --scale 0.01 --quiet && cmp one.vpmp packings/block.vpmp

# What is done and valid is passed over; what is damaged, or whose input changed, is made anew.
$ find clouds results -type f -printf '%p %T@\n' | sort > before; (bash normals.sh; bash query.sh) | grep -v inputs; find clouds results -type f -printf '%p %T@\n' | sort | cmp - before
       6       6       0       0       0 * (glob)
       6       6       0       0       0 * (glob)
$ cp -r results whole; echo '{}' >> results/clouds/a/frame-000000.depth.jsonl; rm results/clouds/a/frame-000001.depth.jsonl; bash query.sh --verbose
  inputs   there    made    anew  failed   seconds  per second
       6       4       0       2       0 * (glob)
2> vpm-query: clouds/a/frame-000000.depth.vpmc is made anew: it, another input or an output changed
2> vpm-query: clouds/a/frame-000001.depth.vpmc is made anew: it, another input or an output changed
$ diff -r results whole; echo '2 0 0 0.9 0 0 0 1' >> poses.txt; bash query.sh | sed 1d; wc -l < results/clouds/b/frame-000002.depth.jsonl
       6       0       0       6       0 * (glob)
3

# Other options do not take outputs for theirs, before anything is made.
$ echo 'frames/none.vpmc' >> clouds.txt; bash query.sh --stiffness 2
2> vpm-query: error: results/clouds/a/frame-000000.depth.jsonl is of a run with other stiffness; name another folder for --output, or give --force to make all of the list anew
[2]
$ sed -i '$ d' clouds.txt; bash query.sh --stiffness 2 --force | sed 1d; bash query.sh --stiffness 2 | sed 1d
       6       0       0       6       0 * (glob)
       6       6       0       0       0 * (glob)

# Shards have all of the list, each entry once, whatever ran before.
$ for k in 1 2 3 4; do vpm-query --list clouds.txt --tool cube.vpmg --poses poses.txt -o parts --shard $k/4 | sed 1d; done
       2       0       2       0       0 * (glob)
       2       0       2       0       0 * (glob)
       1       0       1       0       0 * (glob)
       1       0       1       0       0 * (glob)
$ bash query.sh --force --quiet && diff -r results parts

# A run that is killed: the same command goes on, and all files have the bytes of a run that was not, notes of what is done too. It is killed where it waits for two pipes.
$ for k in $(seq 60); do p=path.txt; [ $k = 31 ] && p=one.txt; [ $k = 32 ] && p=two.txt; echo "{\"cloud\":\"clouds/a/frame-00000$((k % 3)).depth.vpmc\",\"output\":\"OUT/$k.jsonl\",\"poses\":\"$p\"}"; done > every.txt; seq -f '%g 0 0 0.9 0 0 0 1' 100 | tee path.txt one.txt > two.txt
$ echo 'sed s/OUT/$1/ every.txt > $1.txt; exec vpm-query --list $1.txt --tool cube.vpmg -o $1 --jobs 2' > many.sh; bash many.sh many | sed 1d
      60       0      60       0       0 * (glob)
$ rm one.txt two.txt; mkfifo one.txt two.txt ended; done_of() { ls -A $1 2>&- | grep -c '^[.].*[.]done$'; }; cat ended & all=$!; bash many.sh cut 8> ended & for k in $(seq 3000); do [ "$(done_of cut)" -ge 5 ] && break; sleep 0.01; done; kill -KILL $!; wait $! 2>&-; wait $all; n=$(done_of cut); [ $n -ge 5 ] && [ $n -le 30 ] || echo $n
$ rm one.txt two.txt; tee one.txt two.txt < path.txt > again.txt; bash many.sh cut > said; tail -n 1 said | awk '{ print $1, ($2 >= 3), $2 + $3, $4, $5 }'; diff -r cut many
60 1 60 0 0

# Runs at a time are spread over the GPUs that are to be seen, here two that no machine has. Both wait for pipes until they were seen.
$ rm one.txt two.txt; mkfifo one.txt two.txt; CUDA_VISIBLE_DEVICES=vpm-a,vpm-b bash many.sh gpus > said & for k in $(seq 3000); do cat /proc/[0-9]*/environ 2>&- | tr '\0' '\n' | grep -x 'CUDA_VISIBLE_DEVICES=vpm-[ab]' >> seen; [ $(sort -u seen | wc -l) -eq 2 ] && break; done; cat path.txt > one.txt; cat path.txt > two.txt; wait; sort -u seen; diff -r -x '.*' gpus many
CUDA_VISIBLE_DEVICES=vpm-a
CUDA_VISIBLE_DEVICES=vpm-b

# A process takes one input after the other; if it dies, only the input that it worked on has failed. Poses from pipes keep it waiting.
$ mkfifo one two; for k in 0 1 2; do echo "{\"cloud\":\"clouds/a/frame-00000$k.depth.vpmc\",\"poses\":\"$(echo one two poses.txt | cut -d' ' -f$((k + 1)))\"}"; done > pipes.txt
$ vpm-query --list pipes.txt --tool cube.vpmg -o pipes --jobs 1 & worker() { grep -slx "PPid:.$!" /proc/[0-9]*/status | cut -d/ -f3; }; exec 9> one; first=$(worker); cat poses.txt >&9; exec 9>&-; exec 9> two; [ "$(worker)" = $first ] && kill -SEGV $first; wait $!
  inputs   there    made    anew  failed   seconds  per second
       3       0       2       0       1 * (glob)
2> vpm-query: error: clouds/a/frame-000001.depth.vpmc: its process was ended by a signal: Segmentation fault
2> vpm-query: error: 1 of 3 inputs of pipes.txt failed; the same command tries them again
[1]

# What happens to one input harms no other.
$ printf 'nothing' > a/broken.png; echo a/broken.png >> frames.txt; echo a/missing.png >> frames.txt; bash normals.sh
  inputs   there    made    anew  failed   seconds  per second
       8       6       0       0       2 * (glob)
2> vpm-normals: error: a/broken.png: a/broken.png: * (glob)
2> vpm-normals: error: a/missing.png: cannot read a/missing.png: No such file or directory
2> vpm-normals: error: 2 of 8 inputs of frames.txt failed; the same command tries them again
[1]
$ sed -i '$ d' frames.txt; cp b/frame-000000.depth.png a/broken.png; bash normals.sh | sed 1d
       7       6       1       0       0 * (glob)
$ vpm-pack-broken --list meshes.txt -o broken --quiet
2> vpm-pack: error: cube.off: cube.off: the packing does not hold * (glob)
2> vpm-pack: error: block.off: block.off: the packing does not hold * (glob)
2> vpm-pack: error: 2 of 2 inputs of meshes.txt failed; the same command tries them again
[1]

# A file that is there is no output of a list's.
$ mkdir other && echo mine > other/cube.vpmp; vpm-pack --list meshes.txt -o other --spheres 5 --quiet --scale 0.01; cat other/cube.vpmp
mine
2> vpm-pack: error: cube.off: other/cube.vpmp is there, and was not made by --list; name another folder for --output, or give --force to overwrite it
2> vpm-pack: error: 1 of 2 inputs of meshes.txt failed; the same command tries them again

# Inputs elsewhere have the names that lead to them. A line may have options of its own; other options may have its name.
$ mkdir deep && cd deep && printf '%s\n' ../cube.off $PWD/../block.off > list && vpm-pack --list list -o out --spheres 5 --quiet --scale 0.01 && find out -name '*.vpmp' | sed "s|$(dirname $PWD)||" | sort
out/block.vpmp
out/cube.vpmp
$ for k in 0 1; do echo "0 0 -$k 0 0 0 1" > a/frame-00000$k.depth.at; done; printf '%s\n' a/frame-000000.depth.png '{"depth":"a/frame-000001.depth.png","range":"0.1,9"}' | vpm-normals --list - -o at --camera-pose {}.at --intrinsics 60,60,31.5,23.5 --quiet && vpm-normals a/frame-000001.depth.png --range 0.1,9 -o one.vpmc --force --camera-pose a/frame-000001.depth.at --intrinsics 60,60,31.5,23.5 && cmp one.vpmc at/a/frame-000001.depth.vpmc

# The answers of --collides are those of all lines, also where they were there before.
$ printf '%s\n' '0 0 0 0.5 0 0 0 1' > far.txt; vpm-query --list clouds.txt --tool cube.vpmg --poses far.txt -o far --collides --quiet; for k in 1 2; do vpm-query --list clouds.txt --tool cube.vpmg --poses poses.txt -o hits --collides --quiet; echo $?; done
10
10

# What cannot be meant is refused.
$ bash query.sh --cloud a.vpmc
2> vpm-query: error: cloud is what --list clouds.txt names: leave one of them out
[2]
$ bash query.sh --stats stats.json
2> vpm-query: error: --stats stats.json is one file for all of --list: put {} in its name, for which each input's name is put
[2]
$ vpm-query --list clouds.txt --tool cube.vpmg --poses poses.txt
2> vpm-query: error: --list writes a file for each input: give -o FOLDER
[2]
$ vpm-query --list clouds.txt --tool cube.vpmg --poses poses.txt -o poses.txt
2> vpm-query: error: --output poses.txt is no folder: name one for the outputs of --list
[2]
$ bash query.sh --resume
2> vpm-query: error: --list goes on by itself after what is done: leave --resume out
[2]
$ bash query.sh --shard 5/4
2> vpm-query: error: --shard 5/4: give i/n, such as 1/4 for the first of four
[2]
$ vpm-pack cube.off -o x.vpmp --shard 1/2
2> vpm-pack: error: --shard and --jobs go with --list, which names the inputs
[2]
$ printf 'cube.off\n./cube.ply\n' | vpm-pack --list - -o x
2> vpm-pack: error: standard input: cube.off and ./cube.ply would both be written to x/cube.vpmp; name another output in a line such as {"output":"FILE",...}
[2]
$ echo '# nothing' | vpm-pack --list - -o x
2> vpm-pack: error: standard input: the list is empty; give the name of an input on each line
[1]
$ echo '{"spheres":3}' | vpm-pack --list - -o x
2> vpm-pack: error: standard input:1: the line names no file; give options as in a configuration: {"mesh":"FILE"}
[1]
