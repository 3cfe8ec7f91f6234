// Finds the part of a tool of which nobody knows whether it is inside of what points show.
#pragma once

#include "libvpm/backend/cpu/cell_states.h"

namespace vpm {

// Sums up cells of which nothing counts, once it is decided which do. A ball without surface is
// decided as one; where the surface reaches the ball of a cluster, that is decided by itself if
// none of its cells counts. What else does not count lies beside the surface, before it.
template <TellsUnknown Surface>
class UnknownCells {
 public:
  static_assert(!SeesFreeSpace<Surface>, "each cluster is classified by itself");

  explicit UnknownCells(const PoseWork<Surface>& work) : work_(work) {}

  // Returns their volume, in parts of the tool's.
  ToolSum::Sum sum() const {
    ToolSum::Sum sum;
    const std::vector<GroupTreeNode>& tree = work_.level.group_tree();
    for (std::uint32_t node = 0; node < tree.size();) {
      const auto& [ball, next, group] = tree[node];
      ++node;
      if (first_rest(ball) == ball.end) {
        node = next;
        continue;
      }
      const BallClass in_ball = classify(ball);
      if (in_ball.side == Side::no_surface) {
        if (work_.surface.is_unknown(in_ball)) add_rest(ball, sum);
        node = next;
      } else if (group != GroupTreeNode::kNone) {
        add_clusters(work_.level.groups()[group], in_ball.point, sum);
      }
    }
    return sum;
  }

 private:
  using BallClass = typename Surface::BallClass;

  BallClass classify(const CellCluster& ball) const {
    return work_.surface.classify_ball(work_.to_surface * ball.center, ball.radius);
  }
  // Adds clusters of a group, whose ball this point touches.
  void add_clusters(const CellGroup& group, std::uint32_t near, ToolSum::Sum& sum) const {
    for (std::uint32_t root = group.begin; root < group.end; ++root) {
      const CellCluster& cluster = work_.level.cluster(root);
      if (any_counts(cluster)) continue;
      BallClass in_ball = Surface::class_by_point(
          work_.states.cluster_points[root], work_.to_surface * cluster.center, cluster.radius);
      if (in_ball.point == kNoPoint) in_ball.point = near;
      if (work_.surface.is_unknown(in_ball)) add_rest(cluster, sum);
    }
  }
  bool any_counts(const CellCluster& cells) const {
    std::uint32_t row = cells.begin;
    while (row < cells.end && !work_.states.counts(row)) ++row;
    return row < cells.end;
  }
  // Returns the first row that does not count, or the end.
  std::uint32_t first_rest(const CellCluster& cells) const {
    std::uint32_t row = cells.begin;
    while (row < cells.end && work_.states.counts(row)) ++row;
    return row;
  }
  void add_rest(const CellCluster& cells, ToolSum::Sum& sum) const {
    for (std::uint32_t row = first_rest(cells); row < cells.end; ++row)
      if (!work_.states.counts(row)) sum.add(work_.level.mass(row).weight);
  }

  const PoseWork<Surface>& work_;
};

}  // namespace vpm
