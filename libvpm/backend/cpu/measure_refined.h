// Computes the refined measure: cells instead of spheres, the surface instead of points
// (measure/README.md).
#pragma once

#include <optional>
#include <vector>

#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/backend/cpu/points_inside.h"
#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/core/parallel.h"
#include "libvpm/include/vpm/query_types.h"
#include "libvpm/scene/prepared_cloud.h"
#include "libvpm/temporal/pose_memory.h"

namespace vpm {

class RefinedMeasure {
 public:
  // Uses the options about coherent poses, points and occluded space.
  RefinedMeasure(const ToolModel& tool, const Level& level, const QueryOptions& options);

  // With one thread, allocates nothing after the first call.
  Result run(const PreparedCloud& cloud, const Pose& pose);

  // Returns the answer for one body. `to_world` maps its frame to the world's; `points` counts the
  // points in spheres, or is null. Defined in measure_refined_run.h.
  template <MeasuredBody Surface>
  Result run_on(const Surface& surface, const Pose& to_world, const Pose& pose,
                const PointsOfSphere* points);

  // Reads the states of the spheres at the last run, one per sphere.
  void read_states(std::vector<SphereState>& states) const;

  // Measures the next pose of a coherent sequence alone.
  void forget() {
    if (memory_) memory_->forget();
  }

 private:
  // Adds cut cells and those that `inside` has taken; returns how many of the latter count. The
  // others become free: they were hidden, not inside.
  template <class Surface, class Inside>
  std::uint32_t add_up(const Surface& surface, const Pose& to_surface, const Inside& inside,
                       ParallelRegion& region, ToolSum& sum);
  // Adds those in rows [begin, end).
  template <class Surface, class Inside>
  std::uint32_t add_up(const Surface& surface, const Pose& to_surface, const Inside& inside,
                       std::uint32_t begin, std::uint32_t end, ToolSum& sum);
  template <class Surface, class Inside>
  ToolSum sum_of(const Surface& surface, const Pose& to_surface, const Inside& inside,
                 std::uint32_t row, std::uint32_t& last_cut) const;
  template <class Surface, class Inside>
  void remember(const Surface& surface, const Pose& to_surface, const Pose& to_world,
                Inside& inside);

  const ToolModel& tool_;
  ToolReach reach_;
  bool counts_points_;
  SpatialLevel level_;
  CellStates cells_;
  std::optional<PoseMemory> memory_;
};

}  // namespace vpm
