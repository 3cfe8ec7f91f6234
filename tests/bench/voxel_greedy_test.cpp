#include "tools/bench/voxel_greedy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/packing/certificate.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm::bench {
namespace {

double coverage(const Solid& solid, const std::vector<Sphere>& spheres) {
  double sum = 0;
  for (const Sphere& s : spheres) sum += volume(s);
  return sum / mass_properties(solid).volume;
}

TEST(VoxelGreedy, GivesPackings) {
  for (const Solid& solid : {synthetic::make_cube(1), synthetic::make_tetrahedron(2),
                             synthetic::make_torus(1, 0.3, 48, 24)}) {
    const auto centres = VoxelGreedy(solid, 32).pack(100, Refine::none);
    const auto refined = VoxelGreedy(solid, 32).pack(100, Refine::local_maximum);
    ASSERT_EQ(centres.size(), 100u);
    ASSERT_EQ(refined.size(), 100u);
    EXPECT_TRUE(certify(solid, centres).holds);
    EXPECT_TRUE(certify(solid, refined).holds);
    EXPECT_GT(coverage(solid, refined), coverage(solid, centres));
  }
}

TEST(VoxelGreedy, RefinedFirstSphereIsTheInsphere) {
  const auto spheres =
      VoxelGreedy(synthetic::make_octahedron(1), 20).pack(1, Refine::local_maximum);
  EXPECT_NEAR(spheres.at(0).radius, std::sqrt(6.0) / 6, 1e-6);
}

TEST(VoxelGreedy, EndsWhereNoVoxelHasRoom) {
  const auto spheres = VoxelGreedy(synthetic::make_cube(1), 8).pack(1000000, Refine::none);
  EXPECT_LT(spheres.size(), 1000u);
  EXPECT_TRUE(certify(synthetic::make_cube(1), spheres).holds);
}

}  // namespace
}  // namespace vpm::bench
