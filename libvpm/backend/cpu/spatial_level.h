// Stores a level as the CPU walks it: neighbours in the tool are neighbours in memory.
#pragma once

#include <span>
#include <vector>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/measure/tool_piece.h"

namespace vpm {

// Describes a node of a tree of clusters; the nodes below it follow it.
struct CellTreeNode {
  CellCluster cluster;     // rows of SpatialLevel
  std::uint32_t next = 0;  // the first node after all nodes below this one
};

// Lists parts of the tool, coordinate by coordinate, as vectors load them: three more numbers may
// be read past the last.
struct FreeParts {
  static constexpr std::size_t kPadding = 3;

  const double *x = nullptr, *y = nullptr, *z = nullptr;  // centroids, about the centre of mass, m
  const ToolSum::Sum* weight = nullptr;                   // in parts of the tool's volume
  std::size_t count = 0;
};

// Holds a level's cells in rows, ordered by place. Immutable.
class SpatialLevel {
 public:
  SpatialLevel(const ToolModel& tool, const Level& level);

  std::uint32_t size() const { return static_cast<std::uint32_t>(cells_.size()); }
  std::uint32_t sphere(std::uint32_t row) const { return spheres_[row]; }
  CellView cell(std::uint32_t row) const {
    const Cell& row_cell = cells_[row];
    return {blocks_.data(), block_masses_.data(), samples_.data(), row_cell.begin,
            row_cell.end,   row_cell.center,      row_cell.radius, SampleFaces{face_rows_.data()}};
  }
  double cell_radius(std::uint32_t row) const { return cells_[row].radius; }
  // Return where a list of pieces (samples and blocks) of each row begins that has room for all of
  // the row, and the length of all these lists.
  std::size_t first_piece(std::uint32_t row) const {
    const Cell& cell = cells_[row];
    return cell.begin + (cell.begin < cell.end ? std::size_t{blocks_[cell.begin].begin} : 0);
  }
  std::size_t most_pieces() const { return samples_.size() + blocks_.size(); }
  const BlockMass& mass(std::uint32_t row) const { return masses_[row]; }
  // Returns the parts that stand for rows [begin, end) where these are taken whole (WholePart):
  // compact cells, and the blocks of others.
  FreeParts parts(std::uint32_t begin, std::uint32_t end) const {
    const std::size_t first = first_part_[begin];
    return {part_x_.data() + first, part_y_.data() + first, part_z_.data() + first,
            part_weights_.data() + first, first_part_[end] - first};
  }
  // Returns the volume of rows [begin, end), in parts of the tool's, with the bits of the sum over
  // parts().
  ToolSum::Sum weight(std::uint32_t begin, std::uint32_t end) const {
    return {weights_[end].value - weights_[begin].value};
  }
  std::span<const std::uint32_t> neighbors(std::uint32_t row) const {
    return {neighbors_.data() + neighbor_begin_[row], neighbors_.data() + neighbor_begin_[row + 1]};
  }
  const std::vector<CellTreeNode>& nodes() const { return nodes_; }
  const std::vector<std::uint32_t>& roots() const { return roots_; }         // top nodes
  std::uint32_t root(std::uint32_t row) const { return root_of_row_[row]; }  // index into roots()
  const CellCluster& cluster(std::uint32_t root) const { return nodes_[roots_[root]].cluster; }
  const std::vector<CellGroup>& groups() const { return grouped_.groups; }
  const std::vector<GroupTreeNode>& group_tree() const { return grouped_.tree; }

 private:
  struct Cell {
    Vec3 center;                       // the sphere's centre, about the tool's centre of mass, m
    double radius = 0;                 // bounding radius of the cell, m
    std::uint32_t begin = 0, end = 0;  // blocks
  };

  void add_nodes(const ToolModel& tool, const Level& level, std::uint32_t begin, std::uint32_t end);
  void add_cell(const ToolModel& tool, const Level& level, std::span<const CellSample> samples,
                std::uint32_t sphere);
  void add_graph(const SphereGraph& graph);
  void add_parts(double tool_radius);
  void add_part(const BlockMass& mass);

  std::vector<std::uint32_t> spheres_;
  std::vector<Cell> cells_;
  std::vector<BlockMass> masses_;
  std::vector<double> part_x_, part_y_, part_z_;
  std::vector<ToolSum::Sum> part_weights_;
  std::vector<std::uint32_t> first_part_;  // of each row, and one past the last
  std::vector<ToolSum::Sum> weights_;      // of the rows before each row, and of all
  std::vector<CellBlock> blocks_;
  std::vector<BlockMass> block_masses_;
  std::vector<CellSample> samples_;  // numbered_samples()
  std::vector<FaceRow> face_rows_;
  std::vector<std::uint32_t> neighbor_begin_, neighbors_;
  std::vector<CellTreeNode> nodes_;
  std::vector<std::uint32_t> roots_, root_of_row_;
  ClusterGroups grouped_;
};

}  // namespace vpm
