// Defines what queries learn of a scanned surface. DepthSurface (a camera's image, by projection)
// and DiskSurface (points without a camera, by the nearest disk) answer; README.md has the reasons.
#pragma once

#include <cstdint>

#include "libvpm/core/vector_width.h"

namespace vpm {

// Tells the side of the surface on which a ball lies. Conservative: any ball may be `ambiguous`,
// the others hold for all of it.
enum class Side : std::uint8_t {
  free,        // in seen free space, or never seen: counts for nothing
  behind,      // wholly behind the surface
  no_surface,  // no surface passes through it; a sample at its centre holds for all of it
  ambiguous,   // undecided
};

// Stands for no point.
inline constexpr std::uint32_t kNoPoint = 0xffffffffu;

// Holds the surface sampled for one place x, or for one per lane of Real.
template <class Real>
struct SurfaceSampleOf {
  MaskOf<Real> known{};    // false: nothing was measured in this direction
  Real distance{};         // signed distance to the surface along its normal; negative inside
  PlaceOf<Real> normal{};  // unit, into free space
  PlaceOf<Real> foot{};    // sampled surface point
  IndexOf<Real> point = ~IndexOf<Real>{};  // pixel or disk of the foot, or kNoPoint; a search hint
};
using SurfaceSample = SurfaceSampleOf<double>;

// True if a place whose sample this is lies behind the surface.
VPM_HD inline bool is_behind_surface(const SurfaceSample& on_surface) {
  return on_surface.known && on_surface.distance < 0;
}

// Samples a surface at several places in turn, as long as `take` returns true. True if all were
// taken.
struct SampleInTurn {
  // Returns the sample at the middle of a ball, about which the other places lie.
  template <class Surface>
  VPM_HD SurfaceSample middle(const Surface& surface, const Vec3& center) const {
    return surface.sample(center);
  }
  template <class Surface, int kPlaces, class Take>
  VPM_HD bool operator()(const Surface& surface, const Vec3 (&places)[kPlaces],
                         const Take& take) const {
    for (const Vec3& place : places)
      if (!take(surface.sample(place))) return false;
    return true;
  }
};

// Holds the plane of the surface in a ball.
template <class Real>
struct TangentPlaneOf {
  PlaceOf<Real> normal;  // unit, into free space
  PlaceOf<Real> foot;    // a point of the plane

  [[gnu::always_inline]] VPM_HD Real distance(const PlaceOf<Real>& x) const {
    return dot(normal, x - foot);
  }
};
using TangentPlane = TangentPlaneOf<double>;

// Returns the direction from a place x behind both of two planes to the nearest place of the solid
// behind either: a plane's normal, or the direction to the line in which they meet.
template <class Real>
[[gnu::always_inline]] VPM_HD inline PlaceOf<Real> normal_below_groove(
    const PlaceOf<Real>& x, const TangentPlaneOf<Real>& one, const TangentPlaneOf<Real>& other) {
  const Real a = one.distance(x), b = other.distance(x), cosine = dot(one.normal, other.normal);
  const Real along_one = b * cosine - a, along_other = a * cosine - b;
  const MaskOf<Real> is_other = along_one <= 0, is_one_plane = is_other | (along_other <= 0);
  const PlaceOf<Real> normal = choose(is_other, other.normal, one.normal);
  if (all(is_one_plane)) return normal;
  return choose(is_one_plane, normal,
                normalized_or_zero(along_one * one.normal + along_other * other.normal));
}

// Describes a wall to which a part of a body is nearer than to the wall nearest to its middle. That
// part lies behind the border, where both walls are equally far.
struct OtherWall {
  Vec3 normal;
  TangentPlane border;
};

// Bodies smaller than this part of the tool's radius are pushed to one wall only.
inline constexpr double kLeastDivided = 0.012;
// Two surfaces are two walls if the cosine between their normals is below this; otherwise they are
// one curved surface, whose mean direction is that in the middle.
inline constexpr double kTwoWalls = 0.9;
// Bounds the cosine that normals about a planar body must have with the plane's, since all of it is
// pushed along the plane's normal.
inline constexpr double kOneDirection = 0.95;

}  // namespace vpm
