#include "libvpm/model/solid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {
namespace {

TEST(MassProperties, OfBodiesKnownInClosedForm) {
  const MassProperties cube = mass_properties(synthetic::make_cube(0.2));
  EXPECT_NEAR(cube.volume, 0.008, 1e-17);
  EXPECT_NEAR(norm(cube.center_of_mass), 0, 1e-16);
  const MassProperties tetrahedron = mass_properties(synthetic::make_tetrahedron(1));
  EXPECT_NEAR(tetrahedron.volume, std::sqrt(2.0) / 12, 1e-15);
  EXPECT_NEAR(norm(tetrahedron.center_of_mass), 0, 1e-15);
  EXPECT_NEAR(mass_properties(synthetic::make_octahedron(1)).volume, std::sqrt(2.0) / 3, 1e-15);
}

TEST(MassProperties, AddUpOverBodies) {
  const Solid pair = together(synthetic::make_cube(1), moved(synthetic::make_cube(2), {4, -2, 10}));
  const MassProperties sum = mass_properties(pair);
  EXPECT_NEAR(sum.volume, 9, 1e-13);
  EXPECT_NEAR(norm(sum.center_of_mass - 8.0 / 9 * Vec3{4, -2, 10}), 0, 1e-14);
}

TEST(MassProperties, AFarOriginCostsNoDigitsButTheCoordinates) {
  const double far = 0x1p20;
  const MassProperties cube = mass_properties(moved(synthetic::make_cube(1), {far, far, -far}));
  EXPECT_DOUBLE_EQ(cube.volume, 1);
  EXPECT_EQ(cube.center_of_mass, (Vec3{far, far, -far}));
}

TEST(MassProperties, ScaleByPowersOfTwoToTheBit) {
  const Solid torus = moved(synthetic::make_torus(0.3, 0.1, 20, 10), {0.1, 0.2, 0.3});
  const MassProperties plain = mass_properties(torus);
  for (const int power : {-40, -7, 13, 40}) {
    Solid scaled = torus;
    for (Vec3& p : scaled.vertices) p = std::ldexp(1.0, power) * p;
    const MassProperties other = mass_properties(scaled);
    EXPECT_EQ(other.volume, std::ldexp(plain.volume, 3 * power));
    EXPECT_EQ(other.center_of_mass, std::ldexp(1.0, power) * plain.center_of_mass);
  }
}

TEST(Reach, IsTheFarthestVertex) {
  EXPECT_DOUBLE_EQ(bounding_radius(synthetic::make_cube(2), {0, 0, 0}), std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(bounding_radius(synthetic::make_cube(2), {1, 1, 1}), std::sqrt(12.0));
}

}  // namespace
}  // namespace vpm::test
