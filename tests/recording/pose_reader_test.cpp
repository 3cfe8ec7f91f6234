#include "libvpm/recording/pose_reader.h"

#include <gtest/gtest.h>

#include "libvpm/file/stream.h"
#include "libvpm/file/temporary_folder.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

struct ReadPose {
  std::vector<double> numbers;  // tx ty tz qx qy qz qw
  double time = 0;              // s
};

ReadPose first_pose(const std::string& text) {
  const file::TemporaryFolder folder;
  file::write_all(folder.path("poses.txt"), text);
  PoseReader reader(folder.path("poses.txt"));
  const Pose pose = reader.next().value();
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  const Vec3 t = pose.translation;
  return {{t.x, t.y, t.z, q.x, q.y, q.z, q.w}, reader.time().value_or(0)};
}

std::vector<double> camera_pose(const std::string& text) {
  const file::TemporaryFolder folder;
  file::write_all(folder.path("pose"), text);
  const Vec3 t = read_camera_pose(folder.path("pose")).translation;
  return {t.x, t.y, t.z};
}

const std::vector<double> kTurned{1, 2, 3, 1, 0, 0, 0};  // half a turn about x

TEST(PoseReader, TakesPlusSignsAndEachLineEnd) {
  EXPECT_EQ(first_pose("+1 +2 +3 +1 +0 +0 +0\n").numbers, kTurned);
  EXPECT_EQ(first_pose("# a comment\r1 2 3 1 0 0 0\r4 5 6 1 0 0 0\r").numbers, kTurned);
}

TEST(PoseReader, ALineOfNamesTellsTheOrder) {
  EXPECT_EQ(first_pose("# timestamp tx ty tz qw qx qy qz\n7 1 2 3 0 1 0 0\n").numbers, kTurned);
  EXPECT_EQ(first_pose("# timestamp tx ty tz qx qy qz qw\n7 1 2 3 1 0 0 0\n").numbers, kTurned);
  const ReadPose euroc = first_pose(
      "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], "
      "q_RS_z [], v_RS_R_x [m s^-1]\n"
      "1403636580838555648,1,2,3,0,1,0,0,9\n");
  EXPECT_EQ(euroc.numbers, kTurned);
  EXPECT_NEAR(euroc.time, 1403636580.838555648, 1e-6);
  EXPECT_EQ(first_pose("x,y,z,qw,qx,qy,qz\n1,2,3,0,1,0,0\n").numbers, kTurned);
  EXPECT_EQ(first_pose("# ground truth trajectory\n1 2 3 1 0 0 0\n").numbers, kTurned);
}

TEST(PoseReader, MessagesEscapeWhatIsNoText) {
  EXPECT_TRUE(says(test::refusal([] { first_pose("\x1b[31m 2 3\n"); }), "not a number: \\x1b[31m"));
}

TEST(CameraPoseFile, ReadsOnePose) {
  const std::vector<double> there{1, 2, 3};
  EXPECT_EQ(camera_pose("1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n"), there);
  EXPECT_EQ(camera_pose("1305031102.1 1 2 3 0 0 0 1\n"), there);
  EXPECT_EQ(
      camera_pose("{\n \"transform_matrix\": [[1,0,0,1],[0,1,0,2],\n [0,0,1,3],[0,0,0,1]]}\n"),
      there);
  EXPECT_EQ(camera_pose("{\"extrinsic\": [1,0,0,0, 0,1,0,0, 0,0,1,0, -1,-2,-3,1]}"), there);
}

TEST(CameraPoseFile, RefusesSeveral) {
  EXPECT_TRUE(
      says(test::refusal([] { camera_pose("1 2 3 0 0 0 1\n1 2 3 0 0 0 1\n"); }), "several poses"));
  EXPECT_TRUE(says(test::refusal([] { camera_pose("\n"); }), "no pose"));
}

}  // namespace
}  // namespace vpm
