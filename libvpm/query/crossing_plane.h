// A plane through a tool, and what of samples lies behind it.
#pragma once

#include "libvpm/core/division.h"
#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/surface/ball_fraction.h"
#include "libvpm/surface/surface.h"

namespace vpm {

// A plane that crosses the tool: as the surface shows it, and in the tool's axes about its centre
// of mass.
struct CrossingPlane {
  TangentPlane seen;
  Vec3 normal;
  double height = 0;  // of the centre of mass

  CrossingPlane() = default;
  VPM_HD CrossingPlane(const TangentPlane& plane, const Pose& to_surface)
      : seen(plane),
        normal(transpose(to_surface.rotation) * plane.normal),
        height(plane.distance(to_surface.translation)) {}
  VPM_HD double distance(Vec3 about_center_of_mass) const {
    return dot(normal, about_center_of_mass) + height;
  }
};

// Of samples behind a plane.
struct CrossedSums {
  double weight = 0;
  Vec3 moment;  // of each weight times its sample's centre
  bool is_cut = false;
};
// Samples are added in so many rows, sample k in row k % kSumRows, and these by halves: so lanes of
// vectors, or threads, can add a row each.
inline constexpr std::uint32_t kSumRows = 16;

// The weight of a sample that lies behind a plane. Without branches: what is asked of many samples
// at once waits for the slowest division only (of which what is not cut needs none).
VPM_HD inline double weight_behind(const CellSample& sample, const CrossingPlane& plane,
                                   bool& is_cut) {
  const double distance = plane.distance(widen(sample.center)), radius = sample.radius;
  const bool reached = !(distance >= radius), cut = reached && !(distance <= -radius);
  const double fraction = fraction_of_cut_ball(quotient(distance, radius));
  is_cut |= cut;
  return reached ? (cut ? sample.weight * fraction : sample.weight) : 0;
}
// Adds what of a sample lies behind a plane to its row. Zeros too: a row that begins with 0 is
// never -0, whoever adds it.
VPM_HD inline void add_to_row(const CellSample& sample, const CrossingPlane& plane,
                              CrossedSums& row, bool& is_cut) {
  const double inside = weight_behind(sample, plane, is_cut);
  row.weight += inside;
  row.moment += inside * widen(sample.center);
}
// Of samples one after another.
VPM_HD inline CrossedSums crossed_in_turn(const CrossingPlane& plane, const CellSample* samples,
                                          std::uint32_t count) {
  CrossedSums rows[kSumRows];
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
