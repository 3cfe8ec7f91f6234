// A plane through a tool, and what of samples lies behind it.
#pragma once

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/query/ball_fraction.h"
#include "libvpm/query/surface.h"

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

// Of samples behind a plane, added in their order.
struct CrossedSums {
  double weight = 0;
  Vec3 moment;  // of each weight times its sample's centre
  bool is_cut = false;
};
// The weight of a sample that lies behind a plane.
VPM_HD inline double weight_behind(const CellSample& sample, const CrossingPlane& plane,
                                   bool& is_cut) {
  const double distance = plane.distance(widen(sample.center));
  if (distance >= sample.radius) return 0;
  if (distance <= -sample.radius) return sample.weight;
  is_cut = true;
  return sample.weight * ball_fraction_inside(distance / sample.radius);
}
// Of samples one after another.
VPM_HD inline CrossedSums crossed_in_turn(const CrossingPlane& plane, const CellSample* samples,
                                          std::uint32_t count) {
  CrossedSums sums;
  for (std::uint32_t k = 0; k < count; ++k) {
    const double inside = weight_behind(samples[k], plane, sums.is_cut);
    if (inside == 0) continue;
    sums.weight += inside;
    sums.moment += inside * widen(samples[k].center);
  }
  return sums;
}

}  // namespace vpm
