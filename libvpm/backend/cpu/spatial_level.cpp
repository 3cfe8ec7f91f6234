#include "libvpm/backend/cpu/spatial_level.h"

#include <algorithm>

namespace vpm {
namespace {

constexpr std::uint32_t kFewCells = 8;  // a node of no more has no children
constexpr std::size_t kGroupClusters = 8;
constexpr std::uint32_t kGroupChildren = 8;         // most nodes below one of the tree of groups
constexpr double kGroupReach = 2.5 * kPlanarReach;  // in tool radii
// Factor that keeps a group's ball about the cells of its clusters, though not about the clusters'
// own balls, however their projections are rounded.
constexpr double kGroupRounding = 1 + 1e-9;

}  // namespace

SpatialLevel::SpatialLevel(const ToolModel& tool, const Level& level) {
  CellClusters clusters = cluster_cells(tool, level);
  spheres_ = std::move(clusters.cells);
  for (const CellCluster& c : clusters.clusters) {
    root_of_row_.resize(c.end, static_cast<std::uint32_t>(roots_.size()));
    roots_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    add_nodes(tool, level, c.begin, c.end);
  }
  add_groups(tool, level);
  add_group_nodes(tool, level, 0, static_cast<std::uint32_t>(groups_.size()));
  const std::vector<BlockMass> block_masses = vpm::block_masses(level);
  NumberedSamples numbered = numbered_samples(level);
  face_rows_ = std::move(numbered.rows);
  for (const std::uint32_t sphere : spheres_) {
    masses_.push_back(clusters.masses[sphere]);
    block_masses_.insert(block_masses_.end(), block_masses.begin() + level.block_begin[sphere],
                         block_masses.begin() + level.block_begin[sphere + 1]);
    add_cell(tool, level, numbered.samples, sphere);
  }
  add_parts(tool.radius);
  add_graph(level.graph);
}

void SpatialLevel::add_nodes(const ToolModel& tool, const Level& level, std::uint32_t begin,
                             std::uint32_t end) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({enclosing_cluster(tool, level, spheres_, begin, end), 0});
  if (end - begin > kFewCells) {
    const std::uint32_t middle = halve(tool, spheres_, begin, end);
    add_nodes(tool, level, begin, middle);
    add_nodes(tool, level, middle, end);
  }
  nodes_[node].next = static_cast<std::uint32_t>(nodes_.size());
}

// Groups consecutive clusters as long as their ball is within kGroupReach.
void SpatialLevel::add_groups(const ToolModel& tool, const Level& level) {
  const auto first_row = [&](std::uint32_t root) { return nodes_[roots_[root]].cluster.begin; };
  const auto end_row = [&](std::uint32_t root) { return nodes_[roots_[root]].cluster.end; };
  const auto count = static_cast<std::uint32_t>(roots_.size());
  for (std::uint32_t root = 0; root < count; ++root) {
    if (!groups_.empty() && root - groups_.back().begin < kGroupClusters) {
      CellGroup& last = groups_.back();
      const CellCluster ball =
          enclosing_cluster(tool, level, spheres_, first_row(last.begin), end_row(root));
      if (ball.radius <= kGroupReach * tool.radius) {
        last.ball = ball;
        last.end = root + 1;
        continue;
      }
    }
    groups_.push_back({nodes_[roots_[root]].cluster, root, root + 1});
  }
  for (CellGroup& group : groups_) group.ball.radius *= kGroupRounding;
}

// Adds the tree of groups [begin, end), which are side by side.
void SpatialLevel::add_group_nodes(const ToolModel& tool, const Level& level, std::uint32_t begin,
                                   std::uint32_t end) {
  const std::size_t node = group_tree_.size();
  const std::uint32_t count = end - begin;
  if (count == 1) {
    group_tree_.push_back({groups_[begin].ball, static_cast<std::uint32_t>(node + 1), begin});
    return;
  }
  CellCluster ball = enclosing_cluster(tool, level, spheres_, groups_[begin].ball.begin,
                                       groups_[end - 1].ball.end);
  ball.radius *= kGroupRounding;
  group_tree_.push_back({ball});
  const std::uint32_t children = std::min(count, kGroupChildren);
  for (std::uint32_t k = 0; k < children; ++k)
    add_group_nodes(tool, level, begin + k * count / children, begin + (k + 1) * count / children);
  group_tree_[node].next = static_cast<std::uint32_t>(group_tree_.size());
}

void SpatialLevel::add_cell(const ToolModel& tool, const Level& level,
                            std::span<const CellSample> samples, std::uint32_t sphere) {
  Cell cell{tool.spheres[sphere].center - tool.center_of_mass, level.cell_radius[sphere],
            static_cast<std::uint32_t>(blocks_.size()), 0};
  for (std::uint32_t b = level.block_begin[sphere]; b < level.block_begin[sphere + 1]; ++b) {
    CellBlock block = level.blocks[b];
    const auto begin = static_cast<std::uint32_t>(samples_.size());
    samples_.insert(samples_.end(), samples.begin() + block.begin, samples.begin() + block.end);
    block.begin = begin;
    block.end = static_cast<std::uint32_t>(samples_.size());
    blocks_.push_back(block);
  }
  cell.end = static_cast<std::uint32_t>(blocks_.size());
  cells_.push_back(cell);
}

void SpatialLevel::add_parts(double tool_radius) {
  ToolSum::Sum all;
  for (std::uint32_t row = 0; row < size(); ++row) {
    const Cell& cell = cells_[row];
    const std::size_t first = part_weights_.size();
    first_part_.push_back(static_cast<std::uint32_t>(first));
    weights_.push_back(all);
    if (is_compact(cell.radius, tool_radius)) {
      add_part(masses_[row]);
    } else {
      for (std::uint32_t b = cell.begin; b < cell.end; ++b) add_part(block_masses_[b]);
    }
    for (std::size_t k = first; k < part_weights_.size(); ++k) all.add(part_weights_[k]);
  }
  first_part_.push_back(static_cast<std::uint32_t>(part_weights_.size()));
  weights_.push_back(all);
  for (std::vector<double>* const row : {&part_x_, &part_y_, &part_z_})
    row->insert(row->end(), FreeParts::kPadding, 0);
}

void SpatialLevel::add_part(const BlockMass& mass) {
  part_x_.push_back(mass.centroid.x);
  part_y_.push_back(mass.centroid.y);
  part_z_.push_back(mass.centroid.z);
  part_weights_.push_back(UnseenSum::rounded(mass.weight));
}

void SpatialLevel::add_graph(const SphereGraph& graph) {
  std::vector<std::uint32_t> row_of(size());
  for (std::uint32_t row = 0; row < size(); ++row) row_of[spheres_[row]] = row;
  neighbor_begin_.push_back(0);
  for (const std::uint32_t sphere : spheres_) {
    for (std::uint32_t k = graph.begin[sphere]; k < graph.begin[sphere + 1]; ++k)
      neighbors_.push_back(row_of[graph.neighbors[k]]);
    neighbor_begin_.push_back(static_cast<std::uint32_t>(neighbors_.size()));
  }
}

}  // namespace vpm
