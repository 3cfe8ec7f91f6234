// Defines what the measure asks of a body of the scene (a depth image, points, a solid), and what
// it learns of the surface. DepthSurface (a camera's image, by projection) and DiskSurface (points
// without a camera, by the nearest disk) answer; README.md has the reasons.
//
// MeasuredBody is the concept; SeesFreeSpace, TellsSight, KnowsDepths, TellsEnclosed, TellsUnknown,
// BoundsGap and HasOtherWalls are what some bodies know besides; SharesPixels, what is faster so.
// The functions below ask for these and answer for bodies that do not have them; such an answer
// costs work or leaves a refinement out, and is never wrong. All members are const and may be
// called by many threads at once. Places are in the body's own frame, m.
#pragma once

#include <concepts>
#include <cstdint>

#include "libvpm/core/host_device.h"
#include "libvpm/core/vector_width.h"
#include "libvpm/scene/piece_shape.h"

namespace vpm {

// Returns the fraction of a piece behind two planes that leave the given fractions; `cosine` is of
// the angle between their normals. Exact for opposite and equal planes, and for perpendicular ones
// through the centre; interpolated between these.
VPM_HD constexpr double fraction_of_both(double first, double second, double cosine) {
  const double across = first * second;
  const double apart = first + second - 1 > 0 ? first + second - 1 : 0;
  const double least = first < second ? first : second;
  return cosine < 0 ? across - cosine * (apart - across) : across + cosine * (least - across);
}

// Tells the side of the surface on which a ball lies. Conservative: any ball may be `ambiguous`,
// the others hold for all of it.
enum class Side : std::uint8_t {
  free,        // in seen free space, or never seen: counts for nothing
  behind,      // wholly behind the surface
  no_surface,  // no surface passes through it; a sample at its centre holds for all of it
  ambiguous,   // undecided
};

// Tells what a camera sees in the direction of a place, or of all places in a ball.
enum class Sight : std::uint8_t {
  seen,         // a surface was measured there: the place is before it or behind it
  hole,         // in view, but nothing was measured there
  out_of_view,  // outside of the image, or behind the camera
  mixed,        // of a ball only: its places may differ
};

// Index that stands for no point.
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

// Samples a surface for a piece about x that reaches so far, m: nothing that is further before the
// surface is asked of it.
template <class Surface>
VPM_HD SurfaceSample sample_for_piece(const Surface& surface, const Vec3& x, double reach,
                                      std::uint32_t point) {
  if constexpr (requires { surface.sample_within(x, reach, point); })
    return surface.sample_within(x, reach, point);
  else
    return surface.sample(x, point);
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

// Returns a coordinate axis far from a direction.
VPM_HD inline Vec3 axis_aside(Vec3 n) {
  return std::fabs(n.x) < std::fabs(n.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
}

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

// Bodies smaller than this part of the tool radius are pushed to one wall only.
inline constexpr double kLeastDivided = 0.012;
// Two surfaces are two walls if the cosine between their normals is below this; otherwise they are
// one curved surface, whose mean direction is that in the middle.
inline constexpr double kTwoWalls = 0.9;
// Least cosine that normals about a planar body must have with the plane's, since all of it is
// pushed along the plane's normal.
inline constexpr double kOneDirection = 0.95;

// Describes a body of the scene. Its members:
//   BallClass classify_ball(center, radius)
//       classifies a ball: `side` holds for all of it, or is ambiguous; `point` is where a search
//       in it begins, or kNoPoint
//   SurfaceSample sample(x, point)
//       samples the surface for a place x; unknown where nothing was measured
//   Vec3 closest_normal(x, sample)
//       returns the unit direction of the nearest way out of a place x behind the surface
//   bool may_be_flat(in_ball)
//       false if the surface in the ball is surely not one plane
//   bool mean_plane(in_ball, center, radius, tolerance, sample_all, plane)
//       finds the mean plane of the surface across a ball that may_be_flat()
//   bool is_flat(in_ball, read, tolerance, plane)
//       finds the plane at the middle of such a ball, which read() samples
//   double fraction_inside(sample, x, shape)
//       returns the part of a piece about x, of any shape, behind the sampled surface
//   around_ball(center, radius, point)
//       returns a sampler for places in the ball, faster than the body itself
// kTellsInside is true if places behind the surface are inside as far as anybody knows, so that no
// flood decides; kSearchesFoot, if closest_normal() searches, so that neighbours share its result.
template <class B>
concept MeasuredBody = requires(const B& body, Vec3 x, double length, SurfaceSample on_surface,
                                TangentPlane plane, const typename B::BallClass& in_ball,
                                SurfaceSample (*read)()) {
  { body.classify_ball(x, length) } -> std::same_as<typename B::BallClass>;
  { in_ball.side } -> std::convertible_to<Side>;
  { in_ball.point } -> std::convertible_to<std::uint32_t>;
  requires std::default_initializable<typename B::BallClass>;
  { body.sample(x, kNoPoint) } -> std::same_as<SurfaceSample>;
  { body.closest_normal(x, on_surface) } -> std::same_as<Vec3>;
  { body.may_be_flat(in_ball) } -> std::same_as<bool>;
  { body.mean_plane(in_ball, x, length, length, SampleInTurn{}, plane) } -> std::same_as<bool>;
  { body.is_flat(in_ball, read, length, plane) } -> std::same_as<bool>;
  { body.fraction_inside(on_surface, x, PieceShape{}) } -> std::same_as<double>;
  body.around_ball(x, length, kNoPoint);
  { B::kTellsInside } -> std::convertible_to<bool>;
  { B::kSearchesFoot } -> std::convertible_to<bool>;
};

// True for a body that has seen free space, pixel by pixel, which no mean of the surface outvotes.
template <class B>
concept SeesFreeSpace = MeasuredBody<B> &&
    requires(const B& body, Vec3 x, double length, const typename B::BallClass& in_ball) {
  { body.side_of(in_ball, x, length) } -> std::same_as<Side>;
  { body.tells_of_parts(x, length) } -> std::same_as<bool>;
  { body.is_free_part(in_ball, x, length) } -> std::same_as<bool>;
  { B::least_inverse_depth(in_ball) } -> std::same_as<float>;
  { body.may_be_free(0.0F, x, length) } -> std::same_as<bool>;
  { body.may_hold_free(in_ball, x, length) } -> std::same_as<bool>;
};

// True for a body that knows what of space its camera sees: sight_at() a place, and of all places
// in a classified ball, which may be mixed.
template <class B>
concept TellsSight = MeasuredBody<B> &&
    requires(const B& body, Vec3 x, const typename B::BallClass& in_ball) {
  { body.sight_at(x) } -> std::same_as<Sight>;
  { B::sight_of(in_ball) } -> std::same_as<Sight>;
};

// True for a body that may know a place behind the surface to be inside however deep it lies.
template <class B>
concept KnowsDepths = MeasuredBody<B> && requires(const B& body, Vec3 x) {
  { body.is_seen_behind_from_sides(x) } -> std::same_as<bool>;
};

// True for a body that knows of places far from its surface whether it encloses them. If
// may_enclose() is false it encloses none.
template <class B>
concept TellsEnclosed = MeasuredBody<B> && requires(const B& body, Vec3 x) {
  { body.may_enclose() } -> std::same_as<bool>;
  { body.encloses(x) } -> std::same_as<bool>;
};

// True for a body without a camera that knows where nobody can tell whether it is solid: of a
// classified ball of which nothing counts as inside. Its class follows from its point.
template <class B>
concept TellsUnknown = MeasuredBody<B> &&
    requires(const B& body, const typename B::BallClass& in_ball) {
  { body.is_unknown(in_ball) } -> std::same_as<bool>;
  { B::class_by_point(in_ball.point, Vec3{}, 0.0) } -> std::same_as<typename B::BallClass>;
};

// True for a body whose side_of() asks pixels of an ambiguous ball, which lanes of a device share:
// may_be_seen_past() rules most balls out, and is_seen_past() tests the rows first, first + step,
// ... of pixels_of() a ball against a depth, which is that of the farthest place in the ball.
template <class B>
concept SharesPixels = SeesFreeSpace<B> &&
    requires(const B& body, double depth, const typename B::BallClass& in_ball) {
  { body.may_be_seen_past(in_ball, depth) } -> std::same_as<bool>;
  { body.is_seen_past(B::pixels_of(in_ball), depth, 0U, 1U) } -> std::same_as<bool>;
};

// True for a body that may tell the side of a ball that classify_ball() left ambiguous, by more
// work.
template <class B>
concept LooksCloser = MeasuredBody<B> &&
    requires(const B& body, Vec3 x, double length, const typename B::BallClass& in_ball) {
  { body.side_by_small_tiles(in_ball, x, length) } -> std::same_as<Side>;
};

// True for a body that bounds how far places of a ball behind it are from the surface.
template <class B>
concept BoundsGap = MeasuredBody<B> &&
    requires(const B& body, Vec3 x, double length, const typename B::BallClass& in_ball) {
  { body.largest_gap(in_ball, x, length) } -> std::same_as<double>;
};

// True for a body, or a part of one about a ball, that may show an obstacle from several sides.
template <class B>
concept HasOtherWalls = requires(const B& body, Vec3 x, double length, TangentPlane plane,
                                 OtherWall& wall) {
  { body.find_other_wall(x, plane, kNoPoint, length, length, wall) } -> std::same_as<bool>;
};

// Returns the side of a classified ball. Its own pixels may show an ambiguous one free.
template <MeasuredBody B>
VPM_HD Side side_of(const B& body, const typename B::BallClass& in_ball, Vec3 center,
                    double radius) {
  if constexpr (SeesFreeSpace<B>)
    return body.side_of(in_ball, center, radius);
  else
    return in_ball.side;
}
// True if the class of a ball tells about the balls in it (is_free_part).
template <MeasuredBody B>
VPM_HD bool tells_of_parts(const B& body, Vec3 center, double radius) {
  if constexpr (SeesFreeSpace<B>)
    return body.tells_of_parts(center, radius);
  else
    return false;
}
// True if the class of a ball shows a ball in it to be free.
template <MeasuredBody B>
VPM_HD bool is_free_part(const B& body, const typename B::BallClass& in_ball, Vec3 center,
                         double radius) {
  if constexpr (SeesFreeSpace<B>)
    return body.is_free_part(in_ball, center, radius);
  else
    return false;
}
// Returns the least inverse depth, 1/m, of the surface in a classified ball; 0 where no free space
// was seen.
template <MeasuredBody B>
VPM_HD float least_inverse_depth(const typename B::BallClass& in_ball) {
  if constexpr (SeesFreeSpace<B>)
    return B::least_inverse_depth(in_ball);
  else
    return 0;
}
// True if a ball may have been seen free although it lies behind the mean plane of the surface.
// `least` is the least_inverse_depth() of a ball that holds it.
template <MeasuredBody B>
VPM_HD bool may_be_free(const B& body, float least, Vec3 center, double radius) {
  if constexpr (SeesFreeSpace<B>)
    return body.may_be_free(least, center, radius);
  else
    return false;
}
// False if may_be_free() is false for every ball in this one, which lies in a classified ball.
template <MeasuredBody B>
VPM_HD bool may_hold_free(const B& body, const typename B::BallClass& in_ball, Vec3 center,
                          double radius) {
  if constexpr (SeesFreeSpace<B>)
    return body.may_hold_free(in_ball, center, radius);
  else
    return false;
}
// Return what is seen in the direction of a place, and of all places in a classified ball. A body
// without a camera knows of no place that is not seen.
template <MeasuredBody B>
VPM_HD Sight sight_at(const B& body, Vec3 x) {
  if constexpr (TellsSight<B>)
    return body.sight_at(x);
  else
    return Sight::seen;
}
template <MeasuredBody B>
VPM_HD Sight sight_of(const typename B::BallClass& in_ball) {
  if constexpr (TellsSight<B>)
    return B::sight_of(in_ball);
  else
    return Sight::seen;
}
// True if a place behind the surface is inside however deep it lies.
template <MeasuredBody B>
VPM_HD bool is_seen_behind_from_sides(const B& body, Vec3 x) {
  if constexpr (KnowsDepths<B>)
    return body.is_seen_behind_from_sides(x);
  else
    return false;
}
// Return whether a body encloses any place, and one that lies behind its surface.
template <MeasuredBody B>
VPM_HD bool may_enclose(const B& body) {
  if constexpr (TellsEnclosed<B>)
    return body.may_enclose();
  else
    return false;
}
template <MeasuredBody B>
VPM_HD bool encloses(const B& body, Vec3 x) {
  if constexpr (TellsEnclosed<B>)
    return body.encloses(x);
  else
    return false;
}
// Returns a bound of the distance, m, from any place of a classified ball to the foot of its
// surface sample; infinite where the body knows none.
template <MeasuredBody B>
VPM_HD double gap_bound(const B& body, const typename B::BallClass& in_ball, Vec3 center,
                        double radius) {
  if constexpr (BoundsGap<B>)
    return body.largest_gap(in_ball, center, radius);
  else
    return HUGE_VAL;
}
// True if a part of a ball about x is nearer to another wall than to `own`, which its middle is
// nearest to. Walls whose normals have a cosine above `unlike` are one. `other` receives the wall.
template <class B>
VPM_HD bool finds_other_wall(const B& body, Vec3 x, const TangentPlane& own, std::uint32_t point,
                             double radius, double unlike, OtherWall& other) {
  if constexpr (HasOtherWalls<B>)
    return body.find_other_wall(x, own, point, radius, unlike, other);
  else
    return false;
}

}  // namespace vpm
