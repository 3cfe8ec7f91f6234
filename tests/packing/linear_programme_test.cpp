#include "libvpm/packing/linear_programme.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

using Four = LinearProgramme::Four;
constexpr auto kNone = LinearProgramme::kNone;
constexpr double kGap = 1e-3, kLeast = 1e-6;  // promised accuracy of the gain and of its bound

double product(const Four& a, const Four& x) {
  return a[0] * x[0] + a[1] * x[1] + a[2] * x[2] + a[3] * x[3];
}

double gain(const LinearProgramme& p, const std::vector<Four>& x) {
  double sum = 0;
  for (std::size_t k = 0; k < x.size(); ++k) sum += product(p.gain[k], x[k]);
  return sum;
}

double worst_violation(const LinearProgramme& p, const std::vector<Four>& x) {
  double worst = 0;
  for (const auto& row : p.rows) {
    const double second = row.j == kNone ? 0 : product(row.b, x[row.j]);
    worst = std::max(worst, product(row.a, x[row.i]) + second - row.limit);
  }
  for (const Four& block : x)
    for (const double v : block) worst = std::max(worst, std::abs(v) - 1);
  return worst;
}

TEST(LinearProgramme, WithoutRowsEveryUnknownGoesToItsBound) {
  const LinearProgramme p{{{1, -2, 0.5, 0}, {0, 0, 3, -4}}, {}};
  EXPECT_NEAR(gain(p, solve(p)), 10.5, 10.5 * kGap);
  const LinearProgramme nothing{{{0, 0, 0, 0}}, {}};
  EXPECT_EQ(solve(nothing)[0], (Four{0, 0, 0, 0}));
}

TEST(LinearProgramme, NothingIsGainedWhereRowsForbidIt) {
  const LinearProgramme p{{{0, 0, 0, 1}, {0, 0, 0, 1}},
                          {{0, 1, {0, 0, 0, 1}, {0, 0, 0, 1}, 0}}};  // both blocks sum to at most 0
  const auto x = solve(p);
  EXPECT_NEAR(gain(p, x), 0, 2 * kLeast);
  EXPECT_LT(worst_violation(p, x), 1e-6);
}

TEST(LinearProgramme, RowsShareTheirLimitAmongBlocks) {
  // The second block gains twice as much from the limit that they share.
  const LinearProgramme p{{{1, 0, 0, 0}, {0, 2, 0, 0}}, {{1, 0, {0, 1, 0, 0}, {1, 0, 0, 0}, 0.25}}};
  const auto x = solve(p);
  EXPECT_NEAR(x[1][1], 1, 2 * kGap);
  EXPECT_NEAR(x[0][0], -0.75, 2 * kGap);
}

TEST(LinearProgramme, AgreesWithTheSimplexOfOneSphere) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    // Maximises s where s - g . delta <= v, by the simplex, and in a programme of many such blocks.
    LinearProgramme p;
    double expected = 0;
    const auto blocks = static_cast<std::uint32_t>(1 + round % 7);
    for (std::uint32_t i = 0; i < blocks; ++i) {
      p.gain.push_back({0, 0, 0, 1});
      std::vector<LinearBound> bounds;
      for (int k = 0; k < 3 + round % 11; ++k) {
        const Vec3 g = normalized_or_zero(random.in_box({-1, -1, -1}, {1, 1, 1}));
        const double v = random.uniform(0, 0.3);
        bounds.push_back({g, v});
        p.rows.push_back({i, kNone, {-g.x, -g.y, -g.z, 1}, {}, v});
      }
      expected += std::min(1.0, max_min_step(bounds, 1).value);
    }
    const auto x = solve(p);
    EXPECT_NEAR(gain(p, x), expected, 1.1 * (kGap * expected + kLeast * blocks)) << round;
    EXPECT_LT(worst_violation(p, x), 1e-6) << round;
  }
}

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
