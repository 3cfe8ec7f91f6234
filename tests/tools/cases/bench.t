# vpm-bench: messages of suites that cannot run. The reason why there is no device depends on the build.

$ CUDA_VISIBLE_DEVICES= vpm-bench scaling --baseline 2>&1 | sed 's/scaling: this .*/scaling: WHY/'
vpm-bench: error: scaling: WHY
[3]
$ vpm-bench speed
2> vpm-bench: error: there is no suite 'speed'; the suites are accuracy, extremes, packing, replay, scaling, timing, tradeoff
[2]
$ vpm-bench timing --noise-seed 3
2> vpm-bench: error: timing takes no --noise-seed, which is for accuracy; leave it out
[2]
