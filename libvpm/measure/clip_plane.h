// Clips samples of the tool by a plane.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/pose.h"
#include "libvpm/measure/piece_shape.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/surface.h"

namespace vpm {

// Describes a plane that cuts the tool, in the surface's frame and about the tool's centre of mass.
struct ClipPlane {
  TangentPlane seen;
  Vec3 normal;
  double height = 0;  // signed distance of the centre of mass from the plane, m

  ClipPlane() = default;
  VPM_HD ClipPlane(const TangentPlane& plane, const Pose& to_surface)
      : seen(plane),
        normal(transpose(to_surface.rotation) * plane.normal),
        height(plane.distance(to_surface.translation)) {}
  VPM_HD double distance(Vec3 about_center_of_mass) const {
    return dot(normal, about_center_of_mass) + height;
  }
};

// Holds volume and first moment of the parts of samples behind a plane.
struct ClippedMoments {
  double weight = 0;
  Vec3 moment;  // sum of each weight times its sample's centre
  bool is_cut = false;
};
// Counts the partial sums of ClippedMoments: sample k goes to row k % kSumRows, and rows are added
// pairwise by halves. Vector lanes or threads can each add a row and get the same bits.
inline constexpr std::uint32_t kSumRows = 16;

// Returns the weight of a piece behind a plane with this normal, at these signed distances, m, from
// the piece's middle, and in `is_cut` whether the plane cuts it. It has no branches, since vector
// lanes would all wait for the slowest. Real is double or a vector; see piece_shape.h for Shape.
template <class Shape, class Real, class Mask>
[[gnu::always_inline]] VPM_HD inline Real weight_behind(const Shape& shape, const Vec3& normal,
                                                        const Real& distance, const Real& weight,
                                                        Mask& is_cut) {
  const Real reach = shape.reach_toward(normal);
  const Mask reached = distance < reach;
  is_cut = reached & (distance > -reach);
  const Real part = weight * shape.fraction_behind(distance, normal);
  return reached ? (is_cut ? part : weight) : Real{};
}
// Adds the part of a sample behind a plane to its row. Adds zeros too, so that no row is ever -0.
VPM_HD inline void add_to_row(const CellSample& sample, const ClipPlane& plane, ClippedMoments& row,
                              bool& is_cut) {
  bool cut = false;
  const double inside =
      weight_behind(BallShape<double>{sample.radius}, plane.normal,
                    plane.distance(widen(sample.center)), double{sample.weight}, cut);
  is_cut |= cut;
  row.weight += inside;
  row.moment += inside * widen(sample.center);
}
// Returns the clipped moments of samples, one after another.
VPM_HD inline ClippedMoments clipped_in_turn(const ClipPlane& plane, const CellSample* samples,
                                             std::uint32_t count) {
  ClippedMoments rows[kSumRows];
  for (std::uint32_t k = 0; k < count; ++k)
    add_to_row(samples[k], plane, rows[k % kSumRows], rows[0].is_cut);
  for (std::uint32_t half = kSumRows / 2; half > 0; half /= 2) {
    for (std::uint32_t r = 0; r < half; ++r) {
      rows[r].weight += rows[r + half].weight;
      rows[r].moment += rows[r + half].moment;
    }
  }
  return rows[0];
}

}  // namespace vpm
