// Classifies every cell by how the surface meets it: groups of clusters first, then clusters, then
// cells, since the class of a ball holds for all balls in it.
#pragma once

#include <algorithm>
#include <atomic>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/backend/cpu/points_inside.h"
#include "libvpm/core/parallel.h"

namespace vpm {

template <class Surface>
class CellClassifier {
 public:
  // Counts the cloud's points in ambiguous spheres with `points`; null where nobody asks for them.
  CellClassifier(const ToolModel& tool, ToolReach reach, const SpatialLevel& level,
                 const Surface& surface, const Pose& to_surface, const PointsOfSphere* points,
                 CellStates& states)
      : tool_(tool),
        reach_(reach),
        level_(level),
        surface_(surface),
        to_surface_(to_surface),
        points_(points),
        states_(states) {}

  // Classifies all cells and returns the number of points in spheres.
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
  using BallClass = typename Surface::BallClass;

  std::uint32_t classify_group(std::uint32_t index) {
    const CellGroup& group = level_.groups()[index];
    const Vec3 center = to_surface_ * group.ball.center;
    const bool tells =
        group.end - group.begin > 1 && tells_of_parts(surface_, center, group.ball.reach);
    BallClass in_ball;
    if (tells) in_ball = surface_.classify_ball(center, group.ball.reach);
    if (tells && in_ball.side == Side::free) {
      states_.set(group.ball, CellClass::free, FloodState::closed);
      return 0;
    }
    std::uint32_t found = 0;
    for (std::uint32_t root = group.begin; root < group.end; ++root) {
      const CellCluster& part = level_.cluster(root);
      if (tells && is_free_part(surface_, in_ball, to_surface_ * part.center, part.reach))
        states_.set(part, CellClass::free, FloodState::closed);
      else
        found += classify(root);
    }
    return found;
  }

  std::uint32_t classify(std::uint32_t root) {
    const CellCluster& whole = level_.cluster(root);
    const Vec3 center = to_surface_ * whole.center;
    const BallClass in_ball = surface_.classify_ball(center, whole.reach);
    const ClusterClass found =
        class_of_cluster(surface_, in_ball, center, whole.reach, reach_.length);
    if (found == ClusterClass::ambiguous) {
      TangentPlane plane;
      if (!finds_cluster_plane(surface_, in_ball, center, whole.reach, reach_.length,
                               SampleTogether{}, plane))
        return classify_nodes(root);
      states_.planes[root] = {plane, to_surface_};
      return classify_clipped(root, in_ball);
    }
    if (found == ClusterClass::uniform)
      push_cluster(surface_, to_surface_, whole, root, surface_.sample(center), states_);
    else
      states_.set(whole, found);
    return 0;
  }

  // Classifies the cells of a cluster that the surface cuts otherwise than as one plane.
  std::uint32_t classify_nodes(std::uint32_t root) {
    SamplesOnHost<Surface> samples;
    const std::vector<CellTreeNode>& nodes = level_.nodes();
    const std::uint32_t first = level_.roots()[root], last = nodes[first].next;
    std::uint32_t found = 0, node = first;
    while (node < last) {
      const auto& [part, next] = nodes[node];
      const Vec3 center = to_surface_ * part.center;
      const BallClass in_ball = surface_.classify_ball(center, part.reach);
      if (const ClusterClass side =
              class_of_ball(surface_, in_ball, center, part.reach, reach_.length);
          side != ClusterClass::ambiguous) {
        states_.set(part, side);
        node = next;
        continue;
      }
      if (next == node + 1) {
        for (std::uint32_t i = part.begin; i < part.end; ++i) found += classify_cell(i, samples);
      }
      ++node;
    }
    return found;
  }

  std::uint32_t classify_cell(std::uint32_t i, SamplesOnHost<Surface>& samples) {
    const CellView view = level_.cell(i);
    const Vec3 center = to_surface_ * view.center;
    const BallClass in_ball = surface_.classify_ball(center, view.reach);
    const Side side = side_of(surface_, in_ball, center, view.reach);
    if (side == Side::free) {
      states_.set(i, CellClass::free, FloodState::closed);
    } else if (side == Side::behind) {
      states_.set(i, CellClass::whole, FloodState::unknown);
    } else if (side == Side::no_surface) {
      states_.set(i, CellClass::no_surface, FloodState::unknown);
    } else {
      states_.results[i] = measure(view).run(samples, in_ball.point);
      take_result(i, FloodState::unknown);
      return points_ != nullptr ? count_points(i, center) : 0;
    }
    return 0;
  }

  // Classifies the cells of a cluster that is cut by one plane. A node wholly on one side of the
  // plane decides for all its cells.
  std::uint32_t classify_clipped(std::uint32_t root, const BallClass& in_ball) {
    constexpr double kRounding = 1e-9;  // in tool radii: far above rounding
    const ClipPlane& plane = states_.planes[root];
    const std::vector<CellTreeNode>& nodes = level_.nodes();
    const std::uint32_t first = level_.roots()[root], last = nodes[first].next;
    std::uint32_t node = first;
    while (node < last) {
      const auto& [part, next] = nodes[node];
      const PlaneSide side =
          side_of_plane(plane.distance(part.center), part.reach + kRounding * reach_.length);
      if (side == PlaneSide::before) {
        states_.set(part, CellClass::free, FloodState::closed);
        node = next;
      } else if (side == PlaneSide::behind &&
                 !may_hold_free(surface_, in_ball, to_surface_ * part.center, part.reach)) {
        states_.set(part, CellClass::uniform, FloodState::planar);
        node = next;
      } else {
        if (next == node + 1) {
          for (std::uint32_t i = part.begin; i < part.end; ++i) classify_clipped(i, plane, in_ball);
        }
        ++node;
      }
    }
    return count_points(level_.cluster(root), in_ball);
  }

  void classify_clipped(std::uint32_t i, const ClipPlane& plane, const BallClass& in_ball) {
    const CellView view = level_.cell(i);
    const Vec3 center = to_surface_ * view.center;
    const PlaneSide side = side_in_cut_cluster(plane.distance(view.center), view.reach, [&] {
      return may_be_free(surface_, least_inverse_depth<Surface>(in_ball), center, view.reach) &&
             side_of(surface_, surface_.classify_ball(center, view.reach), center, view.reach) ==
                 Side::free;
    });
    if (side == PlaneSide::before) {
      states_.set(i, CellClass::free, FloodState::closed);
    } else if (side == PlaneSide::behind) {
      states_.set(i, CellClass::uniform, FloodState::planar);
    } else {
      CellResult& result = states_.results[i];
      result = {};
      const CellMeasure measure = this->measure(view);
      for (std::uint32_t b = view.begin; b < view.end; ++b)
        measure.add_block(b, plane, SamplesOnHost<Surface>::clipped, result);
      take_result(i, FloodState::planar);
    }
  }

  // Sets the class of a measured cell; an uncut one that is partly inside gets `flood_state`.
  void take_result(std::uint32_t i, FloodState flood_state) {
    const CellResult& result = states_.results[i];
    if (result.plane.count > 0)
      states_.set(i, CellClass::cut, FloodState::closed);
    else if (result.sum.volume.value > 0 || result.is_far)
      states_.set(i, CellClass::partial, flood_state);
    else
      states_.set(i, CellClass::free, FloodState::closed);
  }

  // Counts points in the spheres of a cluster that was classified.
  std::uint32_t count_points(const CellCluster& cluster, const BallClass& in_ball) const {
    if (points_ == nullptr) return 0;
    std::uint32_t found = 0;
    for (std::uint32_t i = cluster.begin; i < cluster.end; ++i) {
      const Vec3 center = to_surface_ * level_.cell(i).center;
      if (may_touch(surface_, in_ball, center, level_.radius(i))) found += count_points(i, center);
    }
    return found;
  }
  std::uint32_t count_points(std::uint32_t i, Vec3 center) const {
    const BallClass in_ball = surface_.classify_ball(center, level_.radius(i));
    return in_ball.side == Side::ambiguous
               ? points_->count(tool_.spheres[level_.sphere(i)], in_ball)
               : 0;
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
  CellStates& states_;
};

}  // namespace vpm
