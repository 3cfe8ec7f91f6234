#include <algorithm>
#include <span>
#include <vector>

#include "libvpm/backend/cuda/device_level.h"

namespace vpm::cuda {
namespace {

template <class SomeTask>
struct GroupedTasks {
  std::vector<SomeTask> units;
  std::vector<TaskGroup> chunks;
};

// Adds block tasks of a cluster in groups of `at_once`.
template <class SomeTask>
void add_chunks(const CellCluster& cluster, std::span<const WarpTask> some, std::size_t at_once,
                GroupedTasks<SomeTask>& out) {
  for (; !some.empty(); some = some.subspan(std::min(at_once, some.size()))) {
    const std::span<const WarpTask> these = some.first(std::min(at_once, some.size()));
    const auto begin = static_cast<std::uint32_t>(out.units.size());
    out.units.insert(out.units.end(), these.begin(), these.end());
    out.chunks.push_back(
        {{cluster.center, cluster.reach}, begin, begin + static_cast<std::uint32_t>(these.size())});
  }
}
// Adds block tasks of a cluster in groups of `at_once`, and fills the last group up with tasks
// without flags, of which nothing counts.
void add_whole_chunks(const CellCluster& cluster, std::span<const WarpTask> some,
                      std::size_t at_once, GroupedTasks<WarpTask>& out) {
  if (some.empty()) return;
  add_chunks(cluster, some, at_once, out);
  WarpTask nothing = some.front();
  nothing.flags = 0;
  out.units.resize(out.chunks.back().begin + at_once, nothing);
}

// Makes the block tasks of a level and their groups.
class LevelTasks {
 public:
  LevelTasks(const ToolModel& tool, const Level& level, const CellClusters& clusters)
      : tool_(tool), level_(level), clusters_(clusters), block_masses_(vpm::block_masses(level)) {}

  const std::vector<BlockMass>& block_masses() const { return block_masses_; }
  // Returns the tasks cluster by cluster.
  GroupedTasks<BlockTask> chunked() const {
    GroupedTasks<BlockTask> all;
    for (const CellCluster& cluster : clusters_.clusters)
      add_chunks(cluster, units_of(cluster), TaskGroup::kTasks, all);
    return all;
  }

  // Returns the tasks for WarpTaskGroups, and in `wide_count` the number of groups of wide tasks.
  GroupedTasks<WarpTask> chunked_for_warps(std::uint32_t& wide_count) const {
    GroupedTasks<WarpTask> all, narrow;
    for (const CellCluster& cluster : clusters_.clusters) {
      std::vector<WarpTask> units = units_of(cluster);
      const auto is_wide = [](const BlockTask& u) {
        return u.end - u.begin > WarpTaskGroups::kNarrow;
      };
      const auto first_narrow = std::stable_partition(units.begin(), units.end(), is_wide);
      add_whole_chunks(cluster, {units.begin(), first_narrow}, WarpTaskGroups::kWideTasks, all);
      add_whole_chunks(cluster, {first_narrow, units.end()}, TaskGroup::kTasks, narrow);
    }
    wide_count = static_cast<std::uint32_t>(all.chunks.size());
    const auto before = static_cast<std::uint32_t>(all.units.size());
    all.units.insert(all.units.end(), narrow.units.begin(), narrow.units.end());
    for (const TaskGroup& chunk : narrow.chunks)
      all.chunks.push_back({chunk.ball, before + chunk.begin, before + chunk.end});
    return all;
  }

 private:
  void add_units(std::uint32_t cell, std::vector<WarpTask>& units) const {
    const Vec3 center = tool_.spheres[cell].center - tool_.center_of_mass;
    const double reach = level_.cell_reach[cell];
    const std::uint32_t begin = level_.block_begin[cell], end = level_.block_begin[cell + 1];
    WarpTask task;
    task.balls[BlockTask::of_cell] = {center, reach};
    task.cell_mass = clusters_.masses[cell];
    task.cell = cell;
    if (is_compact(reach, tool_.reach)) task.flags |= BlockTask::is_compact;
    const std::size_t head = units.size();
    if (begin == end) units.push_back(task);
    for (std::uint32_t b = begin; b < end; ++b) {
      const CellBlock& block = level_.blocks[b];
      units.push_back(task);
      WarpTask& of_block = units.back();
      of_block.balls[BlockTask::of_block] = {widen(block.center), block.radius};
      of_block.block_mass = block_masses_[b];
      of_block.block = b;
      of_block.begin = block.begin;
      of_block.end = block.end;
      of_block.flags |= BlockTask::has_block;
    }
    units[head].flags |= BlockTask::is_head;
  }

  std::vector<WarpTask> units_of(const CellCluster& cluster) const {
    std::vector<WarpTask> units;
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k)
      add_units(clusters_.cells[k], units);
    return units;
  }

  const ToolModel& tool_;
  const Level& level_;
  const CellClusters& clusters_;
  std::vector<BlockMass> block_masses_;
};

std::vector<Vec3> centers_of(const ToolModel& tool, const Level& level) {
  std::vector<Vec3> centers(level.sphere_count);
  for (std::size_t i = 0; i < centers.size(); ++i)
    centers[i] = tool.spheres[i].center - tool.center_of_mass;
  return centers;
}

}  // namespace

// Adds each edge once, and for each sphere where its edges to smaller indices begin.
void DeviceLevel::add_edges(const SphereGraph& graph) {
  std::vector<Edge> edges;
  std::vector<std::uint32_t> begins{0};
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      if (graph.neighbors[k] < i) edges.push_back({i, graph.neighbors[k]});
    begins.push_back(static_cast<std::uint32_t>(edges.size()));
  }
  view_.edges = memory_.copy(edges);
  view_.edge_begin = memory_.copy(begins);
  view_.edge_count = begins.back();
}

// Adds the block tasks in groups, and the masses of blocks and cells.
void DeviceLevel::add_tasks(const ToolModel& tool, const Level& level) {
  const CellClusters clusters = cluster_cells(tool, level);
  const LevelTasks units(tool, level, clusters);
  view_.cell_masses = memory_.copy(clusters.masses);
  view_.block_masses = memory_.copy(units.block_masses());
  const GroupedTasks<BlockTask> chunked = units.chunked();
  view_.units = memory_.copy(chunked.units);
  view_.chunks = memory_.copy(chunked.chunks);
  view_.task_group_count = static_cast<std::uint32_t>(chunked.chunks.size());
  if (level.sphere_count > kSpheresOfWarps) return;
  std::uint32_t wide_count = 0;
  const GroupedTasks<WarpTask> of_warps = units.chunked_for_warps(wide_count);
  view_.of_warps = {memory_.copy(of_warps.units), memory_.copy(of_warps.chunks),
                    static_cast<std::uint32_t>(of_warps.chunks.size()), wide_count};
}

DeviceLevel::DeviceLevel(const ToolModel& tool, const Level& level, OccludedSpace occluded) {
  view_.count = level.sphere_count;
  view_.piece_count =
      static_cast<std::uint32_t>(level.samples.size() + level.blocks.size() + level.sphere_count);
  view_.spheres = memory_.copy(tool.spheres.data(), level.sphere_count);
  view_.centers = memory_.copy(centers_of(tool, level));
  view_.reach = memory_.copy(level.cell_reach);
  view_.block_begin = memory_.copy(level.block_begin);
  view_.blocks = memory_.copy(level.blocks);
  view_.samples = memory_.copy(level.samples);
  view_.tool_reach = {tool.reach, occluded};
  add_edges(level.graph);
  add_tasks(tool, level);
}

}  // namespace vpm::cuda
