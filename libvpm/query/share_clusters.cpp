#include "libvpm/query/share_clusters.h"

#include <algorithm>
#include <numeric>

namespace vpm {
namespace {

// Balls of more than a few shares, and few of them: most are decided at once, and those that the
// surface may pass hold few shares.
constexpr double kClusterReach = 0.1;  // of the tool's reach

double coordinate(Vec3 v, int axis) {
  return axis == 0 ? v.x : (axis == 1 ? v.y : v.z);
}

class Clustering {
 public:
  Clustering(const ToolModel& tool, const Level& level) : tool_(tool), level_(level) {
    out_.shares.resize(level.sphere_count);
    std::iota(out_.shares.begin(), out_.shares.end(), 0u);
    for (std::uint32_t i = 0; i < level.sphere_count; ++i) out_.masses.push_back(mass_of(i));
    split(0, level.sphere_count);
  }
  ShareClusters take() { return std::move(out_); }

 private:
  Vec3 center(std::uint32_t share) const {
    return tool_.spheres[share].center - tool_.center_of_mass;
  }

  BlockMass mass_of(std::uint32_t share) const {
    BlockMass mass;
    Vec3 moment;
    for (std::uint32_t b = level_.block_begin[share]; b < level_.block_begin[share + 1]; ++b) {
      for (std::uint32_t s = level_.blocks[b].begin; s < level_.blocks[b].end; ++s) {
        mass.weight += level_.samples[s].weight;
        moment += level_.samples[s].weight * widen(level_.samples[s].center);
      }
    }
    mass.centroid = mass.weight > 0 ? moment / mass.weight : center(share);
    return mass;
  }

  // Halves the longest side of the centres' box until what is left is small.
  void split(std::uint32_t begin, std::uint32_t end) {
    Vec3 low = center(out_.shares[begin]), high = low;
    for (std::uint32_t k = begin; k < end; ++k) {
      const Vec3 c = center(out_.shares[k]);
      low = {std::min(low.x, c.x), std::min(low.y, c.y), std::min(low.z, c.z)};
      high = {std::max(high.x, c.x), std::max(high.y, c.y), std::max(high.z, c.z)};
    }
    ShareCluster cluster{begin, end, 0.5 * (low + high), 0};
    for (std::uint32_t k = begin; k < end; ++k) {
      cluster.reach = std::max(cluster.reach, norm(center(out_.shares[k]) - cluster.center) +
                                                  level_.share_reach[out_.shares[k]]);
    }
    if (end - begin == 1 || cluster.reach <= kClusterReach * tool_.reach) {
      keep(cluster);
      return;
    }
    const Vec3 side = high - low;
    const int axis = side.x >= side.y ? (side.x >= side.z ? 0 : 2) : (side.y >= side.z ? 1 : 2);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(out_.shares.begin() + begin, out_.shares.begin() + middle,
                     out_.shares.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
                       const double x = coordinate(center(a), axis),
                                    y = coordinate(center(b), axis);
                       return x != y ? x < y : a < b;
                     });
    split(begin, middle);
    split(middle, end);
  }

  void keep(ShareCluster cluster) {
    std::sort(out_.shares.begin() + cluster.begin, out_.shares.begin() + cluster.end);
    // Rounding must not let a share's ball leave its cluster's.
    constexpr double kRounding = 1 + 1e-12;
    cluster.reach *= kRounding;
    out_.clusters.push_back(cluster);
  }

  const ToolModel& tool_;
  const Level& level_;
  ShareClusters out_;
};

}  // namespace

ShareClusters cluster_shares(const ToolModel& tool, const Level& level) {
  return Clustering(tool, level).take();
}

}  // namespace vpm
