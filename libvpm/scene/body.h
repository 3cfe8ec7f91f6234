// Defines what the measure asks of a body of the scene: a depth image, points, a solid.
//
// MeasuredBody is the concept; SeesFreeSpace, BoundsGap and HasOtherWalls are what some bodies know
// besides. The functions below ask for these and answer for bodies that do not have them; such an
// answer costs work or leaves a refinement out, and is never wrong. All members are const and may
// be called by many threads at once. Places are in the body's own frame, m.
#pragma once

#include <concepts>

#include "libvpm/scene/surface.h"

namespace vpm {

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
//   double fraction_inside(sample, x, radius)
//       returns the part of a ball about x behind the sampled surface
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
  { body.sample(x, kNoPoint) } -> std::same_as<SurfaceSample>;
  { body.closest_normal(x, on_surface) } -> std::same_as<Vec3>;
  { body.may_be_flat(in_ball) } -> std::same_as<bool>;
  { body.mean_plane(in_ball, x, length, length, SampleInTurn{}, plane) } -> std::same_as<bool>;
  { body.is_flat(in_ball, read, length, plane) } -> std::same_as<bool>;
  { body.fraction_inside(on_surface, x, length) } -> std::same_as<double>;
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
  { body.may_touch(in_ball, x, length) } -> std::same_as<bool>;
  { B::least_inverse_depth(in_ball) } -> std::same_as<float>;
  { body.may_be_free(0.0F, x, length) } -> std::same_as<bool>;
  { body.may_hold_free(in_ball, x, length) } -> std::same_as<bool>;
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
// False if the surface surely does not touch a ball inside a classified one.
template <MeasuredBody B>
VPM_HD bool may_touch(const B& body, const typename B::BallClass& in_ball, Vec3 center,
                      double radius) {
  if constexpr (SeesFreeSpace<B>)
    return body.may_touch(in_ball, center, radius);
  else
    return true;
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
