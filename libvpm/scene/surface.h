// The scanned surface as a query asks it. Two kinds of cloud answer: DepthSurface (a camera's
// image, by projection) and DiskSurface (points without a camera, by the nearest disk). README.md
// has the reasons.
#pragma once

#include <cstdint>

#include "libvpm/core/vector_width.h"

namespace vpm {

// Where a ball lies, decided conservatively: `ambiguous` may be said of any ball, the others only
// where they are true.
enum class Side : std::uint8_t {
  free,        // seen free space, or never seen: counts for nothing
  behind,      // wholly behind the seen surface
  no_surface,  // no surface passes through it; a sample at its centre holds for all of it
  ambiguous,   // look closer
};

// A point of the cloud by its index, for surfaces that have such.
inline constexpr std::uint32_t kNoPoint = 0xffffffffu;

// The surface as seen from one place x, or from as many as a Real has lanes.
template <class Real>
struct SurfaceSampleOf {
  MaskOf<Real> known{};    // false: nothing was measured in this direction
  Real distance{};         // signed distance to the surface along its normal; negative inside
  PlaceOf<Real> normal{};  // unit, into free space
  PlaceOf<Real> foot{};    // the surface point that was read
  IndexOf<Real> point =
      ~IndexOf<Real>{};  // the same, by index (or kNoPoint): a good place to begin the next search
};
using SurfaceSample = SurfaceSampleOf<double>;

// True if a place whose sample this is lies behind the surface.
VPM_HD inline bool is_behind_surface(const SurfaceSample& on_surface) {
  return on_surface.known && on_surface.distance < 0;
}

// Reads a surface at several places, one after the other, as long as `take` says to go on. Returns
// true if it has taken all.
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

// The surface in a ball, where it is flat: a plane.
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
// that lies behind either: that of one of the planes, or to where they meet.
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

// A wall to which a part of a body is nearer than to the wall that its middle is nearest to. That
// part is behind the border, which is as far from both.
struct OtherWall {
  Vec3 normal;
  TangentPlane border;
};

// Bodies smaller than this part of the tool's reach are pushed to one wall only.
inline constexpr double kLeastDivided = 0.012;
// Two walls, by the cosine between them: what turns less is taken for the turning of one surface,
// whose direction in the middle is that of the mean.
inline constexpr double kTwoWalls = 0.9;
// Where the surface is one plane, all that is behind it is pushed along its normal. So nothing in
// the ball may be nearest to a place that faces elsewhere by more than this.
inline constexpr double kOneDirection = 0.95;

}  // namespace vpm
