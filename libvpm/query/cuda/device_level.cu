#include <algorithm>

#include "libvpm/query/cuda/device_level.h"
#include "libvpm/query/measure_refined.h"

namespace vpm::cuda {
namespace {

void add_units(const ToolModel& tool, const Level& level, std::uint32_t i,
               std::vector<Unit>& units) {
  const Vec3 center = tool.spheres[i].center - tool.center_of_mass;
  const std::uint32_t begin = level.block_begin[i], end = level.block_begin[i + 1];
  Unit unit;
  unit.balls[Unit::of_share] = {center, level.share_reach[i]};
  unit.balls[Unit::of_sphere] = {center, tool.spheres[i].radius};
  unit.share = i;
  if (is_compact(level.share_reach[i], tool.reach)) unit.flags |= Unit::is_compact;
  if (begin == end) units.push_back(unit), units.back().flags |= Unit::is_head;
  for (std::uint32_t b = begin; b < end; ++b) {
    const CellBlock& block = level.blocks[b];
    unit.balls[Unit::of_block] = {widen(block.center), block.radius};
    unit.block = b;
    unit.begin = block.begin;
    unit.end = block.end;
    units.push_back(unit);
    units.back().flags |= Unit::has_block | (b == begin ? Unit::is_head : 0U);
  }
}

// Cluster by cluster.
std::vector<Unit> units_of(const ToolModel& tool, const Level& level, const ShareClusters& clusters,
                           std::vector<Chunk>& chunks) {
  std::vector<Unit> units;
  for (const ShareCluster& cluster : clusters.clusters) {
    auto begin = static_cast<std::uint32_t>(units.size());
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k)
      add_units(tool, level, clusters.shares[k], units);
    const auto end = static_cast<std::uint32_t>(units.size());
    for (; begin < end; begin += Chunk::kUnits)
      chunks.push_back(
          {{cluster.center, cluster.reach}, begin, std::min(begin + Chunk::kUnits, end)});
  }
  return units;
}

std::vector<Edge> edges_of(const SphereGraph& graph) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      if (graph.neighbors[k] < i) edges.push_back({i, graph.neighbors[k]});
  }
  return edges;
}

// Of each sphere, where the edges begin of which it has the larger index.
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
                         const ShareClusters& clusters)
    : spheres_(tool.spheres.data(), level.sphere_count),
      centers_(centers_of(tool, level)),
      reach_(level.share_reach),
      block_begin_(level.block_begin),
      grid_begin_(level.grid.begin),
      grid_spheres_(level.grid.spheres),
      blocks_(level.blocks),
      block_masses_(block_masses(level)),
      share_masses_(clusters.masses),
      samples_(level.samples),
      edges_(edges_of(level.graph)),
      edge_begin_(edge_begins(level.graph)) {
  std::vector<Chunk> chunks;
  const std::vector<Unit> units = units_of(tool, level, clusters, chunks);
  units_ = DeviceArray<Unit>(units);
  chunks_ = DeviceArray<Chunk>(chunks);
  view_.count = level.sphere_count;
  view_.chunks = chunks_.get();
  view_.chunk_count = static_cast<std::uint32_t>(chunks.size());
  view_.spheres = spheres_.get();
  view_.centers = centers_.get();
  view_.reach = reach_.get();
  view_.block_begin = block_begin_.get();
  view_.blocks = blocks_.get();
  view_.block_masses = block_masses_.get();
  view_.samples = samples_.get();
  view_.units = units_.get();
  view_.share_masses = share_masses_.get();
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
  LookSizes looks;
  for (const Chunk& chunk : chunks) looks.add(chunk.ball.center, chunk.ball.radius);
  for (const Unit& unit : units) {
    const UnitBall &share = unit.balls[Unit::of_share], &block = unit.balls[Unit::of_block];
    if ((unit.flags & Unit::is_head) != 0) looks.add(share.center, share.radius);
    looks.add(block.center, block.radius);
  }
  looks_ = looks.largest();
}

}  // namespace vpm::cuda
