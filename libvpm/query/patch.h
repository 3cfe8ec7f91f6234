// Patches: clusters of shares that meet the surface as a whole. Where it passes through one as a
// plane, or it lies wholly behind it, one look at the surface serves all its shares. One definition
// for host and device.
#pragma once

#include "libvpm/query/share_clusters.h"

namespace vpm {

// Wider clusters, of one large share, are looked at by their blocks.
VPM_HD constexpr bool is_patch(double cluster_reach, double tool_reach) {
  return cluster_reach <= kPatchReach * tool_reach;
}

// Whether the surface passes through a patch as one plane: not further away than kSheetReach of
// its reaches.
// `read_all`: ReadInTurn, or what gives the same readings sooner.
template <class Surface, class ReadAll>
VPM_HD bool sees_patch(const Surface& surface, const typename Surface::Look& look, Vec3 center,
                       double reach, const ReadAll& read_all, TangentPlane& plane) {
  if (!surface.mean_plane(look, center, reach, reach, read_all, plane)) return false;
  const double near = kSheetReach * reach;
  return squared_norm(plane.foot - center) <= near * near;
}

}  // namespace vpm
