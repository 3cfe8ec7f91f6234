// One cause is said of a setup that is wrong.
#include "libvpm/setup/cloud_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/scene/depth/depth_body.h"
#include "tests/setup/test_setups.h"

namespace vpm {
namespace {

// Returns what is said of a tool at these poses, with the volume that was measured there.
std::string said_of(const ToolModel& tool, const Cloud& cloud, const std::vector<Pose>& poses,
                    double volume = 0) {
  std::optional<DepthBody> image;
  if (cloud.sensor) image.emplace(cloud);
  std::optional<DepthSurface> surface;
  if (image) surface = image->surface();
  CloudChecks checks({&tool}, cloud, surface);
  Result result;
  result.volume = volume;
  for (const Pose& pose : poses) checks.see(pose, 0, result);
  const Remarks remarks = checks.remarks();
  EXPECT_LE(remarks.size(), 1U);
  return remarks.empty() ? "" : remarks.front().text;
}

bool begins_with(const std::string& text, const std::string& part) {
  return text.rfind(part, 0) == 0;
}

Cloud wall_with_hole(double half_width) {
  return seen_by_camera(60, [=](double u, double v) {
    return std::max(std::abs(u - 31.5), std::abs(v - 23.5)) > half_width ? 1.0 : 0.0;
  });
}

TEST(CloudChecks, SayNothingOfASetupThatIsRight) {
  EXPECT_EQ(said_of(cube_of(0.3), wall_at(1), {{{}, {0, 0, 0.95}}}, 0.01), "");
  EXPECT_EQ(said_of(cube_of(0.3), wall_at(1), {}), "");
  EXPECT_EQ(said_of(cube_of(0.1), scanned_cube(1, 0.02), {{{}, {0, 0, 0.3}}}, 0.0002), "");
}

TEST(CloudChecks, SizesComeBeforeHolesAndPoses) {
  const ToolModel finger = cube_of(60);
  EXPECT_TRUE(begins_with(said_of(finger, wall_with_hole(8), {{{}, {0, 0, 0.95}}}, 5540),
                          "the tool is 60 m across"));
  EXPECT_TRUE(
      begins_with(said_of(finger, wall_at(1), {{{}, {0, 0, -2000}}}), "the tool is 60 m across"));
  EXPECT_TRUE(begins_with(said_of(finger, scanned_cube(1, 0.02), {{{}, {0, 0, 0}}}),
                          "the tool is 60 m across"));
  EXPECT_TRUE(begins_with(said_of(finger, wall_at(1), {}), "the tool is 60 m across"));
}

TEST(CloudChecks, AToolThatIsEnclosedIsAtTheScene) {
  const std::string enclosed =
      "at 1 of the poses the tool is behind points that show one side only";
  // Wherever in it, also where its middle would be at the surface with other axes.
  for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{0.05, 0.02, 0}, Vec3{0, 0.1, 0.05}})
    EXPECT_TRUE(begins_with(said_of(cube_of(0.1), scanned_cube(1, 0.02), {{{}, at}}), enclosed));
  EXPECT_TRUE(begins_with(said_of(cube_of(0.1), scanned_cube(1, 0.02), {{{}, {3, 0, 0}}}),
                          "at no pose is the tool within its size of the surface"));
}

TEST(CloudChecks, AToolBehindAHoleIsAtTheScene) {
  EXPECT_TRUE(begins_with(said_of(cube_of(0.1), wall_with_hole(12), {{{}, {0, 0, 1.0}}}),
                          "at pose 0 a quarter or more"));
}

TEST(CloudChecks, PosesThatMissTheSceneComeBeforeAFewBehindItsHoles) {
  std::vector<Pose> poses(9, Pose{{}, {0, 0, -1}});
  poses.push_back({{}, {0, 0, 1.0}});
  EXPECT_TRUE(begins_with(said_of(cube_of(0.1), wall_with_hole(12), poses),
                          "at no pose is the tool within its size of the surface"))
      << said_of(cube_of(0.1), wall_with_hole(12), poses);
}

TEST(CloudChecks, AFewPosesBehindHolesAreSaidOfAPathThatTouches) {
  std::vector<Pose> poses(9, Pose{{}, {-0.3, 0, 0.9}});
  poses.push_back({{}, {0, 0, 1.0}});
  EXPECT_TRUE(begins_with(said_of(cube_of(0.1), wall_with_hole(12), poses, 0.0001),
                          "at pose 9 a quarter or more"));
}

}  // namespace
}  // namespace vpm
