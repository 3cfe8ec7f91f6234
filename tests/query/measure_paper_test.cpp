// Compares the paper's measure with results computed by hand.

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/query/tool_query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::lattice_cube;

Cloud points(std::vector<Vec3f> positions, Vec3f normal) {
  Cloud cloud;
  cloud.positions = std::move(positions);
  cloud.normals.assign(cloud.positions.size(), normal);
  cloud.radii.assign(cloud.positions.size(), 0.001f);
  return cloud;
}

Result paper(const ToolModel& tool, const Cloud& cloud, const Pose& pose = {}) {
  QueryOptions options;
  options.measure = Measure::paper;
  return ToolQuery(tool, options).run(AnyBody(cloud), pose);
}

TEST(PaperMeasure, OnePointInOneSphereGivesItsCap) {
  const ToolModel tool = lattice_cube(2, 1, 1);  // the unit sphere
  const Result r = paper(tool, points({{0, 0, -0.5f}}, {0, 0, 1}));
  const double height = 0.5;  // height of the sphere's part below the plane z = -0.5
  const double cap = kPi * height * height * (3 - height) / 3;
  EXPECT_NEAR(r.volume, cap, 1e-9);
  EXPECT_NEAR(r.wrench.force.z, cap, 1e-9);
  EXPECT_EQ(r.boundary, 1u);
  EXPECT_EQ(r.inside, 0u);
  EXPECT_EQ(r.points, 1u);
}

TEST(PaperMeasure, TheSideOfThePlaneCounts) {
  const ToolModel tool = lattice_cube(2, 1, 1);
  const double height = 1.5;  // the normal points away from the centre
  EXPECT_NEAR(paper(tool, points({{0, 0, -0.5f}}, {0, 0, -1})).volume,
              kPi * height * height * (3 - height) / 3, 1e-9);
}

TEST(PaperMeasure, CapsAreAveragedNotSummed) {
  const ToolModel tool = lattice_cube(2, 1, 1);
  const double one = paper(tool, points({{0, 0, -0.5f}}, {0, 0, 1})).volume;
  const double many =
      paper(tool, points({{0, 0, -0.5f}, {0.1f, 0, -0.5f}, {0, 0.2f, -0.5f}}, {0, 0, 1})).volume;
  EXPECT_DOUBLE_EQ(one, many);
}

TEST(PaperMeasure, APointOnTheSphereIsNotInIt) {
  const ToolModel tool = lattice_cube(2, 1, 1);
  EXPECT_EQ(paper(tool, points({{0, 0, -1}}, {0, 0, 1})).boundary, 0u);
}

TEST(PaperMeasure, FloodsBehindTheEntryAndNotBefore) {
  // A column of four layers; the surface passes through the second from below, facing up.
  const ToolModel tool = lattice_cube(4, 4, 1);
  std::vector<Vec3f> plane;
  for (int x = -20; x <= 20; ++x) {
    for (int y = -20; y <= 20; ++y)
      plane.push_back({0.1f * static_cast<float>(x) + 0.01f, 0.1f * static_cast<float>(y), -0.4f});
  }
  const Result r = paper(tool, points(plane, {0, 0, 1}));
  EXPECT_EQ(r.boundary, 16u);
  EXPECT_EQ(r.inside, 16u);
  const double ball = 4.0 / 3 * kPi * 0.125, height = 0.6;
  const double cap = kPi * height * height * (1.5 - height) / 3;
  EXPECT_NEAR(r.volume, 16 * (ball + cap), 1e-6);  // the plane is at float(-0.4)
  EXPECT_NEAR(r.wrench.force.z, r.volume, 1e-8);
  EXPECT_NEAR(r.wrench.force.x, 0, 1e-8);
}

TEST(PaperMeasure, TorqueDoesTheWorkOfTurning) {
  // A ball lies beside the centre of mass, in a floor: turning with the torque lifts it out,
  // turning against it pushes it in.
  ToolModel tool = lattice_cube(2, 1, 1);
  tool.center_of_mass = {-1.5, 0.7, 0.2};
  tool.radius = 3;
  std::vector<Vec3f> floor;
  for (int x = -100; x <= 100; ++x) {
    for (int y = -100; y <= 100; ++y) floor.push_back({0.01f * float(x), 0.01f * float(y), -0.3f});
  }
  const Cloud cloud = points(floor, {0, 0, 1});
  const Result at_rest = paper(tool, cloud);
  const Vec3 axis = normalized_or_zero(at_rest.wrench.torque);
  ASSERT_GT(norm(axis), 0);
  const auto turned = [&](double angle) {
    const Vec3 v = std::sin(angle / 2) * axis;
    const Rotation turn = rotation_from_quaternion({v.x, v.y, v.z, std::cos(angle / 2)});
    return paper(tool, cloud, {turn, tool.center_of_mass - turn * tool.center_of_mass}).volume;
  };
  EXPECT_LT(turned(0.02), at_rest.volume);
  EXPECT_GT(turned(-0.02), at_rest.volume);
  // The paper's (C - p) x f would have the opposite sign.
  const Vec3 arm = Vec3{0, 0, -0.65} - tool.center_of_mass;
  EXPECT_GT(dot(at_rest.wrench.torque, cross(arm, at_rest.wrench.force)), 0);
}

}  // namespace
}  // namespace vpm
