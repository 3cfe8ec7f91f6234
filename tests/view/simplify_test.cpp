#include "libvpm/view/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/synthetic/shapes.h"

namespace vpm::view {
namespace {

TEST(Simplify, SmallMeshesStayAsTheyAre) {
  const Solid ball = synthetic::make_icosphere(1, 2);
  const Solid same = simplified(ball, ball.triangles.size());
  EXPECT_EQ(same.vertices, ball.vertices);
  EXPECT_EQ(same.triangles, ball.triangles);
}

TEST(Simplify, LargeMeshesKeepTheirShape) {
  const Solid ball = synthetic::make_icosphere(2, 6);
  for (const std::size_t most : {40'000U, 5'000U, 500U}) {
    const Solid simple = simplified(ball, most);
    EXPECT_LE(simple.triangles.size(), most);
    EXPECT_GE(simple.triangles.size(), most / 8);
    const double cell = 4 / std::sqrt(static_cast<double>(most) / 8);
    for (const Vec3& p : simple.vertices) EXPECT_NEAR(norm(p), 2, cell);
    for (const Triangle& t : simple.triangles)
      EXPECT_LT(std::ranges::max(t), simple.vertices.size());
    EXPECT_NEAR(mass_properties(simple).volume, mass_properties(ball).volume,
                0.15 * mass_properties(ball).volume);
  }
}

}  // namespace
}  // namespace vpm::view
