// Shares of a level in compact groups: what is seen of a group as a whole is decided once.
#pragma once

#include <vector>

#include "libvpm/measure/classify.h"
#include "libvpm/measure/tool_piece.h"

namespace vpm {

struct CellCluster {
  std::uint32_t begin = 0, end = 0;  // rows of CellClusters::shares
  Vec3 center;                       // of a ball that encloses the shares, about the centre of mass
  double reach = 0;                  // radius of that ball
};

// Every share lies in one cluster.
struct CellClusters {
  std::vector<CellCluster> clusters;
  std::vector<std::uint32_t> cells;  // ascending within a cluster
  std::vector<BlockMass> masses;     // of each share
};

std::vector<BlockMass> block_masses(const Level& level);

CellClusters cluster_cells(const ToolModel& tool, const Level& level);

// Of the shares listed in rows [begin, end): the ball that encloses them.
CellCluster enclosing_cluster(const ToolModel& tool, const Level& level,
                              const std::vector<std::uint32_t>& cells, std::uint32_t begin,
                              std::uint32_t end);

// Sorts rows [begin, end) by the longest side of their centres' box, as far as the median needs it,
// and returns the row in the middle.
std::uint32_t halve(const ToolModel& tool, std::vector<std::uint32_t>& cells, std::uint32_t begin,
                    std::uint32_t end);

}  // namespace vpm
