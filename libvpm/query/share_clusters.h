// Shares of a level in compact groups: what is seen of a group as a whole is decided once.
#pragma once

#include <vector>

#include "libvpm/query/share_piece.h"

namespace vpm {

struct ShareCluster {
  std::uint32_t begin = 0, end = 0;  // rows of ShareClusters::shares
  Vec3 center;                       // of a ball that encloses the shares, about the centre of mass
  double reach = 0;                  // radius of that ball
};

// Every share lies in one cluster.
struct ShareClusters {
  std::vector<ShareCluster> clusters;
  std::vector<std::uint32_t> shares;  // ascending within a cluster
  std::vector<BlockMass> masses;      // of each share
};

std::vector<BlockMass> block_masses(const Level& level);

// A share up to this part of the tool's reach that lies wholly behind the surface is counted by its
// centroid. README.md has what that costs.
inline constexpr double kCompactReach = 0.125;

VPM_HD constexpr bool is_compact(double reach, double tool_reach) {
  return reach <= kCompactReach * tool_reach;
}

// Clusters of several shares are no larger than this part of the tool's reach.
inline constexpr double kPatchReach = 0.1;

ShareClusters cluster_shares(const ToolModel& tool, const Level& level);

// Of the shares listed in rows [begin, end): the ball that encloses them.
ShareCluster enclosing_cluster(const ToolModel& tool, const Level& level,
                               const std::vector<std::uint32_t>& shares, std::uint32_t begin,
                               std::uint32_t end);

// Sorts rows [begin, end) by the longest side of their centres' box, as far as the median needs it,
// and returns the row in the middle.
std::uint32_t halve(const ToolModel& tool, std::vector<std::uint32_t>& shares, std::uint32_t begin,
                    std::uint32_t end);

}  // namespace vpm
