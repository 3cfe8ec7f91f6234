// Checks a cloud that becomes a body of the scene, and puts its points into a canonical order in
// which equal points are neighbours, so that the order of the points, or giving each twice, changes
// no result.
#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// Limits the number of points that the fixed-point sums of a sphere can count (paper_contact.h).
inline constexpr std::size_t kMaxPoints = std::size_t{1} << 24;

// Throws Error(refused) for more than kMaxPoints, an image of more than 2^31 - 1 pixels or 65536 a
// side, an origin, a camera or a point beyond kLargestLength, or what validate(cloud) refuses.
void check_for_queries(const Cloud& cloud);

// Returns 0 for -0, so that both sort and merge as one place.
inline float positive_zero(float x) {
  return x == 0 ? 0.0F : x;
}

// Returns what orders the points of a cloud: place, normal, radius.
inline auto order_key(const Cloud& cloud, std::uint32_t i) {
  const Vec3f p = cloud.positions[i], n = cloud.normals[i];
  return std::make_tuple(positive_zero(p.x), positive_zero(p.y), positive_zero(p.z),
                         positive_zero(n.x), positive_zero(n.y), positive_zero(n.z),
                         cloud.radii[i]);
}

// Holds points about an origin, and their normals, in the world's axes.
struct OrderedPoints {
  Vec3 origin;
  std::vector<Vec3f> positions, normals;

  OrderedPoints() = default;
  OrderedPoints(const Cloud& cloud, const std::vector<std::uint32_t>& order);
};

// Returns a number that no other body has, to recognise copies of a body on a device.
std::uint64_t next_serial();

}  // namespace vpm
