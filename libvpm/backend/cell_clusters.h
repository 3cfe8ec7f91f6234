// Groups the cells of a level into compact clusters, which are classified as a whole.
#pragma once

#include <vector>

#include "libvpm/measure/classify.h"
#include "libvpm/measure/tool_piece.h"

namespace vpm {

struct CellCluster {
  std::uint32_t begin = 0, end = 0;  // rows of CellClusters::cells
  Vec3 center;        // centre of a ball about all cells, about the centre of mass, m
  double radius = 0;  // radius of that ball, m
};

// Lists the clusters of a level; every cell lies in one.
struct CellClusters {
  std::vector<CellCluster> clusters;
  std::vector<std::uint32_t> cells;  // ascending within a cluster
  std::vector<BlockMass> masses;     // for each cell
};

// Groups clusters side by side: [begin, end), and the ball of their cells.
struct CellGroup {
  CellCluster ball;
  std::uint32_t begin = 0, end = 0;
};

// Describes a node of the tree whose leaves are the groups; the nodes below it follow it.
struct GroupTreeNode {
  static constexpr std::uint32_t kNone = UINT32_MAX;

  CellCluster ball;             // of the cells of its groups
  std::uint32_t next = 0;       // the first node after all nodes below this one
  std::uint32_t group = kNone;  // index of a leaf's group
};

// Holds the groups of a level's clusters, and their tree.
struct ClusterGroups {
  std::vector<CellGroup> groups;
  std::vector<GroupTreeNode> tree;
};

std::vector<BlockMass> block_masses(const Level& level);

// Holds the samples of a level as queries ask them, and rows with the shapes of those beside faces
// (SampleFaces). Each run of four samples of a block, counted from its first, has a row if one of
// them is beside a face; then all four are in it, also balls.
struct NumberedSamples {
  std::vector<CellSample> samples;
  std::vector<FaceRow> rows;

  SampleFaces faces() const { return {rows.data()}; }
};
NumberedSamples numbered_samples(const Level& level);

CellClusters cluster_cells(const ToolModel& tool, const Level& level);
ClusterGroups group_clusters(const ToolModel& tool, const Level& level,
                             const CellClusters& clusters);

// Returns the ball that encloses the cells in rows [begin, end).
CellCluster enclosing_cluster(const ToolModel& tool, const Level& level,
                              const std::vector<std::uint32_t>& cells, std::uint32_t begin,
                              std::uint32_t end);

// Partitions rows [begin, end) at the median of their centres along the longest side of the
// centres' box. Returns the middle row.
std::uint32_t halve(const ToolModel& tool, std::vector<std::uint32_t>& cells, std::uint32_t begin,
                    std::uint32_t end);

}  // namespace vpm
