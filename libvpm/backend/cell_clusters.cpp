#include "libvpm/backend/cell_clusters.h"

#include <algorithm>
#include <numeric>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Factor that keeps a cell's ball inside its cluster's in spite of rounding.
constexpr double kRounding = 1 + 1e-12;

constexpr std::size_t kGroupClusters = 8;
constexpr std::uint32_t kGroupChildren = 8;         // most nodes below one of the tree of groups
constexpr double kGroupReach = 2.5 * kPlanarReach;  // in tool radii
// Factor that keeps a group's ball about the cells of its clusters, though not about the clusters'
// own balls, however their projections are rounded.
constexpr double kGroupRounding = 1 + 1e-9;

Box box_of_centers(const ToolModel& tool, const std::vector<std::uint32_t>& cells,
                   std::uint32_t begin, std::uint32_t end) {
  Box box;
  for (std::uint32_t k = begin; k < end; ++k) box.add(tool.spheres[cells[k]].center);
  return box;
}

// Returns the mass of all samples of blocks [begin, end); without any its centroid is `otherwise`.
BlockMass mass_of(const Level& level, std::uint32_t begin, std::uint32_t end, Vec3 otherwise) {
  BlockMass mass;
  Vec3 moment;
  for (std::uint32_t b = begin; b < end; ++b) {
    for (std::uint32_t s = level.blocks[b].begin; s < level.blocks[b].end; ++s) {
      mass.weight += level.samples[s].weight;
      moment += level.samples[s].weight * widen(level.samples[s].center);
    }
  }
  mass.centroid = mass.weight > 0 ? moment / mass.weight : otherwise;
  return mass;
}

// Adds rows [begin, end) as one cluster, or halves them where that is too wide to be planar.
void add_clusters(const ToolModel& tool, const Level& level, std::uint32_t begin, std::uint32_t end,
                  CellClusters& out) {
  const CellCluster cluster = enclosing_cluster(tool, level, out.cells, begin, end);
  if (end - begin == 1 || may_be_planar(cluster.radius, tool.radius)) {
    std::sort(out.cells.begin() + begin, out.cells.begin() + end);
    out.clusters.push_back(cluster);
    return;
  }
  const std::uint32_t middle = halve(tool, out.cells, begin, end);
  add_clusters(tool, level, begin, middle, out);
  add_clusters(tool, level, middle, end, out);
}

// Adds the tree of groups [begin, end), which are side by side.
void add_group_nodes(const ToolModel& tool, const Level& level,
                     const std::vector<std::uint32_t>& cells, std::uint32_t begin,
                     std::uint32_t end, ClusterGroups& out) {
  const std::size_t node = out.tree.size();
  const std::uint32_t count = end - begin;
  if (count == 1) {
    out.tree.push_back({out.groups[begin].ball, static_cast<std::uint32_t>(node + 1), begin});
    return;
  }
  CellCluster ball = enclosing_cluster(tool, level, cells, out.groups[begin].ball.begin,
                                       out.groups[end - 1].ball.end);
  ball.radius *= kGroupRounding;
  out.tree.push_back({ball});
  const std::uint32_t children = std::min(count, kGroupChildren);
  for (std::uint32_t k = 0; k < children; ++k)
    add_group_nodes(tool, level, cells, begin + k * count / children,
                    begin + (k + 1) * count / children, out);
  out.tree[node].next = static_cast<std::uint32_t>(out.tree.size());
}

}  // namespace

NumberedSamples numbered_samples(const Level& level) {
  NumberedSamples numbered{level.samples, {}};
  auto face = level.faces.begin();
  for (const CellBlock& block : level.blocks) {
    if (face == level.faces.end() || face->sample >= block.end) continue;
    std::uint32_t k = face->sample - (face->sample - block.begin) % FaceRow::kLanes;
    for (; k < block.end; ++k) {
      const std::uint32_t lane = (k - block.begin) % FaceRow::kLanes;
      if (lane == 0) numbered.rows.emplace_back();
      CellSample& sample = numbered.samples[k];
      const float r = sample.radius;
      const SampleFace shape = face != level.faces.end() && face->sample == k
                                   ? *face++
                                   : SampleFace{k, {1, 0, 0}, r, r, r, r};
      FaceRow& row = numbered.rows.back();
      row.set(lane, sample, shape);
      if (k + 1 == block.end) row.repeat(lane);
      sample.radius = -1 - static_cast<float>((numbered.rows.size() - 1) * FaceRow::kLanes + lane);
    }
  }
  return numbered;
}

std::vector<BlockMass> block_masses(const Level& level) {
  std::vector<BlockMass> masses;
  for (std::uint32_t b = 0; b < level.blocks.size(); ++b)
    masses.push_back(mass_of(level, b, b + 1, widen(level.blocks[b].center)));
  return masses;
}

CellCluster enclosing_cluster(const ToolModel& tool, const Level& level,
                              const std::vector<std::uint32_t>& cells, std::uint32_t begin,
                              std::uint32_t end) {
  const Box box = box_of_centers(tool, cells, begin, end);
  const Vec3 center = 0.5 * (box.low + box.high);
  double radius = 0;
  for (std::uint32_t k = begin; k < end; ++k) {
    radius = std::max(radius,
                      norm(tool.spheres[cells[k]].center - center) + level.cell_radius[cells[k]]);
  }
  return {begin, end, center - tool.center_of_mass, kRounding * radius};
}

std::uint32_t halve(const ToolModel& tool, std::vector<std::uint32_t>& cells, std::uint32_t begin,
                    std::uint32_t end) {
  const int axis = box_of_centers(tool, cells, begin, end).longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(cells.begin() + begin, cells.begin() + middle, cells.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double x = coordinate(tool.spheres[a].center, axis),
                                  y = coordinate(tool.spheres[b].center, axis);
                     return x != y ? x < y : a < b;
                   });
  return middle;
}

CellClusters cluster_cells(const ToolModel& tool, const Level& level) {
  CellClusters out;
  out.cells.resize(level.sphere_count);
  std::iota(out.cells.begin(), out.cells.end(), 0u);
  for (std::uint32_t i = 0; i < level.sphere_count; ++i)
    out.masses.push_back(mass_of(level, level.block_begin[i], level.block_begin[i + 1],
                                 tool.spheres[i].center - tool.center_of_mass));
  add_clusters(tool, level, 0, level.sphere_count, out);
  return out;
}

// Groups consecutive clusters as long as their ball is within kGroupReach.
ClusterGroups group_clusters(const ToolModel& tool, const Level& level,
                             const CellClusters& clusters) {
  ClusterGroups out;
  const auto count = static_cast<std::uint32_t>(clusters.clusters.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    const CellCluster& cluster = clusters.clusters[k];
    if (!out.groups.empty() && k - out.groups.back().begin < kGroupClusters) {
      CellGroup& last = out.groups.back();
      const CellCluster ball =
          enclosing_cluster(tool, level, clusters.cells, last.ball.begin, cluster.end);
      if (ball.radius <= kGroupReach * tool.radius) {
        last.ball = ball;
        last.end = k + 1;
        continue;
      }
    }
    out.groups.push_back({cluster, k, k + 1});
  }
  for (CellGroup& group : out.groups) group.ball.radius *= kGroupRounding;
  add_group_nodes(tool, level, clusters.cells, 0, static_cast<std::uint32_t>(out.groups.size()),
                  out);
  return out;
}

}  // namespace vpm
