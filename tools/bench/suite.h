// The suites of vpm-bench.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "libvpm/device/device.h"
#include "libvpm/query/shadows.h"
#include "tools/bench/report.h"

namespace vpm::bench {

struct SuiteOptions {
  bool quick = false;  // fewer spheres, poses and runs: seconds instead of minutes
  bool all = false;    // accuracy: every tool, scene and kind of cloud, minutes; packing,
                       // scaling: a million spheres
  std::function<void(double fraction)> progress;
  std::string meshes = {};  // packing: folder of bunny.off, armadillo.obj, fandisk.obj, knot.ply
  std::string data = {};    // accuracy --all, timing: folder of recorded depth images; replay:
                            // likewise, or a recording; empty: none
  bool baseline = false;    // scaling: the measure as printed beside it
  static constexpr std::uint64_t kUsualNoise = 1;
  std::uint64_t noise_seed = kUsualNoise;  // accuracy: which sample of the noise
  Shadows shadows = Shadows::near;         // accuracy; solid: camera clouds alone
  Device device = {};                      // of the queries, where the suite takes a CUDA device
};

// "accuracy, extremes, ...": all suites, or those that take a CUDA device.
std::string suite_names(bool on_device = false);
bool is_suite(const std::string& name);
bool needs_device(const std::string& name);

// Throws Error(invalid_argument) naming the suites there are, or those that take an option which
// this one does not; Error(unavailable) naming those that take a device for one that does not.
Report run_suite(const std::string& name, const SuiteOptions& options);

// Errors of volume, force and torque against the truth, for `paper` and `refined`.
Report run_accuracy(const SuiteOptions& options);

// Inputs at the edge of what is possible: right, or refused in words; else `failure` is set.
Report run_extremes(const SuiteOptions& options);

// Times of every stage from the mesh to the wrench, with 1 and 2 threads.
Report run_timing(const SuiteOptions& options);

// Time against error over everything that a user can turn, and what --max-error and --for-scene
// choose. On a device of the measure there; threads are not varied.
Report run_tradeoff(const SuiteOptions& options);

// Packings beside greedy packers on voxels, growth, and the cost from 10^2 to 10^5 spheres (10^6
// with `all`).
Report run_packing(const SuiteOptions& options);

// A haptic loop on a recorded stream: queries of warm and cold clouds beside what is written by
// hand, coherent poses, preparation of frames, a path through the stream, a soak of 10^6 queries.
// On a device without what only the CPU does: coherent poses, preparation of frames.
Report run_replay(const SuiteOptions& options);

// Queries on a CUDA device against the number of spheres and along a path. Throws
// Error(unavailable) where there is no device, Error(invalid_argument) for the CPU and for several
// devices.
Report run_scaling(const SuiteOptions& options);

}  // namespace vpm::bench
