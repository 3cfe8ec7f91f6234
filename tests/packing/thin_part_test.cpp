// Plates, needles and shells: bounds of the room beside them hold, and packing them ends soon.
#include "libvpm/packing/thin_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packer.h"
#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

using synthetic::make_box;
using synthetic::make_icosphere;

const Vec3 kShift{0.1, -0.2, 0.3};

Solid turned(Solid solid) {
  return moved(std::move(solid), Random(3).rotation(), kShift);
}

Solid shell(double thickness) {
  return turned(joined(make_icosphere(1, 2), reversed(make_icosphere(1 - thickness, 2))));
}

TEST(ThinPart, NoPointOfTheCubeHasMoreRoom) {
  int inside = 0;
  for (const Solid& solid : {turned(make_box(1, 0.8, 0.01)), turned(make_box(1, 0.01, 0.01)),
                             shell(0.01), random_solid(0, 1), random_solid(3, 2)}) {
    const SolidDistance distance(solid);
    Random random(5);
    for (int k = 0; k < 400; ++k) {
      const double half_edge = std::pow(2, random.uniform(-7, -2));
      const Vec3 near = distance.closest(random.in_box({0, 0, 0}, {1, 1, 1}), 2).point;
      const Vec3 center = near + half_edge * random.in_box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5});
      const double bound = thin_part(distance, center, half_edge).bound;
      if (!std::isfinite(bound)) continue;
      for (int i = 0; i < 100; ++i) {  // near the surface; all else is outside
        const Vec3 in_cube = center + half_edge * random.in_box({-1, -1, -1}, {1, 1, 1});
        const Vec3 x =
            distance.closest(in_cube, 2).point + 2 * bound * random.in_box({-1, -1, -1}, {1, 1, 1});
        const Vec3 off = x - center;
        if (std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) > half_edge) continue;
        inside += distance.inside(x);
        EXPECT_TRUE(!distance.inside(x) || distance.closest(x, 2).distance <= bound);
      }
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(ThinPart, IsExactOnAPlate) {
  const SolidDistance distance(make_box(1, 1, 0x1p-10));  // one unit is two metres
  const ThinPart part = thin_part(distance, {0.5, 0.5, 0.5}, 0x1p-5);
  EXPECT_NEAR(part.bound, 0x1p-12, 1e-12);
}

// Around the insphere of a ball, the gap is widest at the corners, where a sphere of half its width
// fits. Without the bound, cells would be cut until they are as small as that.
TEST(GapBound, IsTheGapAroundTheBallInABall) {
  const SolidDistance distance(make_icosphere(1, 4));
  const double outer = 1 / distance.frame().scale;  // in the unit frame, as all that follows
  const Vec3 middle = distance.frame().to_unit({0, 0, 0});
  const Sphere ball{middle, distance.closest(middle, 2).distance};
  Random random(7);
  int found = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 away = normalized_or_zero(random.in_box({-1, -1, -1}, {1, 1, 1}));
    const Vec3 center = middle + outer * away;
    const double bound = gap_bound(distance, ball, center, outer / 32, HUGE_VAL);
    if (!std::isfinite(bound)) continue;
    ++found;
    EXPECT_LE(bound, 0.5 * (outer - ball.radius) + 1e-9);
  }
  EXPECT_GT(found, 190);
}

struct Thin {
  const char* name;
  Solid solid;
  double radius;  // expected radius of the largest sphere
};

// Without bounds of thin parts these took minutes, hours and years.
TEST(ThinSolids, ArePackedWithinSeconds) {
  for (const Thin& thin : {Thin{"plate 1:10 000", turned(make_box(1, 1, 1e-4)), 0.5e-4},
                           Thin{"plate 1:100 000", turned(make_box(1, 1, 1e-5)), 0.5e-5},
                           Thin{"needle 1:100 000", turned(make_box(1, 1e-5, 1e-5)), 0.5e-5}}) {
    SCOPED_TRACE(thin.name);
    const PackResult result = pack(thin.solid, {.spheres = 50});
    ASSERT_EQ(result.spheres.size(), 50U);
    EXPECT_TRUE(certify(thin.solid, result.spheres).holds);
    EXPECT_NEAR(result.spheres.front().radius, thin.radius, 1e-3 * thin.radius);
    EXPECT_GT(result.spheres.back().radius, 0.95 * thin.radius);
  }
}

TEST(ThinSolids, BelowTheNumericalFloorNothingIsLookedFor) {
  for (const Solid& solid : {turned(make_box(1, 1, 1e-6)), turned(make_box(1, 1e-6, 1e-6))}) {
    const PackResult result = pack(solid, {.spheres = 50});
    EXPECT_TRUE(result.spheres.empty());
    EXPECT_EQ(result.stop, StopReason::numerical_floor);
  }
}

// Only a part of the hollow box's room is kept, but as many spheres as asked for are delivered.
TEST(ThinSolids, AsManyAsAskedAreDelivered) {
  const Solid solid = joined(make_box(1, 1, 1), reversed(make_box(0.998, 0.998, 0.998)));
  const PackResult result = pack(solid, {.spheres = 100});
  EXPECT_TRUE(result.partly_searched);
  EXPECT_TRUE(certify(solid, result.spheres).holds);
  ASSERT_EQ(result.spheres.size(), 100U);
  const double in_corner = 1e-3 * std::sqrt(3.0) / (1 + std::sqrt(3.0));
  EXPECT_LE(result.spheres.front().radius, in_corner);
  EXPECT_GT(result.spheres.back().radius, 0.499e-3);
  EXPECT_FALSE(pack(make_box(1, 1, 0.01), {.spheres = 100}).partly_searched);
}

}  // namespace
}  // namespace vpm::test
