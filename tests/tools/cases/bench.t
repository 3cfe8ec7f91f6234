# vpm-bench: messages of suites that cannot run. The reason why there is no device depends on the build.

$ CUDA_VISIBLE_DEVICES= vpm-bench scaling 2>&1 | sed 's/scaling: this .*/scaling: WHY/'
vpm-bench: error: scaling: WHY
[3]
$ vpm-bench speed
2> vpm-bench: error: there is no suite 'speed'; the suites are accuracy, cameras, extremes, intervals, packing, pairs, peers, replay, scaling, timing, tradeoff
[2]
$ vpm-bench timing --noise-seed 3
2> vpm-bench: error: timing takes no --noise-seed, which is for accuracy; leave it out
[2]

# A folder is made, but none above it, whose name may be a typing error. Results are kept.
$ vpm-bench extremes --quick --quiet --out resluts/today
2> vpm-bench: error: cannot make the folder resluts/today: No such file or directory; correct its name, or make the folder above it
[4]
$ mkdir today && echo {} > today/extremes.json && vpm-bench extremes --quick --quiet --out today
2> vpm-bench: error: today/extremes.json exists; name another output, or give --force to overwrite it
[2]
