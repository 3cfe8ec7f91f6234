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

// Returns the ball that encloses the cells in rows [begin, end).
CellCluster enclosing_cluster(const ToolModel& tool, const Level& level,
                              const std::vector<std::uint32_t>& cells, std::uint32_t begin,
                              std::uint32_t end);

// Partitions rows [begin, end) at the median of their centres along the longest side of the
// centres' box. Returns the middle row.
std::uint32_t halve(const ToolModel& tool, std::vector<std::uint32_t>& cells, std::uint32_t begin,
                    std::uint32_t end);

}  // namespace vpm
