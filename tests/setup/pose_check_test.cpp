// Mistakes in poses, and the cures that are named for them.
#include "libvpm/setup/pose_check.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/setup/test_setups.h"

namespace vpm {
namespace {

const Pose kTurned{rotation_from_quaternion({0.1825742, 0.3651484, 0.5477226, 0.7302967}),
                   {0.4, -0.2, 0.3}};

Vec3 in_millimetres(Vec3 place) {
  return 1000.0 * place;
}

// Poses of a tool that is partly in the wall, in the camera's frame.
std::vector<Pose> steps() {
  const Rotation turn = rotation_from_quaternion({0.1, 0.2, 0, 0.9746794});
  return {{turn, {0.1, 0.1, 0.97}}, {turn, {-0.2, -0.13, 1.0}}, {turn, {0, 0.05, 0.98}}};
}

// Returns what is said of poses with this answer, by default that they touched nothing.
std::string said_of(const std::vector<Pose>& poses, const Cloud& cloud, Vec3 center = {},
                    const Result& result = {}) {
  const ToolModel tool = cube_of(0.3, center);
  const ToolModel* const tools[] = {&tool};
  PoseCheck check(tools, source_of(cloud), [&](std::size_t) { return checked_scene(cloud); });
  for (const Pose& pose : poses) check.see(pose, 0, result);
  const auto remark = check.remark();
  return remark ? remark->text : "";
}

template <class Change>
std::vector<Pose> changed(std::vector<Pose> poses, const Change& change) {
  for (Pose& pose : poses) pose = change(pose);
  return poses;
}

void expect_cure(const std::string& said, const std::string& cure) {
  EXPECT_NE(said.find("; it would be there with " + cure), said.npos) << said;
  EXPECT_LE(said.size(), 200U) << said;
}

TEST(PoseCheck, SaysNothingOfPosesAtTheScene) {
  EXPECT_EQ(said_of(steps(), wall_at(1)), "");
  EXPECT_EQ(said_of({}, wall_at(1)), "");
  EXPECT_EQ(
      said_of(changed(steps(), [](const Pose& p) { return kTurned * p; }), wall_at(1, 60, kTurned)),
      "");
}

TEST(PoseCheck, SaysNothingOnceATouchWasSeen) {
  const ToolModel tool = cube_of(0.3);
  const ToolModel* const tools[] = {&tool};
  PoseCheck check(tools, {}, [](std::size_t) { return checked_scene(wall_at(1)); });
  check.see({{}, {0, 0, -5}}, 0, {});
  Result touching;
  touching.boundary = 1;
  check.see({{}, {0, 0, 1}}, 0, touching);
  EXPECT_FALSE(check.remark());
}

TEST(PoseCheck, NamesPosesInMillimetres) {
  const auto scaled = [](const Pose& pose) {
    return Pose{pose.rotation, in_millimetres(pose.translation)};
  };
  const std::string cure = "x, y, z of the poses divided by 1000, if they are millimetres";
  expect_cure(said_of(changed(steps(), scaled), wall_at(1)), cure);
  expect_cure(said_of(changed(steps(), scaled), wall_at(1), {0.05, 0, 0}), cure);
  expect_cure(said_of(changed(changed(steps(), [](const Pose& p) { return kTurned * p; }), scaled),
                      wall_at(1, 60, kTurned)),
              cure);
  expect_cure(said_of({{{}, {0, 100, 250}}, {{}, {120, 0, 240}}}, scanned_cube(0.4, 0.01)), cure);
}

TEST(PoseCheck, NamesTheCamerasPoseInMillimetres) {
  const Pose camera{kTurned.rotation, in_millimetres(kTurned.translation)};
  const std::vector<Pose> poses = changed(steps(), [](const Pose& p) { return kTurned * p; });
  expect_cure(said_of(poses, wall_at(1, 60, camera)),
              "x, y, z of `import_cloud` `camera_pose` divided by 1000, if they are millimetres");
  expect_cure(said_of(changed(poses,
                              [](const Pose& p) {
                                return Pose{p.rotation, in_millimetres(p.translation)};
                              }),
                      wall_at(1, 60, camera)),
              "x, y, z of the poses and `import_cloud` `camera_pose` divided by 1000, if in "
              "millimetres");
}

TEST(PoseCheck, NamesPosesInMillimetresInShadowsThatCount) {
  Result buried;
  buried.volume = 0.001;
  buried.inside = 30;
  const Cloud wall = wall_at(1);
  expect_cure(said_of({{{}, {0, 0, 950}}, {{}, {10, 0, 960}}}, wall, {}, buried),
              "x, y, z of the poses divided by 1000, if they are millimetres");
  EXPECT_EQ(said_of({{{}, {0, 0, 2.5}}}, wall, {}, buried), "");  // a robot in unseen space
  EXPECT_EQ(said_of({{{}, {0, 0, 6}}}, wall, {}, buried), "");
}

TEST(PoseCheck, PosesAFewMetresOffAreNotCalledMillimetres) {
  for (const double away : {1.0, 3.0, 7.0}) {
    const std::string said = said_of({{{}, {away, 0, -away}}}, scanned_cube(0.4, 0.01));
    EXPECT_NE(said, "");
    EXPECT_EQ(said.find("millimetres"), said.npos) << said;
  }
}

TEST(PoseCheck, NamesInversePoses) {
  const std::vector<Pose> poses = changed(steps(), [](const Pose& p) { return kTurned * p; });
  expect_cure(
      said_of(changed(poses, [](const Pose& p) { return inverse(p); }), wall_at(1, 60, kTurned)),
      "inverse poses (from tool to world)");
}

TEST(PoseCheck, NamesPosesThatBeginWithW) {
  // The tool's centre lies far from the origin of its frame, as that of a tool at a flange.
  const Vec3 center{0, 0, 0.9};
  const Pose real{rotation_from_quaternion({0.02, 0.03, 0.1, 0.9943}, nullptr), {0, 0, 0.1}};
  const Quaternion q = quaternion_from_rotation(real.rotation);
  const Pose read{rotation_from_quaternion({q.w, q.x, q.y, q.z}), real.translation};
  expect_cure(said_of({read}, wall_at(1), center), "poses whose quaternions end in w, not begin");
}

TEST(PoseCheck, NamesMistakesOfTheCamerasPose) {
  const std::vector<Pose> poses = changed(steps(), [](const Pose& p) { return kTurned * p; });
  expect_cure(said_of(poses, wall_at(1, 60, inverse(kTurned))),
              "the inverse of `import_cloud` `camera_pose` (from camera to world)");
  const Pose moved{{}, {4, 0, 0}};
  expect_cure(said_of(steps(), wall_at(1, 60, moved)),
              "no `import_cloud` `camera_pose`, if poses are in the camera's frame");
}

TEST(PoseCheck, NamesAtMostTwoMistakes) {
  const std::string said = said_of({{{}, {0, 0, -0.95}}}, wall_at(1));
  expect_cure(said,
              "inverse poses (from tool to world), or with `import_cloud` `axes` opengl "
              "`camera_pose` 0,0,0,0,0,0,1");
}

TEST(PoseCheck, LeavesItOpenWhereNothingFits) {
  EXPECT_EQ(
      said_of({{{}, {50, 70, 40}}}, wall_at(1)),
      "at no pose is the tool in the camera's view; are poses and scene in the same frame and "
      "unit?");
}

}  // namespace
}  // namespace vpm
