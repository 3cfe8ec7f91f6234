#include "libvpm/packing/grow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/file/stream.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/packer.h"
#include "tests/packing/brute_force.h"
#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

double filled(const std::vector<Sphere>& spheres) {
  double sum = 0;
  for (const Sphere& s : spheres) sum += volume(s);
  return sum;
}

void expect_packing(const Solid& solid, const std::vector<Sphere>& spheres) {
  EXPECT_LE(worst_protrusion(enclosed_surface(solid), spheres), 0);
  EXPECT_LE(worst_overlap(spheres), 0);
  EXPECT_TRUE(std::is_sorted(spheres.begin(), spheres.end(), largest_first));
}

TEST(Grow, OneSphereBecomesTheInsphere) {
  const std::vector<Sphere> grown = grow(synthetic::make_cube(2), {{{.4, -.3, .5}, .1}}, {});
  ASSERT_EQ(grown.size(), 1u);
  EXPECT_NEAR(grown[0].radius, 1, 1e-4);
}

TEST(Grow, TwoSpheresShareABox) {
  const Solid box = synthetic::make_box(2, 1, 1);
  const std::vector<Sphere> grown = grow(box, {{{-.2, .1, 0}, .1}, {{.3, 0, .2}, .1}}, {});
  EXPECT_NEAR(filled(grown), kPi / 3, 1e-3);  // two balls of diameter 1 leave no room to grow
  expect_packing(box, grown);
}

TEST(Grow, EveryStateIsAPackingAndGains) {
  for (int family = 0; family < kFamilies; ++family) {
    SCOPED_TRACE(family);
    const Solid solid = random_solid(family, 12);
    const std::vector<Sphere> greedy = pack(solid, {.spheres = 30}).spheres;
    double before = filled(greedy);
    for (const int steps : {1, 2, 3, 5, 100}) {
      SCOPED_TRACE(steps);
      const std::vector<Sphere> grown = grow(solid, greedy, {.steps = steps});
      ASSERT_EQ(grown.size(), greedy.size());
      expect_packing(solid, grown);
      EXPECT_GE(filled(grown), before);
      before = filled(grown);
    }
  }
}

TEST(Grow, GroupsOfManySpheresStayApart) {
  const Solid solid = random_solid(0, 4);
  const std::vector<Sphere> greedy = pack(solid, {.spheres = 3 * kGrownTogether}).spheres;
  const std::vector<Sphere> grown = grow(solid, greedy, {.steps = 4});
  expect_packing(solid, grown);
  EXPECT_GT(filled(grown), filled(greedy));
}

TEST(Grow, GivesBackWhatCannotGrow) {
  const Solid cube = synthetic::make_cube(1);
  const std::vector<Sphere> greedy = pack(cube, {.spheres = 1}).spheres;
  EXPECT_TRUE(same_bytes(grow(cube, greedy, {}), greedy));
  EXPECT_TRUE(grow(cube, {}, {}).empty());
}

TEST(Grow, KeepsTheLimitsOfRadii) {
  const Solid solid = random_solid(0, 5);
  const PackResult greedy = pack(solid, {.spheres = 60, .min_radius = .04, .max_radius = .2});
  const std::vector<Sphere> grown =
      grow(solid, greedy.spheres, {.min_radius = .04, .max_radius = .2});
  EXPECT_GT(filled(grown), filled(greedy.spheres));
  EXPECT_LE(grown.front().radius, .2);
  EXPECT_GE(grown.back().radius, .04 * (1 - 1e-9));
  expect_packing(solid, grown);
}

TEST(Grow, SameBytesForEveryThreadCountAndPowerOfTwo) {
  const Solid solid = random_solid(4, 1);
  const std::vector<Sphere> greedy = pack(solid, {.spheres = 300}).spheres;
  set_thread_count(1);
  const std::vector<Sphere> one = grow(solid, greedy, {.steps = 5});
  set_thread_count(8);
  EXPECT_TRUE(same_bytes(one, grow(solid, greedy, {.steps = 5})));
  set_thread_count(0);
  for (const int k : {-40, 40}) {
    const auto scaled = [&](std::vector<Sphere> spheres) {
      for (Sphere& s : spheres) s = {std::ldexp(1.0, k) * s.center, std::ldexp(s.radius, k)};
      return spheres;
    };
    Solid larger = solid;
    for (Vec3& p : larger.vertices) p = std::ldexp(1.0, k) * p;
    EXPECT_TRUE(same_bytes(grow(larger, scaled(greedy), {.steps = 5}), scaled(one))) << k;
  }
}

TEST(Grow, GainsOnRealMeshes) {
  const std::filesystem::path meshes = VPM_SOURCE_DIR "/../shared/data/meshes";
  if (!std::filesystem::exists(meshes)) GTEST_SKIP() << "no meshes";
  const struct {
    const char* file;
    std::size_t spheres;
    double gain;
  } cases[] = {{"bunny.off", 10, .004}, {"bunny.off", 100, .004}, {"knot.ply", 100, .004}};
  for (const auto& c : cases) {
    const std::string path = meshes / c.file;
    const Solid solid = make_solid(parse_mesh(file::read_all(path), path), {}).solid;
    const PackResult greedy = pack(solid, {.spheres = c.spheres});
    const double grown = filled(grow(solid, greedy.spheres, {})) / mass_properties(solid).volume;
    EXPECT_GE(grown, greedy.coverage + c.gain) << c.file << " " << c.spheres;
  }
}

// A tube holds equal balls, and small ones in the wedges between them. Growing shrinks some small
// ones, and there is more room elsewhere.
TEST(Grow, MovesTheSmallestToWhereThereIsRoom) {
  const Solid knot = synthetic::make_torus_knot(2, 3, 1, 0.5, 0.177, 240, 24);
  const double all = mass_properties(knot).volume;
  const PackResult greedy = pack(knot, {.spheres = 100});
  const std::vector<Sphere> grown = grow(knot, greedy.spheres, {});
  expect_packing(knot, grown);
  EXPECT_GE(filled(grown) / all, greedy.coverage + .004);
  EXPECT_GT(greedy.coverage_bound, filled(grown) / all);
  // Ten of the largest balls cannot gain.
  const PackResult ten = pack(knot, {.spheres = 10});
  EXPECT_GT(ten.coverage, .999 * ten.coverage_bound);
  EXPECT_LE(filled(grow(knot, ten.spheres, {})) / all, ten.coverage_bound * (1 + 1e-9));
}

TEST(Grow, RefusesLimitsThatAreNoNumbers) {
  const Solid cube = synthetic::make_cube(1);
  EXPECT_THROW(grow(cube, {}, {.min_radius = std::nan("")}), Error);
  EXPECT_THROW(grow(cube, {}, {.max_radius = 0}), Error);
}

}  // namespace
}  // namespace vpm::test
