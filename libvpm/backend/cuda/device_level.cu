#include <algorithm>
#include <span>
#include <vector>

#include "libvpm/backend/cuda/device_level.h"

namespace vpm::cuda {
namespace {

// Block tasks, and the groups that refer to ranges of them.
template <class SomeTask>
struct GroupedTasks {
  std::vector<SomeTask> tasks;
  std::vector<TaskGroup> groups;
};

// Returns the volume that tasks stand for, with the bits of the sum over them.
ToolSum::Sum weight_of(std::span<const WarpTask> tasks) {
  ToolSum::Sum all;
  for (const WarpTask& task : tasks) {
    const WholePart whole = whole_part_of(task.flags);
    if (whole == WholePart::cell) all.add(task.cell_mass.weight);
    if (whole == WholePart::block) all.add(task.block_mass.weight);
  }
  return all;
}

// Adds block tasks of a cluster in groups of `at_once`.
template <class SomeTask>
void add_groups(const CellCluster& cluster, std::span<const WarpTask> some, std::size_t at_once,
                GroupedTasks<SomeTask>& out) {
  for (; !some.empty(); some = some.subspan(std::min(at_once, some.size()))) {
    const std::span<const WarpTask> these = some.first(std::min(at_once, some.size()));
    const auto begin = static_cast<std::uint32_t>(out.tasks.size());
    out.tasks.insert(out.tasks.end(), these.begin(), these.end());
    out.groups.push_back({{cluster.center, cluster.radius},
                          begin,
                          begin + static_cast<std::uint32_t>(these.size()),
                          weight_of(these)});
  }
}
// Adds block tasks of a cluster in groups of `at_once`, and fills the last group up with tasks
// without flags, of which nothing counts.
void add_whole_groups(const CellCluster& cluster, std::span<const WarpTask> some,
                      std::size_t at_once, GroupedTasks<WarpTask>& out) {
  if (some.empty()) return;
  add_groups(cluster, some, at_once, out);
  WarpTask nothing = some.front();
  nothing.flags = 0;
  out.tasks.resize(out.groups.back().begin + at_once, nothing);
}

// Makes the block tasks of a level and their groups.
class LevelTasks {
 public:
  LevelTasks(const ToolModel& tool, const Level& level, const CellClusters& clusters)
      : tool_(tool), level_(level), clusters_(clusters), block_masses_(vpm::block_masses(level)) {}

  const std::vector<BlockMass>& block_masses() const { return block_masses_; }
  // Returns the tasks cluster by cluster.
  GroupedTasks<BlockTask> grouped() const {
    GroupedTasks<BlockTask> all;
    for (const CellCluster& cluster : clusters_.clusters)
      add_groups(cluster, tasks_of(cluster), TaskGroup::kTasks, all);
    return all;
  }

  // Returns the tasks for WarpTaskGroups, and in `wide_count` the number of groups of wide tasks.
  GroupedTasks<WarpTask> grouped_for_warps(std::uint32_t& wide_count) const {
    GroupedTasks<WarpTask> all, narrow;
    for (const CellCluster& cluster : clusters_.clusters) {
      std::vector<WarpTask> tasks = tasks_of(cluster);
      const auto is_wide = [](const BlockTask& u) {
        return u.end - u.begin > WarpTaskGroups::kNarrow;
      };
      const auto first_narrow = std::stable_partition(tasks.begin(), tasks.end(), is_wide);
      add_whole_groups(cluster, {tasks.begin(), first_narrow}, WarpTaskGroups::kWideTasks, all);
      add_whole_groups(cluster, {first_narrow, tasks.end()}, TaskGroup::kTasks, narrow);
    }
    wide_count = static_cast<std::uint32_t>(all.groups.size());
    const auto before = static_cast<std::uint32_t>(all.tasks.size());
    all.tasks.insert(all.tasks.end(), narrow.tasks.begin(), narrow.tasks.end());
    for (const TaskGroup& group : narrow.groups)
      all.groups.push_back({group.ball, before + group.begin, before + group.end, group.weight});
    return all;
  }

 private:
  void add_tasks(std::uint32_t cell, std::vector<WarpTask>& tasks) const {
    const Vec3 center = tool_.spheres[cell].center - tool_.center_of_mass;
    const double radius = level_.cell_radius[cell];
    const std::uint32_t begin = level_.block_begin[cell], end = level_.block_begin[cell + 1];
    WarpTask task;
    task.balls[BlockTask::of_cell] = {center, radius};
    task.cell_mass = clusters_.masses[cell];
    task.cell = cell;
    if (is_compact(radius, tool_.radius)) task.flags |= BlockTask::is_compact;
    const std::size_t head = tasks.size();
    if (begin == end) tasks.push_back(task);
    for (std::uint32_t b = begin; b < end; ++b) {
      const CellBlock& block = level_.blocks[b];
      tasks.push_back(task);
      WarpTask& of_block = tasks.back();
      of_block.balls[BlockTask::of_block] = {widen(block.center), block.radius};
      of_block.block_mass = block_masses_[b];
      of_block.block = b;
      of_block.begin = block.begin;
      of_block.end = block.end;
      of_block.flags |= BlockTask::has_block;
    }
    tasks[head].flags |= BlockTask::is_head;
  }

  std::vector<WarpTask> tasks_of(const CellCluster& cluster) const {
    std::vector<WarpTask> tasks;
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k)
      add_tasks(clusters_.cells[k], tasks);
    return tasks;
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

// Adds the block tasks in groups, the masses of blocks and cells, and the balls of clusters.
void DeviceLevel::add_tasks(const ToolModel& tool, const Level& level) {
  const CellClusters clusters = cluster_cells(tool, level);
  const LevelTasks level_tasks(tool, level, clusters);
  view_.cell_masses = memory_.copy(clusters.masses);
  std::vector<TaskBall> balls(level.sphere_count);
  for (const CellCluster& cluster : clusters.clusters)
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k)
      balls[clusters.cells[k]] = {cluster.center, cluster.radius};
  view_.cluster_balls = memory_.copy(balls);
  view_.clusters = {
      memory_.copy(clusters.clusters), static_cast<std::uint32_t>(clusters.clusters.size()),
      memory_.copy(clusters.cells), memory_.copy(group_clusters(tool, level, clusters).tree)};
  view_.block_masses = memory_.copy(level_tasks.block_masses());
  const GroupedTasks<BlockTask> grouped = level_tasks.grouped();
  view_.block_tasks = memory_.copy(grouped.tasks);
  view_.task_groups = memory_.copy(grouped.groups);
  view_.task_group_count = static_cast<std::uint32_t>(grouped.groups.size());
  if (level.sphere_count > kSpheresOfWarps) return;
  std::uint32_t wide_count = 0;
  const GroupedTasks<WarpTask> of_warps = level_tasks.grouped_for_warps(wide_count);
  view_.of_warps = {memory_.copy(of_warps.tasks), memory_.copy(of_warps.groups),
                    static_cast<std::uint32_t>(of_warps.groups.size()), wide_count};
}

DeviceLevel::DeviceLevel(const ToolModel& tool, const Level& level, Shadows shadows) {
  view_.count = level.sphere_count;
  view_.piece_count =
      static_cast<std::uint32_t>(level.samples.size() + level.blocks.size() + level.sphere_count);
  view_.spheres = memory_.copy(tool.spheres.data(), level.sphere_count);
  view_.centers = memory_.copy(centers_of(tool, level));
  view_.cell_radius = memory_.copy(level.cell_radius);
  view_.block_begin = memory_.copy(level.block_begin);
  view_.blocks = memory_.copy(level.blocks);
  const NumberedSamples numbered = numbered_samples(level);
  view_.samples = memory_.copy(numbered.samples);
  view_.faces = {memory_.copy(numbered.rows)};
  view_.tool_radius = {tool.radius, shadows};
  add_edges(level.graph);
  add_tasks(tool, level);
}

}  // namespace vpm::cuda
