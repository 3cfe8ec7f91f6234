// Meshes of bodies that overlap, touch or lie in each other are packed as their union.
#include <gtest/gtest.h>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/grow.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/validation.h"
#include "tests/packing/brute_force.h"
#include "tests/packing/test_solids.h"

namespace vpm::test {
namespace {

using synthetic::make_box;
using synthetic::make_cube;
using synthetic::make_icosphere;

// Returns the coverage of the bodies' packing, certified and counted on voxels too.
double covered(const Solid& solid, std::size_t spheres) {
  const PackResult result = pack(solid, {.spheres = spheres});
  EXPECT_TRUE(certify(solid, result.spheres).holds);
  const Validation counted = validate_packing(solid, result.spheres, 64);
  EXPECT_LE(counted.max_protrusion, 0);
  EXPECT_LE(counted.max_overlap, 0);
  return result.coverage;
}

double largest_radius(const Solid& solid) {
  return pack(solid, {.spheres = 1}).spheres.at(0).radius;
}

TEST(OverlappingBodies, CoverAsMuchAsTheirUnionMadeByHand) {
  const Solid box = make_box(3, 2, 2);
  const Solid two = joined(shifted(make_cube(2), {-.5, 0, 0}), shifted(make_cube(2), {.5, 0, 0}));
  const Solid three = joined(two, make_box(1, 1.5, 2));
  for (const std::size_t spheres : {20, 300}) {
    const double clean = covered(box, spheres);
    EXPECT_NEAR(covered(two, spheres), clean, .004) << spheres;
    EXPECT_NEAR(covered(three, spheres), clean, .004) << spheres;
  }
}

TEST(OverlappingBodies, CoverAsMuchAsTheirUnionMadeOfVoxels) {
  Random random(3);
  const Solid ball = make_icosphere(1, 3);
  for (int k = 0; k < 2; ++k) {
    const Solid pair = joined(moved(ball, random.rotation(), {}),
                              moved(k == 1 ? make_box(2, 1, .5) : ball, random.rotation(),
                                    {random.uniform(.3, 1), random.uniform(-.4, .4), .1}));
    const Solid clean = make_solid(raw(pair), {.repair = Repair::voxel, .repair_voxels = 64}).solid;
    EXPECT_NEAR(covered(pair, 100), covered(clean, 100), .015) << k;
  }
}

TEST(OverlappingBodies, HoldTheLargestBallOfTheirUnion) {
  const Rotation turn = Random(8).rotation();
  const Vec3 away{5, -7, 3};
  const auto radius = [&](const Solid& solid) {
    const double straight = largest_radius(solid);
    EXPECT_NEAR(largest_radius(moved(solid, turn, away)), straight, 1e-9);
    return straight;
  };
  const Solid half = make_box(1, 2, 2);
  const auto halves = [&](double apart) {
    return joined(shifted(half, {-.5 * (1 + apart), 0, 0}),
                  shifted(half, {.5 * (1 + apart), 0, 0}));
  };
  EXPECT_NEAR(radius(halves(0)), 1, 1e-9);      // face to face
  EXPECT_NEAR(radius(halves(-.3)), .85, 1e-9);  // overlapping, 1.7 wide together
  EXPECT_NEAR(radius(halves(1e-3)), .5, 1e-9);  // with a gap, which is outside
  EXPECT_NEAR(radius(joined(make_cube(2), make_cube(2))), 1, 1e-9);
  const Solid inner = joined(make_cube(1), shifted(make_icosphere(.5, 2), {.3, .2, .1}));
  EXPECT_NEAR(radius(joined(make_cube(2), inner)), 1, 1e-9);
  // The pocket removes its common part with the cube, which leaves 1.6 beside it.
  const Solid pocket = reversed(shifted(make_box(2, 4, 4), {1.6, 0, 0}));
  EXPECT_NEAR(radius(joined(make_cube(2), pocket)), .8, 1e-9);
}

// Computes the winding number of the mesh at points of the spheres, triangle by triangle.
void expect_enclosed(const Solid& solid, std::size_t spheres) {
  const PackResult result = pack(solid, {.spheres = spheres});
  EXPECT_TRUE(certify(solid, result.spheres).holds);
  Random random(1);
  for (const Sphere& s : result.spheres) {
    for (int k = 0; k < 30; ++k) {
      const Vec3 away = normalized_or_zero(random.in_box({-1, -1, -1}, {1, 1, 1}));
      EXPECT_TRUE(encloses(solid, s.center + (1 - 1e-6) * s.radius * away));
    }
  }
}

TEST(OverlappingBodies, OfAHeapAreEnclosed) {
  Random random(21);
  const auto place = [&] { return random.in_box({-1, -1, -1}, {1, 1, 1}); };
  Solid heap = make_cube(1);
  for (int k = 0; k < 20; ++k) {
    const Solid body = k % 2 == 0 ? make_box(.2, 1, .6) : make_icosphere(.4, 1);
    heap = joined(heap, moved(body, random.rotation(), place()));
  }
  expect_enclosed(heap, 60);
}

TEST(OverlappingBodies, WhoseFacesAreNearlyFlushAreEnclosed) {
  for (const double small : {1e-3, 1e-6, 1e-9, 1e-11, 1e-13, 1e-15, 0.0}) {
    SCOPED_TRACE(small);
    const Rotation turn = rotation_from_quaternion({small, 2 * small, -small, 1});
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 by{.4, sign * small, small};
      expect_enclosed(joined(make_cube(2), moved(make_cube(2), turn, by)), 15);
      expect_enclosed(joined(make_cube(2), moved(make_cube(1), turn, {1.5, by.y, by.z})), 15);
    }
  }
}

TEST(OverlappingBodies, GrowAcrossInnerTriangles) {
  const Solid two = joined(shifted(make_cube(2), {-.5, 0, 0}), shifted(make_cube(2), {.5, 0, 0}));
  const std::vector<Sphere> grown = grow(two, {{{.3, .1, -.2}, .1}}, {});
  EXPECT_TRUE(certify(two, grown).holds);
  EXPECT_NEAR(grown[0].radius, 1, 1e-3);
}

TEST(OverlappingBodies, InnerShellsThatCheckedSolidsDropChangeNothing) {
  const Solid nested = joined(make_cube(2), make_icosphere(.4, 2));
  const CheckedSolid checked = make_solid(raw(nested));
  EXPECT_EQ(checked.facts.inner_shells, 1u);
  EXPECT_FALSE(checked.enclosure.surface);
  EXPECT_NEAR(largest_radius(nested), 1, 1e-9);
}

TEST(OverlappingBodies, ACertificateStillFindsWhatProtrudes) {
  const Solid cross = joined(make_box(3, 1, 1), make_box(1, 3, 1));
  EXPECT_TRUE(certify(cross, {{{0, 0, 0}, .5}}).holds);
  EXPECT_TRUE(certify(cross, {{{.4, 0, 0}, .5}}).holds);  // crosses the other box's faces
  EXPECT_FALSE(certify(cross, {{{.4, .1, 0}, .5}}).holds);
  EXPECT_FALSE(certify(cross, {{{1, 1, 0}, .2}}).holds);
  const Certificate at_the_edge = certify(cross, {{{.6, .6, 0}, .2}});
  EXPECT_NEAR(at_the_edge.max_protrusion, .3, 1e-15);
}

}  // namespace
}  // namespace vpm::test
