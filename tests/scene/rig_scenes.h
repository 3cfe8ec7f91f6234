// What tests of several cameras look at, and how they compare what these tell.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "libvpm/synthetic/render.h"
#include "tests/query/lattice_model.h"
#include "tests/query/ring_of_cameras.h"

namespace vpm::testing {

inline const synthetic::SurfacePtr& box() {
  static const synthetic::SurfacePtr kBox =
      synthetic::make_block({0.24, 0.18, 0.2}, {testing::generic_rotation(), {}});
  return kBox;
}
// Puts a box into a room, and a thin plate beside it.
inline synthetic::SurfacePtr room_with(synthetic::SurfacePtr thing) {
  return synthetic::make_union({std::move(thing),
                                synthetic::make_block({0.004, 0.2, 0.2}, {{}, {0.25, 0.03, 0.02}}),
                                synthetic::make_inverted_ball({}, 1.5)});
}
inline const synthetic::SurfacePtr& scene() {
  static const synthetic::SurfacePtr kScene = room_with(box());
  return kScene;
}

// Returns places in a cube about the origin, up to `reach`, m, along each axis.
inline std::vector<Vec3> places(int count, double reach) {
  std::vector<Vec3> all;
  for (int k = 0; k < count; ++k)
    all.push_back(
        {reach * std::sin(12.9 * k), reach * std::sin(78.2 * k + 1), reach * std::sin(37.7 * k)});
  return all;
}

inline void expect_same_bits(const SurfaceSample& a, const SurfaceSample& b, int place) {
  ASSERT_EQ(a.known, b.known) << place;
  if (!a.known) return;
  EXPECT_EQ(a.distance, b.distance) << place;
  EXPECT_EQ(a.normal.x, b.normal.x) << place;
  EXPECT_EQ(a.foot.z, b.foot.z) << place;
}

// Unsets pixels in disks of 2 to 7 pixels about places in the middle of an image.
inline void make_holes(DepthImage& image, std::uint64_t seed) {
  for (std::uint64_t k = 0; k < 40; ++k) {
    synthetic::NormalNumbers numbers(seed, k);
    const double u0 = image.width * (0.5 + 0.15 * numbers.next()),
                 v0 = image.height * (0.5 + 0.15 * numbers.next()),
                 radius = std::clamp(4 + 2 * numbers.next(), 2.0, 7.0);
    for (std::uint32_t v = 0; v < image.height; ++v)
      for (std::uint32_t u = 0; u < image.width; ++u)
        if (std::hypot(u - u0, v - v0) < radius) image.depth[image.index(u, v)] = 0;
  }
}

}  // namespace vpm::testing
