// Promises of every packing, on random solids, checked by brute force.
#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packer.h"
#include "tests/packing/brute_force.h"
#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

class RandomSolids : public ::testing::TestWithParam<int> {};

constexpr std::uint64_t kSeeds = 25;  // for each of the eight families: 200 solids
constexpr std::size_t kSpheres = 40;
constexpr double kPropertyRounding = 1e-13;  // for coordinates up to 5 and triangles up to 1:1000

TEST_P(RandomSolids, NothingOverlapsNorProtrudes) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SCOPED_TRACE(seed);
    const Solid solid = random_solid(GetParam(), seed);
    const PackResult result = pack(solid, {.spheres = kSpheres});
    ASSERT_EQ(result.spheres.size(), kSpheres);
    EXPECT_EQ(result.stop, StopReason::spheres);
    const Solid surface = enclosed_surface(solid);
    EXPECT_LE(worst_protrusion(surface, result.spheres), 0);
    EXPECT_LE(worst_overlap(result.spheres), 0);
    EXPECT_TRUE(
        std::is_sorted(result.spheres.begin(), result.spheres.end(),
                       [](const Sphere& a, const Sphere& b) { return a.radius > b.radius; }));
    const Certificate certificate = certify(solid, result.spheres);
    EXPECT_TRUE(certificate.holds);
    EXPECT_NEAR(certificate.max_protrusion, worst_protrusion(surface, result.spheres),
                kPropertyRounding);
    EXPECT_NEAR(certificate.max_overlap,
                std::max(worst_overlap(result.spheres), -certificate.tolerance), kPropertyRounding);
  }
}

TEST_P(RandomSolids, CentresAreLocalMaxima) {
  const Solid solid = random_solid(GetParam(), 7);
  const std::vector<Sphere> spheres = pack(solid, {.spheres = 30}).spheres;
  const Solid surface = enclosed_surface(solid);
  Random random(11);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    for (int k = 0; k < 40; ++k) {
      const double step = spheres[i].radius * std::pow(10, random.uniform(-5, -2));
      const Vec3 beside =
          spheres[i].center + step * normalized_or_zero(random.in_box({-1, -1, -1}, {1, 1, 1}));
      EXPECT_LE(separation(surface, spheres, beside, i), spheres[i].radius * (1 + 1e-8));
    }
  }
}

TEST_P(RandomSolids, NoRoomIsLeftForALargerSphere) {
  const Solid solid = random_solid(GetParam(), 3);
  const std::vector<Sphere> spheres = pack(solid, {.spheres = 100}).spheres;
  Vec3 low = solid.vertices[0], high = low;
  for (const Vec3 p : solid.vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Solid surface = enclosed_surface(solid);
  Random random(5);
  for (int k = 0; k < 4000; ++k) {
    const Vec3 x = random.in_box(low, high);
    EXPECT_LE(separation(surface, spheres, x, spheres.size()), 1.05 * spheres.back().radius);
  }
}

// Checks the given mesh itself, so that nothing depends on how its inner parts were found.
TEST_P(RandomSolids, EveryPointOfASphereIsEnclosed) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    const Solid solid = random_solid(GetParam(), seed);
    Random random(seed);
    for (const Sphere& s : pack(solid, {.spheres = 20}).spheres) {
      for (int k = 0; k < 40; ++k) {
        const Vec3 away = normalized_or_zero(random.in_box({-1, -1, -1}, {1, 1, 1}));
        EXPECT_TRUE(encloses(solid, s.center + (1 - 1e-6) * s.radius * away));
      }
    }
  }
}

std::string family_name(const ::testing::TestParamInfo<int>& family) {
  constexpr std::array kNames{"Union", "Plate",         "Needle",       "Cavity",
                              "Torus", "TwoComponents", "NestedShells", "HigherGenus"};
  return kNames.at(static_cast<std::size_t>(family.param));
}
INSTANTIATE_TEST_SUITE_P(Families, RandomSolids, ::testing::Range(0, kFamilies), family_name);

}  // namespace
}  // namespace vpm::test
