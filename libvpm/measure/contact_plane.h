// Averages the surface in a cell that it cuts to a plane, which decides about occluded places.
#pragma once

#include "libvpm/core/fixed_sum.h"
#include "libvpm/core/vec3.h"

namespace vpm {

// Bounds the distance, in bounding radii of a cell from its centre, within which a surface is
// surely the one that cuts the cell.
inline constexpr double kSheetReach = 3;

// Holds the mean plane of the surface inside a cell.
struct ContactPlane {
  // Sums unit normals, and feet relative to the cell's centre in units of its bounding radius, over
  // the samples that are cut. |terms| < 8, so 2^20 samples fit.
  using Sum = FixedSum<40>;
  Sum normal[3], foot[3];
  std::int64_t count = 0;

  VPM_HD void add(Vec3 n, Vec3 relative_foot) {
    normal[0].add(n.x), normal[1].add(n.y), normal[2].add(n.z);
    foot[0].add(relative_foot.x), foot[1].add(relative_foot.y), foot[2].add(relative_foot.z);
    ++count;
  }
  VPM_HD Vec3 normals() const { return {normal[0].real(), normal[1].real(), normal[2].real()}; }
  // Returns the mean foot. Requires count > 0.
  VPM_HD Vec3 mean_foot() const {
    const double per = 1 / static_cast<double>(count);
    return {per * foot[0].real(), per * foot[1].real(), per * foot[2].real()};
  }
  // Returns the height of a place above the plane, negative behind it. Place and height are
  // relative to the cell's centre, in units of its bounding radius.
  VPM_HD double height(Vec3 relative) const {
    return dot(normalized_or_zero(normals()), relative - mean_foot());
  }
  // True if a place lies behind the plane and the surface point that hides it is at most `near` in
  // front of it, so that both belong to one surface. False without a plane. Units as for height().
  VPM_HD bool supports(Vec3 relative, Vec3 hiding, double near) const {
    return count > 0 && height(relative) < 0 && height(hiding) <= near;
  }
};

// Describes a cut cell in the surface's frame, m. Its plane decides about places that are far
// behind the surface or occluded.
struct CutCell {
  ContactPlane plane;
  Vec3 center;
  double reach = 0;

  VPM_HD Vec3 relative(Vec3 x) const { return 1 / reach * (x - center); }
  // True if a place lies behind the plane, so that the flood may go there.
  VPM_HD bool is_behind(Vec3 x) const { return plane.height(relative(x)) < 0; }
  VPM_HD bool supports(Vec3 x, Vec3 hiding, double near) const {
    return plane.supports(relative(x), relative(hiding), near / reach);
  }
};

}  // namespace vpm
