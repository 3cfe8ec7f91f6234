// The refined measure: shares instead of spheres, the surface instead of points. README.md derives
// it.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/backend/cpu/points_inside.h"
#include "libvpm/backend/cpu/spatial_level.h"
#include "libvpm/core/parallel_region.h"
#include "libvpm/include/vpm/query_types.h"
#include "libvpm/scene/prepared_cloud.h"
#include "libvpm/temporal/pose_memory.h"

namespace vpm {

class RefinedMeasure {
 public:
  // Of the options, those that speak of coherent poses, of points and of shadows.
  RefinedMeasure(const ToolModel& tool, const Level& level, const QueryOptions& options);

  // With one thread, allocates nothing after the first call.
  Result run(const PreparedCloud& cloud, const Pose& pose);

  // Returns the answer for one body of the scene. `to_world` maps its frame to the world's;
  // `points` counts the points in spheres, null where nobody asks. Defined in
  // measure_refined_run.h.
  template <MeasuredBody Surface>
  Result run_on(const Surface& surface, const Pose& to_world, const Pose& pose,
                const PointsOfSphere* points);

  // Of the last run, one per sphere.
  void read_states(std::vector<SphereState>& states) const;

  // Of a coherent sequence: the next pose is seen alone.
  void forget() {
    if (memory_) memory_->forget();
  }

 private:
  // Cut shares, and those that `inside` has taken; returns how many of these count. Those that do
  // not become free: they were hidden, not inside.
  template <class Surface, class Inside>
  std::uint32_t add_up(const Surface& surface, const Pose& to_surface, const Inside& inside,
                       ParallelRegion& region, ToolSum& sum);
  // Adds those of rows [begin, end).
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
