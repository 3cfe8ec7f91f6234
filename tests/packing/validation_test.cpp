#include "libvpm/packing/validation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packer.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/packing/test_solids.h"

namespace vpm {
namespace {

using synthetic::make_box;
using synthetic::make_cube;
using synthetic::make_icosphere;

constexpr int kVoxels = 64;  // enough to test promises that hold for any number

void expect_clean(const Validation& v) {
  EXPECT_EQ(v.protruding_voxels, 0U);
  EXPECT_EQ(v.overlapping_voxels, 0U);
  EXPECT_EQ(v.max_protrusion, 0);
  EXPECT_EQ(v.max_overlap, 0);
}

TEST(Validation, CountsKnownVolumes) {
  for (const Solid& solid : {make_cube(2), make_box(1, 0.2, 0.05), make_icosphere(1, 3)}) {
    const double volume_mesh = mass_properties(solid).volume;
    const Validation v = validate_packing(solid, {}, kVoxels);
    EXPECT_NEAR(v.volume_mesh, volume_mesh, v.coverage_error * volume_mesh);
    EXPECT_EQ(v.coverage, 0);
    expect_clean(v);
  }
}

TEST(Validation, AgreesOnTheCoverageOfSoundPackings) {
  const std::vector<Sphere> spheres{{{0, 0, 0}, 1}, {{0.8, 0.8, 0.8}, 0.2}};
  const Validation v = validate_packing(make_cube(2), spheres, kVoxels);
  EXPECT_NEAR(v.coverage, (volume(spheres[0]) + volume(spheres[1])) / 8, v.coverage_error);
  EXPECT_LT(v.coverage_error, 0.01);
  expect_clean(v);
}

TEST(Validation, SeesProtrusions) {
  const double out = 0.2;
  const Validation v = validate_packing(make_cube(2), {{{0.5, 0, 0}, 0.5 + out}}, kVoxels);
  ASSERT_GT(out, v.detection_limit);
  EXPECT_GT(v.protruding_voxels, 0U);
  // Protrusion is measured up to the band of 3 voxels.
  EXPECT_GT(v.max_protrusion, std::min(out, 3 * v.voxel) - v.detection_limit);
  EXPECT_LE(v.max_protrusion, out);
}

TEST(Validation, SeesOverlaps) {
  const std::vector<Sphere> spheres{{{-0.4, 0, 0}, 0.5}, {{0.4, 0, 0}, 0.5}};
  const Validation v = validate_packing(make_cube(2), spheres, kVoxels);
  ASSERT_GT(0.2, v.detection_limit);
  EXPECT_GT(v.overlapping_voxels, 0U);
  EXPECT_NEAR(v.max_overlap, 0.2, 1e-12);
  // The union is counted, not the sum.
  EXPECT_LT(v.coverage + v.coverage_error, 2 * volume(spheres[0]) / 8);
}

TEST(Validation, ACavityIsOutside) {
  Solid hollow = make_cube(2);
  for (const Triangle& t : make_cube(1).triangles)
    hollow.triangles.push_back({t[0] + 8, t[2] + 8, t[1] + 8});
  for (const Vec3& p : make_cube(1).vertices) hollow.vertices.push_back(p);
  const Validation sound = validate_packing(hollow, {{{0.75, 0, 0}, 0.25}}, kVoxels);
  EXPECT_NEAR(sound.volume_mesh, 7, 7 * sound.coverage_error);
  expect_clean(sound);
  EXPECT_GT(validate_packing(hollow, {{{0, 0, 0}, 0.4}}, kVoxels).protruding_voxels, 0U);
}

TEST(Validation, AgreesWithTheCertificateWithinItsBound) {
  for (int family = 0; family < test::kFamilies; ++family) {
    SCOPED_TRACE(family);
    const Solid solid = test::random_solid(family, 1);
    std::vector<Sphere> spheres = pack(solid, {.spheres = 20}).spheres;
    const double volume_mesh = enclosed_mass(solid).volume;
    double filled = 0;
    for (const Sphere& s : spheres) filled += volume(s);
    ASSERT_TRUE(certify(solid, spheres).holds);
    const Validation sound = validate_packing(solid, spheres, kVoxels);
    EXPECT_NEAR(sound.coverage, filled / volume_mesh, sound.coverage_error);
    expect_clean(sound);

    // Both methods see protrusions beyond the stated limit.
    spheres[0].radius += 2 * sound.detection_limit;
    const Certificate broken = certify(solid, spheres);
    const Validation seen = validate_packing(solid, spheres, kVoxels);
    EXPECT_FALSE(broken.holds);
    EXPECT_GT(seen.protruding_voxels, 0U);
    // Distances of voxels are floats.
    EXPECT_LE(seen.max_protrusion, broken.max_protrusion + 1e-5);
    EXPECT_LE(seen.max_overlap, std::max(broken.max_overlap, 0.0) + 1e-12);
  }
}

// OpenVDB fills a slit that is narrower than three voxels; the stated bound includes that.
TEST(Validation, TheBoundHoldsWithNarrowGaps) {
  const double slit = 1.5 * 2.1 / kVoxels;
  const Solid halves = test::joined(test::moved(make_box(1, 2, 2), {}, {-0.5 - slit / 2, 0, 0}),
                                    test::moved(make_box(1, 2, 2), {}, {0.5 + slit / 2, 0, 0}));
  const std::vector<Sphere> spheres{{{-0.5 - slit / 2, 0, 0}, 0.5}, {{0.5 + slit / 2, 0, 0}, 0.5}};
  const double coverage = (volume(spheres[0]) + volume(spheres[1])) / 8;
  const Validation v = validate_packing(halves, spheres, kVoxels);
  EXPECT_NEAR(v.coverage, coverage, v.coverage_error);
  EXPECT_NEAR(v.volume_mesh, 8, 8 * v.coverage_error);
  EXPECT_GT(v.disputed_voxels, 0U);
  EXPECT_EQ(validate_packing(make_cube(2), {}, kVoxels).disputed_voxels, 0U);
}

TEST(Validation, TheBoundHoldsForFinePartsOnCoarseLattices) {
  const std::string path = std::string(VPM_SOURCE_DIR) + "/../shared/data/meshes/featuretype.STL";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "the shared data is not here";
  const Solid solid = make_solid(read_mesh(path)).solid;
  const PackResult result = pack(solid, {.spheres = 50});
  for (const int voxels : {24, 32, 48, 64}) {
    const Validation v = validate_packing(solid, result.spheres, voxels);
    EXPECT_NEAR(v.coverage, result.coverage, v.coverage_error) << voxels;
  }
}

TEST(Validation, DoesNotDependOnThreads) {
  const std::vector<Sphere> spheres{{{-0.4, 0, 0}, 0.5}, {{0.4, 0.1, 0}, 0.7}};
  set_thread_count(1);
  const Validation one = validate_packing(make_cube(2), spheres, kVoxels);
  set_thread_count(8);
  const Validation eight = validate_packing(make_cube(2), spheres, kVoxels);
  set_thread_count(0);
  EXPECT_EQ(one.coverage, eight.coverage);
  EXPECT_EQ(one.max_protrusion, eight.max_protrusion);
  EXPECT_EQ(one.protruding_voxels, eight.protruding_voxels);
  EXPECT_EQ(one.overlapping_voxels, eight.overlapping_voxels);
}

TEST(Validation, RefusesASolidWithoutExtent) {
  EXPECT_THROW(validate_packing({}, {}), Error);
  EXPECT_THROW(validate_packing({{{1, 1, 1}}, {}}, {}), Error);
}

}  // namespace
}  // namespace vpm
