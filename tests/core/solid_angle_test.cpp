// Terms of winding numbers: solid angles of triangles and of small pieces of surface.

#include "libvpm/core/solid_angle.h"

#include <gtest/gtest.h>

namespace vpm {
namespace {

TEST(TriangleAngle, OfAnOctantIsAnEighthOfAllDirections) {
  const Vec3 x{3, 0, 0}, y{0, 0.2, 0}, z{0, 0, 7};
  EXPECT_NEAR(TriangleAngle(x, y, z).value(), kFullSolidAngle / 8, 1e-14);
  EXPECT_NEAR(TriangleAngle(y, x, z).value(), -kFullSolidAngle / 8, 1e-14);
}

TEST(TriangleAngle, OfATetrahedronIsAllDirectionsInsideAndNoneOutside) {
  const Vec3 a{1, 1, 1}, b{-1, -1, 1}, c{-1, 1, -1}, d{1, -1, -1};
  const auto sum_at = [&](Vec3 p) {
    return TriangleAngle(a - p, c - p, b - p).value() + TriangleAngle(a - p, b - p, d - p).value() +
           TriangleAngle(a - p, d - p, c - p).value() + TriangleAngle(b - p, c - p, d - p).value();
  };
  EXPECT_NEAR(std::abs(sum_at({0.1, -0.2, 0.05})), kFullSolidAngle, 1e-13);
  EXPECT_NEAR(sum_at({2, 0.3, -1}), 0, 1e-13);
}

TEST(TriangleAngle, KnowsATriangleThatHoldsTheOrigin) {
  const Vec3 a{1, 0, 0}, b{-1, 1, 0}, c{-1, -1, 0}, up{0, 0, 1e-3};
  EXPECT_TRUE(TriangleAngle(a, b, c).holds_origin(1e-12));
  EXPECT_TRUE(TriangleAngle(a, b, c).is_flat());
  EXPECT_FALSE(TriangleAngle(a + up, b + up, c + up).holds_origin(1e-12));
  const Vec3 aside{5, 0, 0};  // in the plane, beside the triangle
  EXPECT_FALSE(TriangleAngle(a + aside, b + aside, c + aside).holds_origin(1e-12));
}

TEST(DipoleAngle, IsThatOfASmallTriangle) {
  const Vec3 at{0.3, -0.4, 1.2}, b{1e-3, 0, 0}, c{0, 1e-3, 5e-4};
  const Vec3 middle = at + 1.0 / 3 * (b + c), area = 0.5 * cross(b, c);
  EXPECT_NEAR(
      dipole_angle(area, middle, squared_norm(middle)) / TriangleAngle(at, at + b, at + c).value(),
      1, 1e-5);
}

}  // namespace
}  // namespace vpm
