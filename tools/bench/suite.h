// The suites of vpm-bench.
#pragma once

#include <vpm/device.h>
#include <vpm/query_types.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/device/device.h"
#include "tools/bench/report.h"

namespace vpm::bench {

struct SuiteOptions {
  bool quick = false;  // fewer spheres, poses and runs: seconds instead of minutes
  // accuracy: every tool, scene and kind of cloud; packing, scaling: a million spheres
  bool all = false;
  std::function<void(double fraction)> progress;
  // packing: folder of bunny.off, armadillo.obj, fandisk.obj, knot.ply; pairs, peers: those that
  // are there
  std::string meshes = {};
  // accuracy --all, peers, timing: folder of recorded depth images; replay: the same, or a
  // recording
  std::string data = {};
  static constexpr std::uint64_t kUsualNoise = 1;
  std::uint64_t noise_seed = kUsualNoise;  // accuracy: seed of the noise
  Shadows shadows = Shadows::near;         // accuracy; solid leaves out clouds without camera
  Device device = {};                      // computes the queries, in suites that take one
  int threads = 0;                         // to measure with; 0: what each part usually takes
};

// Returns the names of all suites, "accuracy, extremes, ...", or of those that take a CUDA device.
std::string suite_names(bool on_device = false);
bool is_suite(const std::string& name);
bool needs_device(const std::string& name);

// Runs the suite. Throws Error(invalid_argument) listing the suites if `name` is none, or listing
// those that take an option which this one does not; Error(unavailable) if it takes no device.
Report run_suite(const std::string& name, const SuiteOptions& options);

// Measures errors of volume, force and torque against the truth, for both measures.
Report run_accuracy(const SuiteOptions& options);

// Measures how often the truth lies in the intervals that queries tell; `accuracy` with `all` does
// so, too.
Report run_intervals(const SuiteOptions& options);

// Measures errors of one to four cameras around a scene against the truth, with noise, holes and
// wrong poses, and times their queries.
Report run_cameras(const SuiteOptions& options);

// Checks inputs at the edge of what is possible. Sets `failure` unless each is answered right or
// refused with a message.
Report run_extremes(const SuiteOptions& options);

// Times every stage from the mesh to the wrench, with 1 and 2 threads or with `threads`.
Report run_timing(const SuiteOptions& options);

// Measures time against error over everything that a user can turn, and the choices of --max-error
// and --for-scene. On a device it runs the part that concerns the measure, with one number of
// threads.
Report run_tradeoff(const SuiteOptions& options);

// Measures the coverage of packings, growth, the cost from 10^2 to 10^5 spheres (10^6 with `all`),
// and the time in smooth solids, with one thread or with `threads`.
Report run_packing(const SuiteOptions& options);

// Compares pairs of solids with the truth and times them. Sets `failure` where a volume is wrong by
// more than a millionth of the smaller solid.
Report run_pairs(const SuiteOptions& options);

// Puts voxmap-pointshell, distance grids, OpenVDB, FCL and spheres against spheres beside the
// measure: errors, jitter, memory and time before walls, in clutter, in recorded rooms and between
// solids, with one thread or with `threads`.
Report run_peers(const SuiteOptions& options);

// Runs a haptic loop on a recorded stream: queries in clutter and of warm and cold clouds beside
// hand-written alternatives, coherent poses, preparation of frames, a path through the stream, a
// soak of 10^6 queries. On a device it adds batches in clutter, and leaves out the alternatives
// there, coherent poses and the preparation of frames, which only the CPU does.
Report run_replay(const SuiteOptions& options);

// Times queries on a CUDA device against the number of spheres and along a path. Throws
// Error(unavailable) if there is no device, Error(invalid_argument) for the CPU and for several
// devices.
Report run_scaling(const SuiteOptions& options);

// Returns the numbers of threads that a suite compares: what --threads gives, or else 1 and 2, but
// only 1 beside a device, which computes whatever the host's threads are.
inline std::vector<int> compared_threads(const SuiteOptions& options) {
  if (options.threads > 0) return {options.threads};
  return options.device.is_cuda() ? std::vector{1} : std::vector{1, 2};
}

// Caps the threads of the library while it lives: at what --threads gives, else at `usual`.
class ThreadCap {
 public:
  ThreadCap(const SuiteOptions& options, int usual) : before_(thread_count()) {
    set_thread_count(options.threads > 0 ? options.threads : usual);
  }
  ~ThreadCap() { set_thread_count(before_); }
  ThreadCap(const ThreadCap&) = delete;
  ThreadCap& operator=(const ThreadCap&) = delete;

 private:
  int before_;
};

}  // namespace vpm::bench
