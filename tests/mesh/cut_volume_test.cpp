#include "libvpm/mesh/cut_volume.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/truth.h"

namespace vpm {
namespace {

Solid moved(Solid solid, Vec3 by) {
  for (Vec3& v : solid.vertices) v += by;
  return solid;
}

TEST(CutVolume, OfACubeByPlanes) {
  const Solid cube = moved(synthetic::make_cube(2), {5, -3, 1});
  EXPECT_NEAR(volume_below_plane(cube, {1, 0, 0}, 4.5), 2, 1e-13);  // a quarter
  EXPECT_NEAR(volume_below_plane(cube, {0, 0, -1}, -1), 4, 1e-13);  // upper half
  EXPECT_EQ(volume_below_plane(cube, {1, 0, 0}, 3.5), 0);
  EXPECT_NEAR(volume_below_plane(cube, {1, 0, 0}, 9), 8, 1e-13);
  const double third =
      1 / std::sqrt(3.0);  // cuts a corner off: a tetrahedron with three edges of 1
  const Vec3 diagonal{third, third, third};
  EXPECT_NEAR(volume_below_plane(cube, diagonal, dot(diagonal, Vec3{5, -4, 0})), 1.0 / 6, 1e-13);
}

TEST(CutVolume, OfACubeByBalls) {
  const Solid cube = synthetic::make_cube(2);
  const double ball = 4 * kPi / 3;
  EXPECT_NEAR(volume_in_ball(cube, {{}, 2}), 8, 1e-12);     // holds the cube
  EXPECT_NEAR(volume_in_ball(cube, {{}, 1}), ball, 1e-12);  // touches its faces
  EXPECT_NEAR(volume_in_ball(cube, {{0.3, 0, 0}, 0.5}), ball / 8, 1e-12);
  EXPECT_NEAR(volume_in_ball(cube, {{4, 1, 0}, 2.5}), 0, 1e-12);
  EXPECT_NEAR(volume_in_ball(cube, {{1, 0, 0}, 0.5}), ball / 16, 1e-12);   // centre on a face
  EXPECT_NEAR(volume_in_ball(cube, {{1, 1, 0}, 0.5}), ball / 32, 1e-12);   // on an edge
  EXPECT_NEAR(volume_in_ball(cube, {{1, 1, -1}, 0.5}), ball / 64, 1e-12);  // on a corner
  const double cap = kPi * 0.25 * 0.25 * (3 * 0.5 - 0.25) / 3;
  EXPECT_NEAR(volume_in_ball(cube, {{1.25, 0, 0}, 0.5}), cap, 1e-12);
}

// Compares with the integrals of libvpm/synthetic, which are accurate to about 1e-6.
TEST(CutVolume, AgreesWithIntegration) {
  const Solid torus = synthetic::make_twisted_torus(0.09, 0.05, 3, 24);
  const synthetic::TrueSolid truth(torus);
  const double volume = truth.mass().volume;
  for (int k = 0; k < 12; ++k) {
    const Vec3 towards =
        normalized_or_zero({std::sin(1.0 + k), std::cos(2.0 * k), std::sin(3.0 * k)});
    const double offset = -0.1 + 0.017 * k;
    const Vec3 center = (offset - 0.3) * towards;
    EXPECT_NEAR(volume_in_ball(torus, {center, 0.3}) / volume,
                truth.penetration({}, *synthetic::make_ball(center, 0.3)).volume / volume, 5e-6);
    EXPECT_NEAR(
        volume_below_plane(torus, towards, offset) / volume,
        truth.penetration({}, *synthetic::make_wall(offset * towards, towards)).volume / volume,
        5e-6);
  }
}

}  // namespace
}  // namespace vpm
