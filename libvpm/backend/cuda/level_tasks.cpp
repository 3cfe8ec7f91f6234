#include "libvpm/backend/cuda/level_tasks.h"

#include <algorithm>

namespace vpm::cuda {
namespace {

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
// Adds groups filled up with tasks without flags.
void add_whole_chunks(const CellCluster& cluster, std::span<const WarpTask> some,
                      std::size_t at_once, GroupedTasks<WarpTask>& out) {
  if (some.empty()) return;
  add_chunks(cluster, some, at_once, out);
  WarpTask nothing = some.front();
  nothing.flags = 0;
  out.units.resize(out.chunks.back().begin + at_once, nothing);
}

}  // namespace

LevelTasks::LevelTasks(const ToolModel& tool, const Level& level, const CellClusters& clusters)
    : tool_(tool), level_(level), clusters_(clusters), block_masses_(vpm::block_masses(level)) {}

void LevelTasks::add_units(std::uint32_t cell, std::vector<WarpTask>& units) const {
  const Sphere& sphere = tool_.spheres[cell];
  const Vec3 center = sphere.center - tool_.center_of_mass;
  const double reach = level_.cell_reach[cell];
  const std::uint32_t begin = level_.block_begin[cell], end = level_.block_begin[cell + 1];
  WarpTask task;
  task.balls[BlockTask::of_cell] = {center, reach};
  task.balls[BlockTask::of_sphere] = {center, sphere.radius};
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

std::vector<WarpTask> LevelTasks::units_of(const CellCluster& cluster) const {
  std::vector<WarpTask> units;
  for (std::uint32_t k = cluster.begin; k < cluster.end; ++k) add_units(clusters_.cells[k], units);
  return units;
}

GroupedTasks<BlockTask> LevelTasks::chunked() const {
  GroupedTasks<BlockTask> all;
  for (const CellCluster& cluster : clusters_.clusters)
    add_chunks(cluster, units_of(cluster), TaskGroup::kTasks, all);
  return all;
}

GroupedTasks<WarpTask> LevelTasks::chunked_for_warps(std::uint32_t& wide_count) const {
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

}  // namespace vpm::cuda
