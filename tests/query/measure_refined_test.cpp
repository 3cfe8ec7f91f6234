// Compares the refined measure with analytic truth, through all steps that a camera's cloud takes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/truth.h"
#include "tests/query/lattice_model.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;
using testing::see;

constexpr double kCubeEdge = 0.2;
constexpr double kDegrees = 1;         // bound of the force's direction
constexpr double kNotNearZero = 0.03;  // fraction of the tool's volume above which the bound holds

struct SceneCase {
  const char* scene;
  bool camera;
  double volume_bound;     // worst error, fraction of the tool's volume
  bool sees_whole_wrench;  // false where the riser is thinner than a pixel
};

class RefinedScene : public ::testing::TestWithParam<SceneCase> {};

TEST_P(RefinedScene, FollowsTheTruthAlongASweep) {
  const SceneCase& c = GetParam();
  const synthetic::Scene scene = synthetic::make_scene(c.scene);
  const Cloud seen = see(scene);
  const AnyBody cloud(c.camera ? seen : without_camera(seen));
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 4);
  const synthetic::TrueSolid solid(synthetic::make_cube(kCubeEdge));
  ToolQuery query(tool, {});
  double last_error = 0;
  for (int k = 0; k <= 24; ++k) {
    const Pose pose{generic_rotation(), {0.012, -0.007, 0.80 + 0.01 * k}};
    const synthetic::Penetration truth = solid.penetration(pose, *scene.surface);
    if (truth.volume > 0.6 * tool.volume) break;
    const Result r = query.run(cloud, pose);
    const double error = (r.volume - truth.volume) / tool.volume;
    EXPECT_LE(std::abs(error), c.volume_bound)
        << "pose " << k << ", truth " << truth.volume / tool.volume;
    EXPECT_LE(std::abs(error - last_error), 2 * c.volume_bound) << "jump at pose " << k;
    last_error = error;
    if (c.sees_whole_wrench && norm(truth.force) > kNotNearZero * tool.volume) {
      const double cosine =
          dot(r.wrench.force, truth.force) / (norm(r.wrench.force) * norm(truth.force));
      EXPECT_LE(std::acos(std::min(1.0, cosine)) * 180 / kPi, kDegrees) << "pose " << k;
      EXPECT_LE(norm(r.wrench.torque - truth.torque),
                0.01 * truth.volume * tool.radius + 1e-4 * tool.volume * tool.radius)
          << "pose " << k;
    }
    if (truth.volume == 0) {
      EXPECT_LE(r.volume, c.volume_bound * tool.volume);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, RefinedScene,
    ::testing::Values(
        SceneCase{"wall", true, 0.0005, true}, SceneCase{"tilted-wall", true, 0.0005, true},
        SceneCase{"inverted-ball", true, 0.001, true}, SceneCase{"ball", true, 0.001, true},
        SceneCase{"groove", true, 0.0015, true}, SceneCase{"step", true, 0.003, false},
        SceneCase{"wall", false, 0.0005, true}, SceneCase{"tilted-wall", false, 0.0005, true},
        SceneCase{"inverted-ball", false, 0.001, true}, SceneCase{"groove", false, 0.002, true}),
    [](const auto& variant) {
      return test::test_name(variant.param.scene) + (variant.param.camera ? "_camera" : "_points");
    });

// A block of a large cell is wider than the step is high.
TEST(RefinedMeasure, FewLargeCellsDoNotTakeAStepForAPlane) {
  const synthetic::Scene scene = synthetic::make_scene("step");
  const AnyBody cloud(see(scene));
  const ToolModel tool = lattice_cube(kCubeEdge, 2, 8);
  const synthetic::TrueSolid solid(synthetic::make_cube(kCubeEdge));
  ToolQuery query(tool, {});
  for (int k = 0; k < 40; ++k) {
    const Pose pose{generic_rotation(), {-0.07 + 0.004 * k, 0.01, 0.93 + 0.002 * (k % 7)}};
    const double truth = solid.penetration(pose, *scene.surface).volume;
    EXPECT_NEAR(query.run(cloud, pose).volume, truth, 0.01 * tool.volume) << k;
  }
}

// Along the rays the walls are half as far again. One cut cell's plane, a mean of both walls, must
// not decide for places near one of them.
TEST(RefinedMeasure, CountsWhatIsNoDeeperThanTheToolsReach) {
  const synthetic::Scene scene = synthetic::make_scene("groove");
  const AnyBody cloud(see(scene));
  const ToolModel tool = lattice_cube(0.1, 2, 8);
  const synthetic::TrueSolid solid(synthetic::make_cube(0.1));
  ToolQuery query(tool, {});
  int poses = 0;
  for (int k = 0; k < 10 * 14; ++k) {
    const int column = k % 10, row = k / 10;
    const Pose pose{generic_rotation(), {0.01 * column, 0.01, 0.96 + 0.01 * row}};
    const auto is_deep = [&](const CellSample& sample) {
      return scene.surface->distance(pose * widen(sample.center)) < -tool.radius;
    };
    const std::vector<CellSample>& samples = tool.levels[0].samples;
    if (std::any_of(samples.begin(), samples.end(), is_deep)) continue;
    const Result r = query.run(cloud, pose);
    if (r.boundary == 0) continue;
    ++poses;
    EXPECT_NEAR(r.volume, solid.penetration(pose, *scene.surface).volume, 0.001 * tool.volume) << k;
  }
  EXPECT_GT(poses, 10);
}

TEST(RefinedMeasure, NothingIsCountedBeforeContact) {
  const AnyBody cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kCubeEdge, 6, 2);
  const Result r = ToolQuery(tool, {}).run(cloud, {generic_rotation(), {0, 0, 0.8}});
  EXPECT_EQ(r.volume, 0);
  EXPECT_EQ(r.boundary + r.inside, 0u);
  EXPECT_EQ(norm(r.wrench.force), 0);
}

// A thousandth of its radius before the wall nothing counts, so far behind it something does: by a
// face and by a corner first.
TEST(RefinedMeasure, CountsFromTheFirstContactOn) {
  const AnyBody wall(see(synthetic::make_scene("wall")));  // at a depth of 1 m
  const ToolModel tool = lattice_cube(kCubeEdge, 6, 2);
  ToolQuery query(tool, {});
  for (const Rotation& turned : {Rotation{}, generic_rotation()}) {
    const Vec3 toward = turned.row2;
    const double reach =
        kCubeEdge / 2 * (std::abs(toward.x) + std::abs(toward.y) + std::abs(toward.z));
    for (const double beyond : {-1e-3, 0.03}) {
      const Result r = query.run(wall, {turned, {0, 0, 1 - reach + beyond * tool.radius}});
      EXPECT_EQ(r.volume > 0, beyond > 0) << reach;
    }
  }
}

TEST(RefinedMeasure, SeenFreeSpaceNeverCounts) {
  // The tool is before, beside and far from a free-standing block, also where the block hides the
  // wall behind it.
  const synthetic::Scene scene = synthetic::make_scene("block");
  const AnyBody cloud(see(scene));
  const ToolModel tool = lattice_cube(0.1, 6, 2);
  ToolQuery query(tool, {});
  double before = 0;
  for (int k = 0; k <= 60; ++k) {
    // The tool crosses the silhouette, in the gap between block (ends at 1.2) and wall (1.5).
    const Result r = query.run(cloud, {generic_rotation(), {-0.3 + 0.01 * k, 0.01, 1.33}});
    EXPECT_LE(std::abs(r.volume - before), 0.02 * tool.volume) << k;
    EXPECT_EQ(r.volume, 0) << k;
    before = r.volume;
  }
}

// Returns the fraction of the places behind the block's front (z = 1, 0.2 m wide) by `near` at
// most, as the camera's rays cross it.
double behind_the_front(const std::vector<Vec3>& places, const Pose& pose, double near) {
  const auto count = std::count_if(places.begin(), places.end(), [&](const Vec3& place) {
    const Vec3 x = pose * place;
    return x.z > 1 && x.z < 1 + near && std::abs(x.x) < 0.1 * x.z && std::abs(x.y) < 0.1 * x.z;
  });
  return static_cast<double>(count) / static_cast<double>(places.size());
}

// A tool from the side meets a face of the block that the camera cannot see. Where it touches the
// front, the front supports deeper places.
TEST(RefinedMeasure, CountsWhatIsNearBehindTheSurfaceThoughNothingIsCut) {
  const AnyBody cloud(see(synthetic::make_scene("block")));
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 3);
  const std::vector<Vec3> places = testing::places_in_cube(kCubeEdge, 40);
  for (const double z : {0.98, 1.0, 1.18, 1.23}) {
    ToolQuery query(tool, {});
    double before = 0, expected_before = 0, most = 0;
    const double near = z > 1 + tool.radius ? tool.radius : 2 * tool.radius;
    for (double x = 0.3; x > 0; x -= 0.002) {
      const Pose pose{generic_rotation(), {x, 0.01, z}};
      const Result r = query.run(cloud, pose);
      const double expected = behind_the_front(places, pose, near);
      // A pixel is 2 mm wide; pieces as deep as the tool radius count whole or not at all.
      EXPECT_NEAR(r.volume_fraction, expected, 0.02) << x << ' ' << z;
      EXPECT_LE(std::abs(r.volume_fraction - before), std::abs(expected - expected_before) + 0.012)
          << x << ' ' << z;
      before = r.volume_fraction;
      expected_before = expected;
      most = std::max(most, expected);
    }
    EXPECT_GT(most, 0.1) << z;
  }
}

TEST(RefinedMeasure, WhatAnObjectHidesIsNotInsideTheWallBehindIt) {
  // Half of the tool touches the wall in sight; the block in front hides the other half.
  const synthetic::Scene scene = synthetic::make_scene("block");
  const AnyBody cloud(see(scene));
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 2);
  const synthetic::TrueSolid solid(synthetic::make_cube(kCubeEdge));
  ToolQuery query(tool, {});
  for (int k = 0; k <= 20; ++k) {
    const Pose pose{generic_rotation(), {0.15, 0.01, 1.36 + 0.005 * k}};
    const double truth = solid.penetration(pose, *scene.surface).volume;
    const double error = (query.run(cloud, pose).volume - truth) / tool.volume;
    EXPECT_LE(error, 0.02) << k << " of " << truth / tool.volume;
    if (truth > 0.1 * tool.volume) {  // in sight too; up to 2/3 is hidden and missing
      EXPECT_GE(error, -0.67 * truth / tool.volume) << k;
    }
  }
}

TEST(RefinedMeasure, DoesNotJumpWhileAToolInTheWallPassesBehindAnObject) {
  const AnyBody cloud(see(synthetic::make_scene("block")));
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 2);
  ToolQuery query(tool, {});
  double before = 0;
  for (int k = 0; k <= 80; ++k) {
    const double v =
        query.run(cloud, {generic_rotation(), {-0.4 + 0.01 * k, 0.01, 1.46}}).volume / tool.volume;
    if (k == 0) {
      EXPECT_GT(v, 0.15);
    } else {
      EXPECT_LE(std::abs(v - before), 0.03) << k;  // a slice of 10 mm of a quarter of the tool
    }
    before = v;
  }
}

TEST(RefinedMeasure, PushesWithTheGradientOfItsEnergy) {
  // Into a wall the energy is E(d) = integral of V, so the force must be V along the normal at
  // every pose.
  const AnyBody cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kCubeEdge, 8, 3);
  ToolQuery query(tool, {});
  for (int k = 0; k < 10; ++k) {
    const Result r = query.run(cloud, {generic_rotation(), {0, 0, 0.9 + 0.02 * k}});
    EXPECT_NEAR(-r.wrench.force.z, r.volume, 1e-6 * tool.volume);
  }
}

// Hundreds of pixels see each place of the surface; the force must not follow few of them.
TEST(RefinedMeasure, AveragesTheNoiseOfPixels) {
  const synthetic::Scene scene = synthetic::make_scene("tilted-wall");
  const Vec3 normal = scene.surface->gradient({0, 0, 1.1});
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 4);
  double sum = 0;
  constexpr int kPoses = 24;
  for (int k = 0; k < kPoses; ++k) {
    const AnyBody cloud(make_cloud(
        synthetic::render_with_kinect_noise(*scene.surface, scene.camera, static_cast<unsigned>(k)),
        scene.camera, NormalOptions{}));
    const Vec3 force =
        ToolQuery(tool, {}).run(cloud, {generic_rotation(), {0.01, 0, 0.95}}).wrench.force;
    sum += std::asin(std::min(1.0, norm(cross(force, normal)) / norm(force))) * 180 / kPi;
  }
  EXPECT_LE(sum / kPoses, 0.2);
}

// Windows of normals at the bottom of a groove hold both walls. Two pixels from it, the nearest
// surface lies on one of them.
TEST(RefinedMeasure, PushesFromOneWallBesideACrease) {
  const synthetic::Scene scene = synthetic::make_scene("groove");
  const DepthBody cloud(
      make_cloud(synthetic::render(*scene.surface, scene.camera), scene.camera, NormalOptions{}));
  const DepthSurface surface = cloud.surface();
  constexpr double kTwoPixels = 0.004;  // m, at the bottom
  constexpr double kWithin = 5;         // degrees; windows that hold both walls err by up to 33
  for (int k = 0; k < 40 * 30; ++k) {
    const int column = k % 40, row = k / 40;
    const Vec3 x{-0.1 + 0.005 * column, 0.01, 0.98 + 0.004 * row};
    if (scene.surface->distance(x) > -0.001) continue;
    const double from_bottom =
        (std::abs(x.x) - (x.z - 1)) / 2;  // distance of the foot on the nearer wall
    if (from_bottom < kTwoPixels) continue;
    const Vec3 normal = surface.closest_normal(x, surface.sample(x));
    EXPECT_GT(dot(normal, scene.surface->gradient(x)), std::cos(kWithin * kPi / 180))
        << x.x << ' ' << x.z;
  }
}

// Deep below the bottom of a groove the nearest place is the bottom, whose pixels noise moves most.
// Both walls together locate it.
TEST(RefinedMeasure, FindsTheBottomOfAGrooveUnderNoise) {
  const synthetic::Scene scene = synthetic::make_scene("groove");
  double sum = 0;
  int count = 0;
  for (const unsigned seed : {1u, 101u, 201u}) {
    const DepthBody cloud(
        make_cloud(synthetic::render_with_kinect_noise(*scene.surface, scene.camera, seed),
                   scene.camera, NormalOptions{}));
    const DepthSurface surface = cloud.surface();
    for (int k = 0; k < 9 * 10 * 20; ++k) {
      const double depth = 0.01 + 0.005 * (k / 20 % 10), aside = 0.1 * (k / 200 - 4) * depth;
      const Vec3 x{aside, -0.1 + 0.01 * (k % 20), 1 + depth};
      const Vec3 normal = surface.closest_normal(x, surface.sample(x));
      sum += std::acos(std::min(1.0, dot(normal, scene.surface->gradient(x)))) * 180 / kPi;
      ++count;
    }
  }
  EXPECT_LE(sum / count, 3);  // the nearest pixel of a search would give 7.5
}

// Integrates the depth over the inside by counting: the energy per stiffness.
double energy(const Pose& pose, const synthetic::Surface& surface) {
  constexpr int kSteps = 80;
  double sum = 0;
  const auto at = [](int k) { return ((k + 0.5) / kSteps - 0.5) * kCubeEdge; };
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j)
      for (int k = 0; k < kSteps; ++k)
        sum -= std::min(surface.distance(pose * Vec3{at(i), at(j), at(k)}), 0.0);
  return sum * std::pow(kCubeEdge / kSteps, 3);
}

Rotation turn_about(Vec3 axis, double angle) {
  const double s = std::sin(angle / 2);
  return rotation_from_quaternion({s * axis.x, s * axis.y, s * axis.z, std::cos(angle / 2)});
}

// Small motions and turns of the tool take as much from the energy as force and torque do work.
TEST(RefinedMeasure, ForceAndTorqueDoTheWorkOfTheEnergy) {
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 4);
  ToolQuery query(tool, {});
  constexpr double kMove = 0.004, kTurn = 0.02;  // metres, radians
  for (const char* name : {"tilted-wall", "inverted-ball", "ball", "groove"}) {
    const synthetic::Scene scene = synthetic::make_scene(name);
    const AnyBody cloud(see(scene));
    const Pose pose{generic_rotation(), {0.012, -0.007, 0.95}};
    const Result r = query.run(cloud, pose);
    ASSERT_GT(r.volume, 0.05 * tool.volume) << name;
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      const auto moved = [&](double s) {
        return energy({pose.rotation, pose.translation + s * axis}, *scene.surface);
      };
      const auto turned = [&](double angle) {
        return energy({turn_about(axis, angle) * pose.rotation, pose.translation}, *scene.surface);
      };
      const double slope = (moved(kMove) - moved(-kMove)) / (2 * kMove);
      EXPECT_NEAR(-dot(r.wrench.force, axis), slope, 0.01 * r.volume) << name;
      const double twist = (turned(kTurn) - turned(-kTurn)) / (2 * kTurn);
      EXPECT_NEAR(-dot(r.wrench.torque, axis), twist, 0.01 * r.volume * tool.radius) << name;
    }
  }
}

TEST(RefinedMeasure, HolesDoNotLeak) {
  Cloud cloud = see(synthetic::make_scene("wall"));
  const ToolModel tool = lattice_cube(kCubeEdge, 10, 4);
  const Pose pose{generic_rotation(), {0, 0, 0.95}};
  const double whole = ToolQuery(tool, {}).run(AnyBody(cloud), pose).volume;
  for (std::size_t i = 0; i < cloud.sensor->depth.depth.size(); i += 7)
    cloud.sensor->depth.depth[i] = 0;
  EXPECT_NEAR(ToolQuery(tool, {}).run(AnyBody(cloud), pose).volume, whole, 1e-4 * tool.volume);
}

}  // namespace
}  // namespace vpm
