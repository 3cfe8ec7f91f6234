// The first step of the refined measure: how the surface meets each share. Groups of clusters are
// looked at before clusters, clusters before shares: what holds for a ball holds for the balls in
// it.
#pragma once

#include <algorithm>
#include <atomic>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/backend/cpu/points_inside.h"
#include "libvpm/backend/cpu/share_states.h"
#include "libvpm/core/parallel_region.h"

namespace vpm {

template <class Surface>
class ShareClassifier {
 public:
  // `points`: those of the cloud, to be counted in the spheres that the surface may pass; null
  // where nobody asks for their number.
  ShareClassifier(const ToolModel& tool, ToolReach reach, const SpatialLevel& level,
                  const Surface& surface, const Pose& to_surface, const PointsOfSphere* points,
                  ShareStates& states)
      : tool_(tool),
        reach_(reach),
        level_(level),
        surface_(surface),
        to_surface_(to_surface),
        points_(points),
        states_(states) {}

  // Returns the number of points in spheres.
  std::uint32_t run(ParallelRegion& region) {
    std::atomic<std::uint32_t> found{0};
    region.loop(level_.groups().size(), 1, [&](std::size_t begin, std::size_t end) {
      std::uint32_t found_here = 0;
      for (std::size_t g = begin; g < end; ++g)
        found_here += classify_group(static_cast<std::uint32_t>(g));
      if (found_here > 0) found.fetch_add(found_here, std::memory_order_relaxed);
    });
    return found;
  }

 private:
  using Look = typename Surface::Look;

  std::uint32_t classify_group(std::uint32_t index) {
    const ShareGroup& group = level_.groups()[index];
    const Vec3 center = to_surface_ * group.ball.center;
    const bool tells =
        group.end - group.begin > 1 && tells_of_parts(surface_, center, group.ball.reach);
    Look look;
    if (tells) look = surface_.look_at_ball(center, group.ball.reach);
    if (tells && look.side == Side::free) {
      states_.set(group.ball, Cell::free, Passage::closed);
      return 0;
    }
    std::uint32_t found = 0;
    for (std::uint32_t root = group.begin; root < group.end; ++root) {
      const ShareCluster& part = level_.cluster(root);
      if (tells && is_free_part(surface_, look, to_surface_ * part.center, part.reach))
        states_.set(part, Cell::free, Passage::closed);
      else
        found += classify(root);
    }
    return found;
  }

  std::uint32_t classify(std::uint32_t root) {
    const ShareCluster& whole = level_.cluster(root);
    const Vec3 center = to_surface_ * whole.center;
    const Look look = surface_.look_at_ball(center, whole.reach);
    const ClusterClass found = class_of_cluster(surface_, look, center, whole.reach, reach_.length);
    if (found == ClusterClass::ambiguous) {
      TangentPlane plane;
      if (!finds_cluster_plane(surface_, look, center, whole.reach, reach_.length, ReadTogether{},
                               plane))
        return classify_nodes(root);
      states_.planes[root] = {plane, to_surface_};
      return classify_crossed(root, look);
    }
    if (found == ClusterClass::no_surface && may_be_planar(whole.reach, reach_.length))
      states_.set(whole, Cell::open, Passage::middle);  // decided if the flood comes
    else if (found == ClusterClass::uniform)
      push_cluster(surface_, to_surface_, whole, root, surface_.read(center), states_);
    else
      states_.set(whole, found);
    return 0;
  }

  // Classifies the shares of a cluster that the surface crosses otherwise than as one plane.
  std::uint32_t classify_nodes(std::uint32_t root) {
    SamplesOnHost<Surface> samples;
    const std::vector<ShareTreeNode>& nodes = level_.nodes();
    const std::uint32_t first = level_.roots()[root], last = nodes[first].next;
    std::uint32_t found = 0, node = first;
    while (node < last) {
      const auto& [part, next] = nodes[node];
      const Vec3 center = to_surface_ * part.center;
      const Look look = surface_.look_at_ball(center, part.reach);
      if (const ClusterClass side =
              class_of_ball(surface_, look, center, part.reach, reach_.length);
          side != ClusterClass::ambiguous) {
        states_.set(part, side);
        node = next;
        continue;
      }
      if (next == node + 1) {
        for (std::uint32_t i = part.begin; i < part.end; ++i) found += classify_share(i, samples);
      }
      ++node;
    }
    return found;
  }

  std::uint32_t classify_share(std::uint32_t i, SamplesOnHost<Surface>& samples) {
    const CellView view = level_.cell(i);
    const Vec3 center = to_surface_ * view.center;
    const Look look = surface_.look_at_ball(center, view.reach);
    const Side side = side_of(surface_, look, center, view.reach);
    if (side == Side::free) {
      states_.set(i, Cell::free, Passage::closed);
    } else if (side == Side::behind) {
      states_.set(i, Cell::whole, Passage::unknown);
    } else if (side == Side::uncut) {
      states_.set(i, Cell::open, Passage::unknown);
    } else {
      states_.results[i] = measure(view).run(samples, look.point);
      take_result(i, Passage::unknown);
      return points_ != nullptr ? count_points(i, center) : 0;
    }
    return 0;
  }

  // Of a patch through which the surface passes as one plane. Where that is further from a node
  // than it reaches, it is so from each share in it.
  std::uint32_t classify_crossed(std::uint32_t root, const Look& look) {
    constexpr double kRounding = 1e-9;  // of the tool's reach: far above that of a distance
    const CrossingPlane& plane = states_.planes[root];
    const std::vector<ShareTreeNode>& nodes = level_.nodes();
    const std::uint32_t first = level_.roots()[root], last = nodes[first].next;
    std::uint32_t node = first;
    while (node < last) {
      const auto& [part, next] = nodes[node];
      const PlaneSide side =
          side_of_plane(plane.distance(part.center), part.reach + kRounding * reach_.length);
      if (side == PlaneSide::before) {
        states_.set(part, Cell::free, Passage::closed);
        node = next;
      } else if (side == PlaneSide::behind &&
                 !may_hold_free(surface_, look, to_surface_ * part.center, part.reach)) {
        states_.set(part, Cell::pushed, Passage::patch);
        node = next;
      } else {
        if (next == node + 1) {
          for (std::uint32_t i = part.begin; i < part.end; ++i) classify_crossed(i, plane, look);
        }
        ++node;
      }
    }
    return count_points(level_.cluster(root), look);
  }

  // What a share's own pixels show to be free is free, whatever the mean of all says.
  void classify_crossed(std::uint32_t i, const CrossingPlane& plane, const Look& look) {
    const CellView view = level_.cell(i);
    const Vec3 center = to_surface_ * view.center;
    const PlaneSide side = side_in_cut_cluster(plane.distance(view.center), view.reach, [&] {
      return may_be_free(surface_, least_inverse_depth<Surface>(look), center, view.reach) &&
             side_of(surface_, surface_.look_at_ball(center, view.reach), center, view.reach) ==
                 Side::free;
    });
    if (side == PlaneSide::before) {
      states_.set(i, Cell::free, Passage::closed);
    } else if (side == PlaneSide::behind) {
      states_.set(i, Cell::pushed, Passage::patch);
    } else {
      CellResult& result = states_.results[i];
      result = {};
      const CellMeasure measure = this->measure(view);
      for (std::uint32_t b = view.begin; b < view.end; ++b)
        measure.add_block(b, plane, SamplesOnHost<Surface>::crossed, result);
      take_result(i, Passage::patch);
    }
  }

  // `passage`: where the share is not cut.
  void take_result(std::uint32_t i, Passage passage) {
    const CellResult& result = states_.results[i];
    if (result.plane.count > 0)
      states_.set(i, Cell::cut, Passage::closed);
    else if (result.sum.volume.value > 0 || result.is_far)
      states_.set(i, Cell::partial, passage);
    else
      states_.set(i, Cell::free, Passage::closed);
  }

  // Points in the spheres of a patch that was looked at.
  std::uint32_t count_points(const ShareCluster& patch, const Look& look) const {
    if (points_ == nullptr) return 0;
    std::uint32_t found = 0;
    for (std::uint32_t i = patch.begin; i < patch.end; ++i) {
      const Vec3 center = to_surface_ * level_.cell(i).center;
      if (may_touch(surface_, look, center, level_.radius(i))) found += count_points(i, center);
    }
    return found;
  }
  std::uint32_t count_points(std::uint32_t i, Vec3 center) const {
    const Look look = surface_.look_at_ball(center, level_.radius(i));
    return look.side == Side::mixed ? points_->count(tool_.spheres[level_.sphere(i)], look) : 0;
  }

  CellMeasure<Surface> measure(const CellView& view) const {
    return {surface_, to_surface_, reach_, view};
  }

  const ToolModel& tool_;
  ToolReach reach_;
  const SpatialLevel& level_;
  const Surface& surface_;
  const Pose& to_surface_;
  const PointsOfSphere* points_;
  ShareStates& states_;
};

}  // namespace vpm
