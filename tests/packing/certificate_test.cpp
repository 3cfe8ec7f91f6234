#include "libvpm/packing/certificate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/packing/brute_force.h"
#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

const Solid kCube = synthetic::make_cube(2);

TEST(Certificate, TouchingIsAllowed) {
  const Certificate c = certify(kCube, {{{-.5, 0, 0}, .5}, {{.5, 0, 0}, .5}});
  EXPECT_TRUE(c.holds);
  EXPECT_NEAR(c.max_protrusion, 0, 1e-15);
  EXPECT_NEAR(c.max_overlap, 0, 1e-15);
}

TEST(Certificate, MeasuresOverlap) {
  const Certificate c = certify(kCube, {{{-.5, 0, 0}, .5}, {{.25, 0, 0}, .375}});
  EXPECT_FALSE(c.holds);
  EXPECT_DOUBLE_EQ(c.max_overlap, .125);
}

TEST(Certificate, MeasuresProtrusion) {
  const Certificate c = certify(kCube, {{{0, 0, .75}, .5}});
  EXPECT_FALSE(c.holds);
  EXPECT_DOUBLE_EQ(c.max_protrusion, .25);
}

TEST(Certificate, CentreOutsideIsProtrusion) {
  const Certificate c = certify(kCube, {{{0, 0, 1.5}, .25}});
  EXPECT_FALSE(c.holds);
  EXPECT_DOUBLE_EQ(c.max_protrusion, .75);
  // The cavity of a shell is far enough from the mesh, but not in the solid.
  const Solid shell = joined(kCube, reversed(synthetic::make_cube(1)));
  EXPECT_FALSE(certify(shell, {{{0, 0, 0}, .1}}).holds);
  EXPECT_TRUE(certify(shell, {{{.75, 0, 0}, .25}}).holds);
}

TEST(Certificate, ToleranceIsABillionthOfTheSolid) {
  EXPECT_DOUBLE_EQ(certify(kCube, {}).tolerance, 2e-9);
  EXPECT_TRUE(certify(kCube, {{{0, 0, 0}, 1 + 1e-9}}).holds);
  EXPECT_FALSE(certify(kCube, {{{0, 0, 0}, 1 + 1e-8}}).holds);
  EXPECT_TRUE(certify(kCube, {}).holds);
}

TEST(Certificate, ValuesAreFiniteWithoutNeighbours) {
  EXPECT_DOUBLE_EQ(certify(kCube, {}).max_protrusion, -2e-9);
  EXPECT_DOUBLE_EQ(certify(kCube, {{{0, 0, 0}, .1}}).max_overlap, -2e-9);
  EXPECT_DOUBLE_EQ(certify(kCube, {{{.5, 0, 0}, .1}, {{-.5, 0, 0}, .1}}).max_overlap, -2e-9);
}

TEST(Certificate, SpheresThatAreNoneFail) {
  for (const double radius : {0.0, -0.1, std::nan(""), HUGE_VAL})
    EXPECT_FALSE(certify(kCube, {{{0, 0, 0}, radius}}).holds) << radius;
  EXPECT_FALSE(certify(kCube, {{{std::nan(""), 0, 0}, .1}}).holds);
}

TEST(Certificate, FindsEveryOverlapThatBruteForceFinds) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    std::vector<Sphere> spheres;
    for (int i = 0; i < 200; ++i)
      spheres.push_back({random.in_box({-1, -1, -1}, {1, 1, 1}), random.uniform(1e-4, 0.05)});
    EXPECT_NEAR(certify(kCube, spheres).max_overlap, std::max(worst_overlap(spheres), -2e-9),
                1e-15);
    EXPECT_NEAR(certify(kCube, spheres).max_protrusion, worst_protrusion(kCube, spheres), 1e-15);
  }
}

}  // namespace
}  // namespace vpm::test
