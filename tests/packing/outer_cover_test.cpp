#include "libvpm/packing/outer_cover.h"

#include <gtest/gtest.h>
#include <vpm/device.h>

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/packing/test_solids.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

constexpr double kPiOver6 = kPi / 6;

bool is_covered(Vec3 p, const std::vector<Sphere>& spheres) {
  return std::ranges::any_of(spheres,
                             [&](const Sphere& s) { return norm(p - s.center) <= s.radius; });
}

// Returns how many of many places in the solid lie in no sphere: random ones, and the vertices and
// points of the surface, which spheres leave out first.
std::size_t uncovered(const Solid& solid, const std::vector<Sphere>& spheres, std::uint64_t seed) {
  const TriangleBvh bvh(solid.vertices, solid.triangles);
  const WindingNumber winding(bvh);
  test::Random random(seed);
  Vec3 low = solid.vertices.front(), high = low;
  for (const Vec3& p : solid.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  std::size_t outside = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 p = random.in_box(low, high);
    if (!is_covered(p, spheres) && winding.inside(p)) ++outside;
  }
  for (const auto& [a, b, c] : solid.triangles)
    for (int k = 0; k < 20; ++k) {
      const double u = k == 0 ? 0 : random.uniform(0, 1), v = random.uniform(0, 1 - u);
      const Vec3 from = solid.vertices[a];
      const Vec3 p = from + u * (solid.vertices[b] - from) + v * (solid.vertices[c] - from);
      if (!is_covered(p, spheres)) ++outside;
    }
  return outside;
}

class Families : public testing::TestWithParam<int> {};

TEST_P(Families, EveryPointLiesInOneOfExactlySoManySpheres) {
  const int family = GetParam();
  const Solid solid = test::random_solid(family, 5);
  const std::size_t count = family % 3 == 0 ? 1 : family % 3 == 1 ? 13 : 60;
  const std::vector<Sphere> spheres = cover(solid, count);
  EXPECT_EQ(spheres.size(), count);
  EXPECT_TRUE(std::ranges::is_sorted(spheres, largest_first));
  const CoverCertificate certificate = certify_cover(solid, spheres);
  EXPECT_TRUE(certificate.holds);
  EXPECT_EQ(uncovered(solid, spheres, 3), 0U);
}

// Spheres that lie inside of a solid leave its corners out. Their certificate must not hold, and
// must name a place that they leave out.
TEST_P(Families, SpheresInsideHaveNoCertificate) {
  const Solid solid = test::random_solid(GetParam(), 5);
  const std::vector<Sphere> spheres = pack(solid, {.spheres = 20}).spheres;
  const CoverCertificate certificate = certify_cover(solid, spheres);
  EXPECT_FALSE(certificate.holds);
  EXPECT_FALSE(is_covered(certificate.open, spheres) &&
               std::ranges::all_of(spheres, [&](const Sphere& s) {
                 return norm(certificate.open - s.center) < 0.9 * s.radius;
               }));
}

INSTANTIATE_TEST_SUITE_P(OuterCover, Families, testing::Range(0, test::kFamilies));

TEST(OuterCover, ACubeTakesTheSpheresThatGeometryAllows) {
  const Solid cube = synthetic::make_cube(1);
  for (const auto& [count, part] : {std::pair{1, 1}, {8, 2}}) {
    const std::vector<Sphere> spheres = cover(cube, static_cast<std::size_t>(count));
    for (const Sphere& s : spheres) {
      EXPECT_GE(s.radius, std::sqrt(3) / 2 / part);
      EXPECT_LE(s.radius, 1.002 * std::sqrt(3) / 2 / part);
    }
  }
}

TEST(OuterCover, ACertificateIsLostWithAMillionthOfAnyTightSphere) {
  const Solid cube = synthetic::make_cube(1);
  std::vector<Sphere> spheres;
  for (const double x : {-.25, .25})
    for (const double y : {-.25, .25})
      for (const double z : {-.25, .25}) spheres.push_back({{x, y, z}, std::sqrt(3) / 4 + 1e-8});
  EXPECT_TRUE(certify_cover(cube, spheres).holds);
  for (Sphere& s : spheres) {
    const double radius = std::exchange(s.radius, (1 - 1e-6) * s.radius);
    const CoverCertificate certificate = certify_cover(cube, spheres);
    EXPECT_FALSE(certificate.holds);
    EXPECT_LE(norm(certificate.open - s.center), 0.44);
    s.radius = radius;
  }
}

TEST(OuterCover, FarFromTheOriginAndInAnyUnitTheProofHolds) {
  for (const double scale : {1e-6, 1e6})
    for (const Vec3 shift : {Vec3{}, Vec3{1000, -2000, 500}}) {
      Solid ball = synthetic::make_icosphere(0.5, 2);
      for (Vec3& p : ball.vertices) p = scale * (p + shift);
      EXPECT_TRUE(certify_cover(ball, cover(ball, 5)).holds) << scale << " " << shift.x;
    }
}

TEST(OuterCover, ThreadsChangeNoBit) {
  const Solid solid = test::random_solid(4, 2);
  set_thread_count(1);
  const std::vector<Sphere> alone = cover(solid, 30);
  set_thread_count(3);
  EXPECT_EQ(cover(solid, 30), alone);
  set_thread_count(0);
}

TEST(OuterCover, SharesAreThoseOfGeometry) {
  const Solid cube = synthetic::make_cube(1);
  const CoverShares within = cover_shares(cube, {{{}, 0.5}});
  EXPECT_NEAR(within.covered, kPiOver6, 1e-4);
  EXPECT_NEAR(within.protruding, 0, 1e-4);
  const double radius = std::sqrt(3) / 2;
  const CoverShares about = cover_shares(cube, {{{}, radius}, {{}, 0.3}});
  EXPECT_NEAR(about.covered, 1, 1e-4);
  EXPECT_NEAR(about.protruding, 4. / 3 * kPi * radius * radius * radius - 1, 1e-3);
  // Two balls have their middles on opposite faces of the cube: half of each lies in it.
  const CoverShares halves = cover_shares(cube, {{{0.5, 0, 0}, 0.4}, {{-0.5, 0, 0}, 0.4}});
  EXPECT_NEAR(halves.covered, 8 * kPiOver6 * 0.064, 1e-4);
  EXPECT_NEAR(halves.protruding, halves.covered, 1e-4);
}

TEST(OuterCover, WhatHasNoVolumeIsRefused) {
  Solid flat = synthetic::make_cube(1);
  for (Vec3& p : flat.vertices) p.z = 0;
  EXPECT_EQ(test::kind_of_fault([&] { cover(flat, 3); }), ErrorKind::refused);
}

}  // namespace
}  // namespace vpm
