// The measure as printed, on a CUDA device, by the algorithm as printed: what the refined measure
// is timed against. Plain C++, so that programs need no CUDA to be compiled against it.
//
// One thread per point of the cloud walks the inner sphere tree and adds to each sphere that it
// meets by atomics; then one thread per boundary sphere floods the graph from there, depth first,
// claiming spheres by atomics: by threads of one kernel, or each by a kernel that the device
// launches (dynamic parallelism), with a thread for each neighbour. Unlike the print it computes in
// double precision and sums in fixed point, as PaperMeasure does, so that both can be compared bit
// by bit.
#pragma once

#include <memory>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/result.h"
#include "libvpm/surface/prepared_cloud.h"

namespace vpm::bench {

enum class Traversals { in_one_kernel, launched };

class PaperBaseline {
 public:
  // Microseconds on the device's clock.
  struct Phases {
    double boundary = 0;  // points and boundary spheres
    double flood = 0;     // and the sums
  };

  virtual ~PaperBaseline() = default;

  // Volume, counts and states have the bits of PaperMeasure. The wrench has not: as printed, a
  // sphere's normal is that of whoever reached it first, which no two runs need agree on.
  virtual Result run(const Pose& pose) = 0;
  virtual Phases run_in_phases(const Pose& pose) = 0;
  // Of the last run.
  virtual std::vector<SphereState> states() const = 0;
};

// On a CUDA device, where the level and the cloud are copied; both must outlive the baseline.
// Throws Error(unavailable) where there is no device, Error(refused) for a tree of more than 64
// levels.
std::unique_ptr<PaperBaseline> make_paper_baseline(const ToolModel& tool, const Level& level,
                                                   const PreparedCloud& cloud,
                                                   Traversals traversals, int device);

}  // namespace vpm::bench
