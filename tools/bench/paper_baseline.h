// The measure as printed, on a CUDA device, by the algorithm as printed. The refined measure is
// timed against it. Plain C++, so that programs compile without CUDA.
//
// One thread per point of the cloud walks the inner sphere tree and adds to each sphere that it
// meets by atomics. Then one thread per boundary sphere floods the graph depth first, claiming
// spheres by atomics: within one kernel, or each in a kernel that the device launches (dynamic
// parallelism) with a thread per neighbour. Unlike the print it computes in double precision and
// sums in fixed point, as PaperMeasure does, so that both can be compared bit by bit.
#pragma once

#include <memory>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/include/vpm/query_types.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm::bench {

enum class Traversals { in_one_kernel, launched };

class PaperBaseline {
 public:
  // Times on the device's clock, microseconds.
  struct Phases {
    double boundary = 0;  // points and boundary spheres
    double flood = 0;     // traversal and sums
  };

  virtual ~PaperBaseline() = default;

  // Runs one query. Volume, counts and states have the bits of PaperMeasure. The wrench does not:
  // as printed, a sphere's normal is that of whichever thread reached it first.
  virtual Result run(const Pose& pose) = 0;
  virtual Phases run_in_phases(const Pose& pose) = 0;
  // Returns the states of the spheres after the last run.
  virtual std::vector<SphereState> states() const = 0;
};

// Copies level and cloud to a CUDA device; both must outlive the baseline. Throws
// Error(unavailable) if there is no device, Error(refused) for a tree of more than 64 levels.
std::unique_ptr<PaperBaseline> make_paper_baseline(const ToolModel& tool, const Level& level,
                                                   const PreparedCloud& cloud,
                                                   Traversals traversals, int device);

}  // namespace vpm::bench
