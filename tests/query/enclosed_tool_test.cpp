// Tests tools inside of solids that points show from all sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "libvpm/query/tool_query.h"
#include "libvpm/scene/points/points_body.h"
#include "tests/query/lattice_model.h"
#include "tests/scene/scans.h"

namespace vpm {
namespace {

constexpr double kScanStep = 0.01, kCubeInScan = 0.1;  // m
constexpr int kPlacesAlong = 24;

// Returns the part of a cube at a pose whose places are inside of a solid.
double part_of_cube_inside(const SolidDistance& distance, const Pose& pose) {
  const std::vector<Vec3> places = testing::places_in_cube(kCubeInScan, kPlacesAlong);
  const auto inside =
      std::ranges::count_if(places, [&](const Vec3& p) { return distance(pose * p) < 0; });
  return static_cast<double>(inside) / static_cast<double>(places.size());
}

struct ScannedSolid {
  const char* name;
  Cloud cloud;
  SolidDistance distance;
};
ScannedSolid solid_of(const char* name, const SolidDistance& distance) {
  return {name, {}, distance};
}
std::vector<ScannedSolid> scanned_solids() {
  std::vector<ScannedSolid> solids;
  solids.push_back(solid_of("ball", [](Vec3 x) { return norm(x) - 0.3; }));
  add_ball(
      0.3, kScanStep, [](Vec3) { return true; }, solids.back().cloud);
  solids.push_back(solid_of("box", [](Vec3 x) { return box_distance(x, {0.3, 0.3, 0.3}); }));
  add_box({}, {0.3, 0.3, 0.3}, 1, kScanStep, solids.back().cloud);
  solids.push_back(solid_of("shell", [](Vec3 x) {
    return std::max(box_distance(x, {0.4, 0.4, 0.4}), -box_distance(x, {0.15, 0.15, 0.15}));
  }));
  add_box({}, {0.4, 0.4, 0.4}, 1, kScanStep, solids.back().cloud);
  add_box({}, {0.15, 0.15, 0.15}, -1, kScanStep, solids.back().cloud);
  solids.push_back(
      solid_of("torus", [](Vec3 x) { return std::hypot(std::hypot(x.x, x.y) - 0.3, x.z) - 0.12; }));
  add_torus(0.3, 0.12, kScanStep, solids.back().cloud);
  const Vec3 first{-0.1, 0, 0}, second{0.12, 0.05, 0.03}, half{0.2, 0.2, 0.2};
  solids.push_back(solid_of("two boxes", [=](Vec3 x) {
    return std::min(box_distance(x - first, half), box_distance(x - second, half));
  }));
  add_box(first, half, 1, kScanStep, solids.back().cloud);
  add_box(second, half, 1, kScanStep, solids.back().cloud);
  return solids;
}

// All of its faces are flush with the scan's.
TEST(EnclosedTool, CountsWholeInAScanOfItself) {
  Cloud cloud;
  const double half = kCubeInScan / 2;
  add_box({}, {half, half, half}, 1, kScanStep / 5, cloud);
  const ToolModel tool = testing::lattice_cube(kCubeInScan, 5, 3);
  const Result r = ToolQuery(tool, {}).run(AnyBody{PointsBody(cloud)}, Pose{});
  EXPECT_NEAR(r.volume_fraction, 1, 1e-6);
}

// Wholly inside, outside, or cut by the surface, a tool has the volume that is inside.
TEST(EnclosedTool, HasTheVolumeThatIsInside) {
  const ToolModel tool = testing::lattice_cube(kCubeInScan, 5, 3);
  for (const ScannedSolid& solid : scanned_solids()) {
    const AnyBody body{PointsBody(solid.cloud)};
    ToolQuery query(tool, {});
    std::mt19937 random(5);
    std::uniform_real_distribution<double> at(-0.45, 0.45);
    int whole = 0;
    double error = 0, worst = 0;
    constexpr int kPoses = 150;
    for (int k = 0; k < kPoses; ++k) {
      const double x = at(random), y = at(random), z = at(random);
      const Pose pose{testing::generic_rotation(), {x, y, z}};
      const double truth = part_of_cube_inside(solid.distance, pose);
      const double found = query.run(body, pose).volume / tool.volume;
      whole += truth == 1;
      error += std::fabs(found - truth) / kPoses;
      worst = std::max(worst, std::fabs(found - truth));
      if (truth == 0 || truth == 1) {
        EXPECT_NEAR(found, truth, 0.01) << solid.name << " " << k;
      }
    }
    EXPECT_GT(whole, 2) << solid.name;
    EXPECT_LT(error, 0.005) << solid.name;
    EXPECT_LT(worst, 0.06) << solid.name;
  }
}

// On its way through a closed wall a tool stays inside, pose by pose.
TEST(EnclosedTool, StaysInsideOnAPathThroughAWall) {
  Cloud wall;
  add_box({}, {0.6, 0.6, 0.2}, 1, kScanStep, wall);
  const AnyBody body{PointsBody(wall)};
  const ToolModel tool = testing::lattice_cube(kCubeInScan, 5, 3);
  ToolQuery query(tool, {});
  const SolidDistance distance = [](Vec3 x) { return box_distance(x, {0.6, 0.6, 0.2}); };
  for (double z = -0.3; z < 0.31; z += 0.02) {
    const Pose pose{testing::generic_rotation(), {0.013, 0.007, z}};
    EXPECT_NEAR(query.run(body, pose).volume / tool.volume, part_of_cube_inside(distance, pose),
                0.01)
        << z;
  }
}

// What one side of a thing was seen of encloses nothing beyond it.
TEST(EnclosedTool, NeedsASurfaceAllAround) {
  Cloud half;
  add_ball(
      0.3, kScanStep, [](Vec3 n) { return n.z > 0; }, half);
  const AnyBody body{PointsBody(half)};
  const ToolModel tool = testing::lattice_cube(kCubeInScan, 5, 3);
  ToolQuery query(tool, {});
  EXPECT_NEAR(query.run(body, {{}, {0, 0, 0.15}}).volume, tool.volume, 0.01 * tool.volume);
  for (const double z : {-0.15, -0.3, -0.6})
    EXPECT_EQ(query.run(body, {{}, {0, 0, z}}).volume, 0) << z;
}

}  // namespace
}  // namespace vpm
