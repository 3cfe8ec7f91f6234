// The refined measure: shares instead of spheres, the surface instead of points. README.md derives
// it.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/query/cell.h"
#include "libvpm/query/flood_memory.h"
#include "libvpm/query/points_inside.h"
#include "libvpm/query/prepared_cloud.h"
#include "libvpm/query/result.h"
#include "libvpm/query/spatial_level.h"

namespace vpm {

class RefinedMeasure {
 public:
  // `coherent`: the poses are those of a motion, see flood_memory.h.
  RefinedMeasure(const ToolModel& tool, const Level& level, bool coherent);

  // `states` receives one entry per sphere. Allocates nothing after the first call.
  Result run(const PreparedCloud& cloud, const Pose& pose, std::vector<SphereState>& states);

  // Of a coherent sequence: the next pose is seen alone.
  void forget() {
    if (memory_) memory_->forget();
  }

 private:
  // How the surface meets a sphere's share.
  enum class Cell : std::uint8_t {
    free,     // counts for nothing
    cut,      // the surface passes through it: its result counts
    partial,  // behind the surface as far as its result says, if the flood comes
    whole,    // behind the surface, if the flood comes
    open,     // no surface near; its centre decides when the flood comes
  };

  // Whether the flood may pass a share that is not cut.
  enum class Passage : std::uint8_t {
    unknown,
    closed,
    open,
    near,  // open: no place of its cluster is further behind the surface than the tool's reach
    taken,
  };

  // Leaves what is cut and inside with its results. Returns the number of points in spheres.
  template <class Surface>
  std::uint32_t find_inside(const Surface& surface, const Pose& to_surface, const Pose& to_world,
                            const PointsOfSphere& points);
  // Returns the number of shares that are inside.
  std::uint32_t add_up(std::vector<SphereState>& states, ToolSum& sum) const;
  // Returns the number of points in spheres.
  template <class Surface>
  std::uint32_t classify(const Surface& surface, const Pose& to_surface,
                         const PointsOfSphere& points);
  template <class Surface>
  std::uint32_t classify_share(const Surface& surface, const Pose& to_surface,
                               const PointsOfSphere& points, std::uint32_t row);
  template <class Surface>
  std::uint32_t classify_cluster(const Surface& surface, const Pose& to_surface,
                                 const PointsOfSphere& points, std::uint32_t root);
  template <class Surface>
  std::uint32_t classify_nodes(const Surface& surface, const Pose& to_surface,
                               const PointsOfSphere& points, std::uint32_t root);
  template <class Surface>
  void decide(const Surface& surface, const typename Surface::Look& look,
              const ShareCluster& cluster, Vec3 center);
  template <class Surface>
  void count_behind(const Surface& surface, const Pose& to_surface, const ShareCluster& cluster,
                    Vec3 normal);
  template <class Surface>
  std::uint32_t classify_crossed(const Surface& surface, const Pose& to_surface,
                                 const PointsOfSphere& points, const ShareCluster& cluster,
                                 const typename Surface::Look& look, const CrossingPlane& plane);
  template <class Surface>
  std::uint32_t count_points(const Surface& surface, const PointsOfSphere& points,
                             std::uint32_t row, Vec3 center) const;
  template <class Surface>
  void flood(const Surface& surface, const Pose& to_surface);
  template <class Surface>
  void flood_from_memory(const Surface& surface, const Pose& to_surface, const Pose& to_world);
  template <class Surface>
  void remember(const Surface& surface, const Pose& to_surface, const Pose& to_world);
  template <class Surface>
  void count_inside(const Surface& surface, const Pose& to_surface);
  template <class Surface>
  bool is_passable(const Surface& surface, const Pose& to_surface, std::uint32_t row);
  template <class Surface>
  Passage find_passage(const Surface& surface, const Pose& to_surface, std::uint32_t row);
  template <class Surface>
  bool enters(const Surface& surface, const Pose& to_surface, std::uint32_t cut, std::uint32_t row);
  static Cell cell_of(const CellResult& result) {
    if (result.plane.count > 0) return Cell::cut;
    return result.sum.volume.value > 0 ? Cell::partial : Cell::free;
  }
  std::uint32_t nearest_cut(std::uint32_t row) const;
  CutShare cut_share(const Pose& to_surface, std::uint32_t cut) const;

  const ToolModel& tool_;
  ToolReach reach_;
  SpatialLevel level_;  // all that follows is in its rows
  std::optional<FloodMemory> memory_;
  std::vector<Cell> cells_;
  std::vector<CellResult> results_;
  std::vector<Passage> passages_;
  std::vector<double> squared_gaps_;   // to the foot of the centre's reading, where asked; m^2
  std::vector<std::uint32_t> cut_;     // shares that the surface cuts, ascending
  std::vector<std::uint32_t> inside_;  // shares that the flood took, in the order of the flood
};

}  // namespace vpm
