#include <algorithm>

#include "libvpm/backend/cpu/measure_refined.h"
#include "libvpm/backend/cuda/device_level.h"
#include "libvpm/backend/cuda/level_tasks.h"

namespace vpm::cuda {
namespace {

std::vector<Edge> edges_of(const SphereGraph& graph) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      if (graph.neighbors[k] < i) edges.push_back({i, graph.neighbors[k]});
  }
  return edges;
}

// Returns for each sphere the begin of its edges to smaller indices; count + 1 entries.
std::vector<std::uint32_t> edge_begins(const SphereGraph& graph) {
  std::vector<std::uint32_t> begins{0};
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    std::uint32_t count = 0;
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      count += graph.neighbors[k] < i ? 1 : 0;
    begins.push_back(begins.back() + count);
  }
  return begins;
}

std::vector<Vec3> centers_of(const ToolModel& tool, const Level& level) {
  std::vector<Vec3> centers(level.sphere_count);
  for (std::size_t i = 0; i < centers.size(); ++i)
    centers[i] = tool.spheres[i].center - tool.center_of_mass;
  return centers;
}

}  // namespace

double reach_of_spheres(const ToolModel& tool, const Level& level) {
  double reach = 0;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    const Sphere& s = tool.spheres[i];
    reach = std::max(reach, norm(s.center - tool.center_of_mass) + s.radius);
  }
  constexpr double kRounding = 1 + 1e-9;
  return kRounding * reach;
}

DeviceLevel::DeviceLevel(const ToolModel& tool, const Level& level, ToolReach reach,
                         const CellClusters& clusters)
    : spheres_(tool.spheres.data(), level.sphere_count),
      centers_(centers_of(tool, level)),
      reach_(level.cell_reach),
      block_begin_(level.block_begin),
      grid_begin_(level.grid.begin),
      grid_spheres_(level.grid.spheres),
      blocks_(level.blocks),
      cell_masses_(clusters.masses),
      samples_(level.samples),
      edges_(edges_of(level.graph)),
      edge_begin_(edge_begins(level.graph)) {
  const LevelTasks units(tool, level, clusters);
  block_masses_ = DeviceArray<BlockMass>(units.block_masses());
  const GroupedTasks<BlockTask> chunked = units.chunked();
  units_ = DeviceArray<BlockTask>(chunked.units);
  chunks_ = DeviceArray<TaskGroup>(chunked.chunks);
  view_.count = level.sphere_count;
  view_.chunks = chunks_.get();
  view_.task_group_count = static_cast<std::uint32_t>(chunked.chunks.size());
  if (level.sphere_count <= kSpheresOfWarps) {
    std::uint32_t wide_count = 0;
    const GroupedTasks<WarpTask> of_warps = units.chunked_for_warps(wide_count);
    units_of_warps_ = DeviceArray<WarpTask>(of_warps.units);
    chunks_of_warps_ = DeviceArray<TaskGroup>(of_warps.chunks);
    view_.of_warps = {units_of_warps_.get(), chunks_of_warps_.get(),
                      static_cast<std::uint32_t>(of_warps.chunks.size()), wide_count};
  }
  view_.spheres = spheres_.get();
  view_.centers = centers_.get();
  view_.reach = reach_.get();
  view_.block_begin = block_begin_.get();
  view_.blocks = blocks_.get();
  view_.block_masses = block_masses_.get();
  view_.samples = samples_.get();
  view_.units = units_.get();
  view_.cell_masses = cell_masses_.get();
  view_.edges = edges_.get();
  view_.edge_begin = edge_begin_.get();
  view_.edge_count = static_cast<std::uint32_t>(edges_.size());
  view_.piece_count =
      static_cast<std::uint32_t>(samples_.size() + blocks_.size() + level.sphere_count);
  view_.grid = view_of(level.grid);
  view_.grid.begin = grid_begin_.get();
  view_.grid.spheres = grid_spheres_.get();
  view_.center_of_mass = tool.center_of_mass;
  view_.tool_reach = reach;
  view_.spheres_reach = reach_of_spheres(tool, level);
}

}  // namespace vpm::cuda
