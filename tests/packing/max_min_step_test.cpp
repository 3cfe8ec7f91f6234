#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/packing/linear_programme.h"
#include "test_solids.h"

namespace vpm::test {
namespace {

double smallest(const std::vector<LinearBound>& bounds, Vec3 delta) {
  double value = HUGE_VAL;
  for (const LinearBound& b : bounds) value = std::min(value, b.value + dot(b.gradient, delta));
  return value;
}

TEST(MaxMinStep, OneBoundGoesToTheCornerOfTheBox) {
  const MaxMinStep step = max_min_step({{{0.6, -0.8, 0}, 3}}, 0.5);
  EXPECT_DOUBLE_EQ(step.delta.x, 0.5);
  EXPECT_DOUBLE_EQ(step.delta.y, -0.5);
  EXPECT_DOUBLE_EQ(step.value, 3.7);
}

TEST(MaxMinStep, OpposedBoundsMeetHalfWay) {
  const MaxMinStep step = max_min_step({{{1, 0, 0}, 1}, {{-1, 0, 0}, 2}}, 10);
  EXPECT_DOUBLE_EQ(step.delta.x, 0.5);
  EXPECT_DOUBLE_EQ(step.value, 1.5);
}

TEST(MaxMinStep, NoPointOfTheBoxIsBetter) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    const double box = std::pow(10, random.uniform(-6, 2));
    std::vector<LinearBound> bounds;
    for (int i = 0; i < 1 + round % 20; ++i) {
      bounds.push_back({normalized_or_zero(random.in_box({-1, -1, -1}, {1, 1, 1})),
                        1 + box * random.uniform(0, 0.5)});
      if (round % 3 == 0) bounds.push_back(bounds.back());  // two triangles share an edge
    }
    const MaxMinStep step = max_min_step(bounds, box);
    EXPECT_LE(std::max({std::abs(step.delta.x), std::abs(step.delta.y), std::abs(step.delta.z)}),
              box);
    EXPECT_DOUBLE_EQ(step.value, smallest(bounds, step.delta));
    for (int k = 0; k < 200; ++k) {
      const Vec3 beside = random.in_box({-box, -box, -box}, {box, box, box});
      EXPECT_LE(smallest(bounds, beside), step.value + 1e-11 * box + 1e-15);
      // A concave function that falls towards every point falls in the neighbourhood.
      const Vec3 near = step.delta + 1e-4 * (beside - step.delta);
      EXPECT_LE(smallest(bounds, near), step.value + 1e-11 * box + 1e-15);
    }
  }
}

}  // namespace
}  // namespace vpm::test
