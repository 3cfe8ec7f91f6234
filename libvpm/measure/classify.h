// Classifies parts of the tool by how the surface meets them: clusters of cells, cells, blocks of
// samples. Every decision of the refined measure about a ball or a plane stands here once; backends
// choose only which thread asks, and in which order.
#pragma once

#include <vpm/query_types.h>

#include "libvpm/measure/flood_rules.h"
#include "libvpm/scene/body.h"

namespace vpm {

// Holds the lengths of the tool that the rules compare with, m.
struct ToolRadius {
  double length = 0;            // radius about the centre of mass that encloses the tool
  double inverse = 0;           // 1 / length, 1/m: scales arms
  double supported_beyond = 0;  // places further behind a seen surface need the support of a plane

  ToolRadius() = default;
  ToolRadius(double radius, Shadows shadows)
      : length(radius),
        inverse(1 / radius),
        supported_beyond(shadows == Shadows::solid ? HUGE_VAL : radius) {}
};

// Largest radius, in tool radii, of a cell that counts by its centroid where it is wholly behind
// the surface.
inline constexpr double kCompactReach = 0.125;
// Largest radius, in tool radii, of a cluster that may be planar; in wider ones the blocks decide.
inline constexpr double kPlanarReach = 0.1;
// Largest distance, in tool radii, by which a block's surface may lie off one plane, besides the
// block's own radius: it is for blocks of few large cells, which are wider than the error that they
// may make.
inline constexpr double kFlatness = 0.1;

// True if a cell of this bounding radius may be counted by its centroid, where nothing cuts it.
VPM_HD constexpr bool is_compact(double cell_radius, double tool_radius) {
  return cell_radius <= kCompactReach * tool_radius;
}
// True if a cluster of this bounding radius is small enough to be decided as a whole.
VPM_HD constexpr bool may_be_planar(double cluster_radius, double tool_radius) {
  return cluster_radius <= kPlanarReach * tool_radius;
}

// Tells how the surface meets a cluster of cells, or a part of one.
enum class ClusterClass : std::uint8_t {
  free,         // outside of the solid: counts for nothing
  ambiguous,    // the surface may pass through it: its parts decide
  no_surface,   // the surface does not pass; a surface sample tells whether it is behind one
  by_middle,    // planar without a surface: the sample at its middle decides (class_by_middle)
  behind,       // behind the surface, maybe further than the tool radius
  behind_near,  // behind it, no place further than the tool radius
  cut,          // planar: the surface passes through it as one plane
  uniform,      // planar and behind_near: all of it is pushed along one normal
};

// Returns the side on which the cells of a cluster of this class lie. Of a planar one that is cut
// or uniform, the plane or the direction tells more.
VPM_HD constexpr Side side_of_cells(ClusterClass found) {
  switch (found) {
    case ClusterClass::free:
      return Side::free;
    case ClusterClass::no_surface:
    case ClusterClass::by_middle:
      return Side::no_surface;
    case ClusterClass::behind:
    case ClusterClass::behind_near:
    case ClusterClass::uniform:
      return Side::behind;
    case ClusterClass::ambiguous:
    case ClusterClass::cut:
      break;
  }
  return Side::ambiguous;
}

// Returns what the flood knows of the cells of a cluster of this class, other than an ambiguous
// one.
VPM_HD constexpr FloodState flood_state_of(ClusterClass found) {
  switch (found) {
    case ClusterClass::by_middle:
      return FloodState::middle;
    case ClusterClass::behind_near:
    case ClusterClass::uniform:
      return FloodState::near;
    case ClusterClass::cut:
      return FloodState::planar;
    case ClusterClass::no_surface:
    case ClusterClass::behind:
      return FloodState::unknown;
    case ClusterClass::free:
    case ClusterClass::ambiguous:
      break;
  }
  return FloodState::closed;
}

// Returns the class of a ball as far as classify_ball() tells. An ambiguous one may still be cut by
// one plane (finds_cluster_plane), a small one without a surface be uniform (class_by_middle).
template <MeasuredBody Surface>
VPM_HD ClusterClass class_of_ball(const Surface& surface,
                                  const typename Surface::BallClass& in_ball, Vec3 center,
                                  double radius, double tool_radius) {
  switch (in_ball.side) {
    case Side::free:
      return ClusterClass::free;
    case Side::ambiguous:
      return ClusterClass::ambiguous;
    case Side::no_surface:
      return ClusterClass::no_surface;
    case Side::behind:
      break;
  }
  return gap_bound(surface, in_ball, center, radius) < tool_radius ? ClusterClass::behind_near
                                                                   : ClusterClass::behind;
}

// Returns the class of a whole cluster: class_of_ball(), but uniform, or decided by its middle,
// where it is small enough.
template <MeasuredBody Surface>
VPM_HD ClusterClass class_of_cluster(const Surface& surface,
                                     const typename Surface::BallClass& in_ball, Vec3 center,
                                     double radius, double tool_radius) {
  const ClusterClass found = class_of_ball(surface, in_ball, center, radius, tool_radius);
  if (!may_be_planar(radius, tool_radius)) return found;
  return found == ClusterClass::behind_near  ? ClusterClass::uniform
         : found == ClusterClass::no_surface ? ClusterClass::by_middle
                                             : found;
}

// Returns the class of a small cluster without a surface, by the surface sample at its middle.
template <MeasuredBody Surface>
VPM_HD ClusterClass class_by_middle(const Surface& surface, const SurfaceSample& middle,
                                    Vec3 center, double radius, double tool_radius) {
  if (!is_behind_surface(middle)) return ClusterClass::free;
  if (!(norm(middle.foot - center) + radius < tool_radius)) return ClusterClass::behind;
  const TangentPlane wall{surface.closest_normal(center, middle), middle.foot};
  OtherWall other;
  return finds_other_wall(surface, center, wall, middle.point, radius, kOneDirection, other)
             ? ClusterClass::behind_near
             : ClusterClass::uniform;
}

// Returns the place for which it is asked whether the body encloses a cell that is behind the
// surface and that no flood reaches: the middle of its cluster, for all cells at once, if no
// surface passes through the cluster's ball, otherwise the cell's own centre.
template <MeasuredBody Surface>
VPM_HD bool is_enclosed_as_one(const Surface& surface, Vec3 cluster_center, double cluster_radius) {
  return surface.classify_ball(cluster_center, cluster_radius).side == Side::no_surface;
}

// True if the surface may pass through an ambiguous cluster as one plane, so that the sample at its
// middle is needed.
template <MeasuredBody Surface>
VPM_HD bool may_have_plane(const Surface& surface, const typename Surface::BallClass& in_ball,
                           double radius, double tool_radius) {
  return may_be_planar(radius, tool_radius) && surface.may_be_flat(in_ball);
}

// True if the surface passes through an ambiguous cluster as one plane, which is returned in
// `plane`: it passes within kSheetReach of the cluster's radii, and no second surface is near.
// `sample_all` is SampleInTurn, or samples the same places side by side.
template <MeasuredBody Surface, class SampleAll>
VPM_HD bool finds_cluster_plane(const Surface& surface, const typename Surface::BallClass& in_ball,
                                Vec3 center, double radius, double tool_radius,
                                const SampleAll& sample_all, TangentPlane& plane) {
  const double near = kSheetReach * radius;
  OtherWall other;
  return may_have_plane(surface, in_ball, radius, tool_radius) &&
         surface.mean_plane(in_ball, center, radius, radius, sample_all, plane) &&
         squared_norm(plane.foot - center) <= near * near &&
         !finds_other_wall(surface, center, plane, in_ball.point, radius, kOneDirection, other);
}

// Returns the side of a cell in a cluster that is cut by a plane. What the cell's own pixels show
// to be free is free, whatever the mean of all pixels says; `is_seen_free` is asked only of cells
// that the plane does not already free.
template <class IsSeenFree>
VPM_HD PlaneSide side_in_cut_cluster(double distance, double cell_radius,
                                     const IsSeenFree& is_seen_free) {
  const PlaneSide side = side_of_plane(distance, cell_radius);
  return side != PlaneSide::before && is_seen_free() ? PlaneSide::before : side;
}

// True if a place x at this signed distance, m, is inside only if a plane supports it.
template <class Surface>
VPM_HD bool is_far_behind(const Surface& surface, Vec3 x, double signed_distance,
                          const ToolRadius& tool) {
  return signed_distance < -(Surface::kTellsInside ? tool.supported_beyond : tool.length) &&
         !is_seen_behind_from_sides(surface, x);
}
// True if a body of this radius, m, is divided between two walls; smaller ones are pushed to one.
VPM_HD inline bool is_divisible(double radius, const ToolRadius& tool) {
  return radius >= kLeastDivided * tool.length;
}

// Tells which part of a cell wholly behind the surface one of its blocks stands for. A compact cell
// counts by its centroid, once; others by the centroids of their blocks.
enum class WholePart : std::uint8_t { nothing, cell, block };
// `is_first` is true of a cell's first block, or for a cell without blocks.
VPM_HD constexpr WholePart whole_part(bool cell_is_compact, bool is_first, bool has_block) {
  if (cell_is_compact) return is_first ? WholePart::cell : WholePart::nothing;
  return has_block ? WholePart::block : WholePart::nothing;
}

// Tells how the surface meets a block of samples of an ambiguous cell.
enum class BlockClass : std::uint8_t {
  free,       // counts for nothing
  uncut,      // is measured as one piece
  cut,        // the surface passes through it as one plane
  ambiguous,  // is measured sample by sample
};

// Returns the class of a block about `center` on this side of the surface.
VPM_HD constexpr BlockClass class_on_block_side(Side side) {
  return side == Side::free        ? BlockClass::free
         : side == Side::ambiguous ? BlockClass::ambiguous
                                   : BlockClass::uncut;
}
// True if the surface passes through an ambiguous block about `center` as one plane. `read()`
// returns the surface sample at the centre; it is called only where a plane may be.
template <MeasuredBody Surface, class Read>
VPM_HD bool finds_block_plane(const Surface& surface, const typename Surface::BallClass& in_ball,
                              Vec3 center, double radius, const ToolRadius& tool, const Read& read,
                              TangentPlane& plane) {
  if (!surface.may_be_flat(in_ball)) return false;
  const double most = kFlatness * tool.length, tolerance = radius < most ? radius : most;
  if (!surface.is_flat(in_ball, read, tolerance, plane) ||
      is_far_behind(surface, center, plane.distance(center), tool))
    return false;
  OtherWall other;
  return !is_divisible(radius, tool) ||
         !finds_other_wall(surface, center, plane, in_ball.point, radius, kOneDirection, other);
}
// Returns the class of a block about `center` whose ball was classified, and the plane of one that
// is cut. Looks closer before the samples of a block are read one by one.
template <MeasuredBody Surface, class Read>
VPM_HD BlockClass class_of_block(const Surface& surface, const typename Surface::BallClass& in_ball,
                                 Vec3 center, double radius, const ToolRadius& tool,
                                 const Read& read, TangentPlane& plane) {
  if (in_ball.side != Side::ambiguous) return class_on_block_side(in_ball.side);
  if (finds_block_plane(surface, in_ball, center, radius, tool, read, plane))
    return BlockClass::cut;
  if constexpr (LooksCloser<Surface>)
    return class_on_block_side(surface.side_by_small_tiles(in_ball, center, radius));
  return BlockClass::ambiguous;
}

}  // namespace vpm
