#include "libvpm/backend/cpu/spatial_level.h"

#include <algorithm>

namespace vpm {
namespace {

constexpr std::uint32_t kFewCells = 8;  // a node of no more has no children

}  // namespace

SpatialLevel::SpatialLevel(const ToolModel& tool, const Level& level) {
  CellClusters clusters = cluster_cells(tool, level);
  grouped_ = group_clusters(tool, level, clusters);
  spheres_ = std::move(clusters.cells);
  for (const CellCluster& c : clusters.clusters) {
    root_of_row_.resize(c.end, static_cast<std::uint32_t>(roots_.size()));
    roots_.push_back(static_cast<std::uint32_t>(nodes_.size()));
    add_nodes(tool, level, c.begin, c.end);
  }
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
