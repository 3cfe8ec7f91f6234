// Patches: clusters of shares that meet the surface as a whole. Where it passes through one as a
// plane, or it lies wholly behind it, one look at the surface serves all its shares. One definition
// for host and device.
#pragma once

#include "libvpm/query/contact_plane.h"
#include "libvpm/query/share_clusters.h"
#include "libvpm/surface/surface.h"

namespace vpm {

// Wider clusters, of one large share, are looked at by their blocks.
VPM_HD constexpr bool is_patch(double cluster_reach, double tool_reach) {
  return cluster_reach <= kPatchReach * tool_reach;
}

// Whether a plane as which the surface passes through a patch is that of the patch: it passes not
// further away than kSheetReach of its reaches, and no other wall is near.
template <class Surface>
VPM_HD bool is_plane_of_patch(const Surface& surface, const typename Surface::Look& look,
                              Vec3 center, double reach, const TangentPlane& plane) {
  const double near = kSheetReach * reach;
  OtherWall other;
  return squared_norm(plane.foot - center) <= near * near &&
         !surface.find_other_wall(center, plane, look.point, reach, kOneDirection, other);
}

// Whether the surface passes through a patch as one plane. `read_all`: ReadInTurn, or what gives
// the same readings sooner.
template <class Surface, class ReadAll>
VPM_HD bool sees_patch(const Surface& surface, const typename Surface::Look& look, Vec3 center,
                       double reach, const ReadAll& read_all, TangentPlane& plane) {
  return surface.mean_plane(look, center, reach, reach, read_all, plane) &&
         is_plane_of_patch(surface, look, center, reach, plane);
}

// Of a patch in which there is no surface: whether it is behind one, as its middle is.
enum class OpenPatch {
  free,
  behind,
  near,    // and no place is further behind than the tool's reach
  pushed,  // and all are nearest to one wall
};

template <class Surface>
VPM_HD OpenPatch open_patch(const Surface& surface, const Reading& middle, Vec3 center,
                            double reach, double tool_reach) {
  if (!(middle.known && middle.distance < 0)) return OpenPatch::free;
  if (!(norm(middle.foot - center) + reach < tool_reach)) return OpenPatch::behind;
  const TangentPlane wall{surface.closest_normal(center, middle), middle.foot};
  OtherWall other;
  return surface.find_other_wall(center, wall, middle.point, reach, kOneDirection, other)
             ? OpenPatch::near
             : OpenPatch::pushed;
}

}  // namespace vpm
