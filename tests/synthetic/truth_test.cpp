#include "libvpm/synthetic/truth.h"

#include <gtest/gtest.h>

#include "libvpm/core/parallel.h"
#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/test_name.h"

namespace vpm::synthetic {
namespace {

constexpr double kTolerance = 1e-5;  // fraction of the solid's volume that the benchmarks rely on

const Rotation kTurned = rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});

// Counts small cubes of a box with edge lengths `size`; shares nothing with the cubature.
Penetration count_voxels(Vec3 size, const Pose& pose, const Surface& surface, int steps) {
  Penetration sum;
  const double voxel = size.x * size.y * size.z / (double(steps) * steps * steps);
  const auto at = [&](int k, double length) { return ((k + 0.5) / steps - 0.5) * length; };
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      for (int k = 0; k < steps; ++k) {
        const Vec3 x = pose * Vec3{at(i, size.x), at(j, size.y), at(k, size.z)};
        if (surface.distance(x) >= 0) continue;
        const Vec3 g = surface.gradient(x);
        sum.volume += voxel;
        sum.force += voxel * g;
        sum.torque += voxel * cross(x - pose.translation, g);
      }
    }
  }
  return sum;
}

void expect_near(const Penetration& is, const Penetration& should, double volume, double reach) {
  EXPECT_NEAR(is.volume, should.volume, volume);
  EXPECT_NEAR(norm(is.force - should.force), 0, volume);
  EXPECT_NEAR(norm(is.torque - should.torque), 0, volume * reach);
}

class TruthTest : public testing::TestWithParam<std::string> {};

TEST_P(TruthTest, AgreesWithCountedVoxels) {
  const Vec3 size{0.2, 0.16, 0.12};
  const TrueSolid solid(make_box(size.x, size.y, size.z));
  const SurfacePtr surface = make_scene(GetParam()).surface;
  for (const double z : {0.92, 0.97, 1.02}) {
    const Pose pose{kTurned, {0.013, -0.008, z}};
    const Penetration truth = solid.penetration(pose, *surface);
    EXPECT_LE(truth.error, kTolerance * solid.mass().volume);
    expect_near(truth, count_voxels(size, pose, *surface, 120), 1e-3 * solid.mass().volume,
                solid.radius());
  }
}

// Compares the reported bound with a far finer computation.
TEST_P(TruthTest, KeepsItsErrorBound) {
  const SurfacePtr surface = make_scene(GetParam()).surface;
  for (const Solid& shape : {make_octahedron(0.2), make_torus(0.07, 0.03, 48, 24)}) {
    const TrueSolid solid(shape);
    for (const double z : {0.9, 0.96, 1.0}) {
      const Pose pose{kTurned, {0.011, 0.007, z}};
      const Penetration truth = solid.penetration(pose, *surface);
      const Penetration fine = solid.penetration(pose, *surface, 1e-8);
      EXPECT_LE(truth.error, kTolerance * solid.mass().volume);
      expect_near(truth, fine, truth.error + fine.error + 1e-12 * solid.mass().volume,
                  2 * solid.radius());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, TruthTest, testing::ValuesIn(scene_names()),
                         [](const auto& scene) { return test::test_name(scene.param); });

TEST(Truth, CubeIntoAWallIsASlab) {
  const TrueSolid cube(make_cube(0.2));
  const SurfacePtr wall = make_scene("wall").surface;
  for (const double deep : {1e-4, 0.05, 0.17}) {
    const Penetration truth = cube.penetration({{}, {0, 0, 0.9 + deep}}, *wall);
    const double volume = 0.04 * deep;
    expect_near(truth, {volume, {0, 0, -volume}, {}, 0}, 1e-12, 0.2);
  }
}

TEST(Truth, CornerIntoAWallIsAPyramid) {
  const TrueSolid octahedron(make_octahedron(0.2));
  const double corner = 0.2 / std::sqrt(2.0), deep = 0.06;
  const Penetration truth =
      octahedron.penetration({{}, {0, 0, 1 - corner + deep}}, *make_scene("wall").surface);
  const double volume = 2 * deep * deep * deep / 3;
  const double tolerance = kTolerance * octahedron.mass().volume;
  expect_near(truth, {volume, {0, 0, -volume}, {}, 0}, tolerance, 0.2);
}

TEST(Truth, SmallestContactIsNotMissed) {
  const TrueSolid octahedron(make_octahedron(0.2));
  const double corner = 0.2 / std::sqrt(2.0), deep = 0.004;
  const Penetration truth =
      octahedron.penetration({{}, {0, 0, 1 - corner + deep}}, *make_scene("wall").surface);
  EXPECT_GT(truth.volume, 0);
}

TEST(Truth, DeepInsideIsTheWholeSolid) {
  const TrueSolid torus(make_twisted_torus(0.06, 0.03, 2, 48));
  const Penetration truth = torus.penetration({kTurned, {0, 0, 1.3}}, *make_scene("wall").surface);
  const double volume = torus.mass().volume;
  expect_near(truth, {volume, {0, 0, -volume}, {}, 0}, 1e-6 * volume, torus.radius());
}

TEST(Truth, ClearOfTheSurfaceIsZero) {
  const TrueSolid cube(make_cube(0.2));
  const Penetration truth = cube.penetration({{}, {0, 0, 0.85}}, *make_scene("ball").surface);
  expect_near(truth, {}, 1e-15, 1);
}

// Turning and moving the tool works against force and torque. The energy is the integral of the
// depth, here by counting.
TEST(Truth, ForceAndTorqueAreTheSlopeOfTheEnergy) {
  const Vec3 size{0.2, 0.16, 0.12};
  const TrueSolid solid(make_box(size.x, size.y, size.z));
  const SurfacePtr surface = make_scene("inverted-ball").surface;
  const Pose pose{kTurned, {0.01, 0.02, 0.95}};
  const Penetration truth = solid.penetration(pose, *surface);
  constexpr int kSteps = 100;
  const auto energy = [&](const Pose& at) {
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
      for (int j = 0; j < kSteps; ++j)
        for (int k = 0; k < kSteps; ++k) {
          const Vec3 x =
              at * Vec3{((i + 0.5) / kSteps - 0.5) * size.x, ((j + 0.5) / kSteps - 0.5) * size.y,
                        ((k + 0.5) / kSteps - 0.5) * size.z};
          sum += std::max(-surface->distance(x), 0.0);
        }
    return sum * size.x * size.y * size.z / (double{kSteps} * kSteps * kSteps);
  };
  constexpr double kMove = 1e-3, kTurn = 1e-2;
  Pose moved = pose, back = pose;
  moved.translation.z += kMove;
  back.translation.z -= kMove;
  const double force = -(energy(moved) - energy(back)) / (2 * kMove);
  EXPECT_NEAR(force, truth.force.z, 1e-3 * solid.mass().volume);
  const Rotation turn = rotation_from_quaternion({std::sin(kTurn / 2), 0, 0, std::cos(kTurn / 2)});
  moved = {turn * pose.rotation, pose.translation};
  back = {transpose(turn) * pose.rotation, pose.translation};
  const double torque = -(energy(moved) - energy(back)) / (2 * kTurn);
  EXPECT_NEAR(torque, truth.torque.x, 1e-3 * solid.mass().volume * solid.radius());
}

TEST(Truth, IsTheSameForAnyThreadCount) {
  const TrueSolid torus(make_torus(0.07, 0.03, 48, 24));
  const Scene scene = make_scene("groove");
  const Pose pose{kTurned, {0.01, 0, 0.96}};
  set_thread_count(1);
  const Penetration one = torus.penetration(pose, *scene.surface);
  set_thread_count(8);
  const Penetration eight = torus.penetration(pose, *scene.surface);
  set_thread_count(0);
  EXPECT_EQ(one.volume, eight.volume);
  EXPECT_EQ(one.force, eight.force);
  EXPECT_EQ(one.torque, eight.torque);
}

}  // namespace
}  // namespace vpm::synthetic
