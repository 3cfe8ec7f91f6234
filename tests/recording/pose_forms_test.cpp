// Forms in which programs write poses: matrices over several lines, lists, objects of ROS, tables.
#include <gtest/gtest.h>

#include <array>

#include "libvpm/core/pose.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/temporary_folder.h"
#include "libvpm/recording/pose_reader.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

struct Read {
  std::vector<double> x;     // x of each translation
  std::vector<double> turn;  // x of each quaternion
  std::vector<double> times;
  std::string place;  // that of the last pose
};

Read read_all_poses(const std::string& text) {
  const file::TemporaryFolder folder;
  file::write_all(folder.path("p"), text);
  PoseReader reader(folder.path("p"));
  Read read;
  while (const auto pose = reader.next()) {
    read.x.push_back(pose->translation.x);
    read.turn.push_back(quaternion_from_rotation(pose->rotation).x);
    if (reader.time()) read.times.push_back(*reader.time());
    read.place = reader.place().substr(folder.path("p").size());
  }
  return read;
}

std::string refused(const std::string& text) {
  return test::refusal([&] { read_all_poses(text); });
}

bool says(const std::string& text, const std::string& words) {
  return text.find(words) != text.npos;
}

using Numbers = std::vector<double>;

TEST(PoseForms, MatricesOfThreeRowsFollowEachOther) {
  const std::string a = "1 0 0 5\n0 -1 0 2\n0 0 -1 3\n", b = "1 0 0 6\n0 1 0 2\n0 0 1 3\n";
  for (const std::string& text : {a + b + a, a + "\n" + b + "\n\n" + a + "\n",
                                  "# first\n" + a + "# second\n" + b + "# third\n" + a}) {
    const Read read = read_all_poses(text);
    EXPECT_EQ(read.x, (Numbers{5, 6, 5})) << text;
    EXPECT_EQ(read.turn, (Numbers{1, 0, 1})) << text;
  }
  EXPECT_EQ(read_all_poses(a + b).place, ", line 6");
  EXPECT_TRUE(says(refused(a + b + "1 0 0 0\n"), "line 7: the file ends inside of a 3x4 matrix"));
  EXPECT_TRUE(says(refused(a + b + "0 0 0 1\n"), "line 7: the first matrix has three rows"));
  EXPECT_TRUE(says(refused(a + "\n0 0 0 1\n"), "line 5: the first matrix has three rows"));
}

TEST(PoseForms, MatricesOfFourRowsMayHaveBlankLinesBetween) {
  const std::string a = "1 0 0 5\n0 1 0 2\n0 0 1 3\n0 0 0 1\n";
  EXPECT_EQ(read_all_poses(a + "\n" + a).x, (Numbers{5, 5}));
  EXPECT_EQ(read_all_poses("1 0 0 5\n\n0 1 0 2\n\n0 0 1 3\n\n0 0 0 1\n\n" + a).x, (Numbers{5, 5}));
}

// A pipe that waits for each answer must get it at the blank line.
TEST(PoseForms, ABlankLineEndsAMatrixOfThreeRowsBeforeTheNextBegins) {
  const std::string a = "1 0 0 5\n0 1 0 2\n0 0 1 3\n\n";
  const file::TemporaryFolder folder;
  file::write_all(folder.path("p"), a + "this is no pose\n");
  PoseReader reader(folder.path("p"));
  EXPECT_EQ(reader.next().value().translation.x, 5);
  EXPECT_TRUE(says(test::refusal([&] { reader.next(); }), "line 5: column 1 is not a number"));
}

TEST(PoseForms, ListsMayGoOverSeveralLines) {
  const std::string flat = "[5,2,3,0,0,0,1]\n";
  for (const std::string one :
       {"[[1. 0. 0. 5.]\n [0. 1. 0. 2.]\n [0. 0. 1. 3.]\n [0. 0. 0. 1.]]\n",
        "[[1,0,0,5],\n [0,1,0,2],\n [0,0,1,3]]\n", "[\n 5,\n 2,\n 3,\n 0, 0, 0, 1\n]\n",
        "{\n  \"note\": \"a [ in \\\" text\",\n  \"pose\": [\n5,2,3,0,0,0,1]\n}\n"}) {
    EXPECT_EQ(read_all_poses(one + flat + one).x, (Numbers{5, 5, 5})) << one;
    EXPECT_EQ(read_all_poses(flat + one).place, ", line 2") << one;
  }
}

// A bracket that is missing must not make a pipe wait for its end.
TEST(PoseForms, ABracketThatIsMissingIsRefusedAtTheNextPose) {
  const std::string more = "[1,2,3,0,0,0,1]\n[1,2,3,0,0,0,1]\n";
  EXPECT_TRUE(says(refused("[1,2,3,0,0,0,1\n" + more), "line 1: not JSON"));
  EXPECT_TRUE(says(refused("{\"pose\": [1,2,3,0,0,0,1]\n{\"pose\": 1}\n"), "line 1: not JSON"));
  EXPECT_TRUE(says(refused("{\"a\": \"b\n" + more), "line 1: not JSON"));
  EXPECT_TRUE(
      says(refused(more + "{\"pose\":\n[1,2,3,0,0,0,1]\n"), "line 3: a bracket that opens"));
}

TEST(PoseForms, AListHoldsSeveralPoses) {
  const std::string a = "5,0,0,0,0,0,1", b = "6,0,0,1,0,0,0";
  EXPECT_EQ(read_all_poses("[[" + a + "],\n [" + b + "]]\n").x, (Numbers{5, 6}));
  EXPECT_EQ(read_all_poses("[[7," + a + "],[8," + b + "]]").times, (Numbers{7, 8}));
  EXPECT_EQ(read_all_poses("[{\"t\": 7, \"pose\": [" + a + "]}, {\"pose\": [" + b + "]}]").x,
            (Numbers{5, 6}));
  EXPECT_EQ(read_all_poses("{\"poses\": [[" + a + "], [" + b + "]]}").x, (Numbers{5, 6}));
  EXPECT_EQ(read_all_poses("[[" + a + "], [" + b + "]]\n").place, ", line 1, pose 2");
  const std::string matrix = "[[1,0,0,5],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";
  EXPECT_EQ(read_all_poses("[" + matrix + "]").x, (Numbers{5}));
  EXPECT_EQ(read_all_poses("[" + matrix + "," + matrix + "]\n" + matrix).x, (Numbers{5, 5, 5}));
  EXPECT_TRUE(says(refused("[[" + a + "], [5,0,0,0,0,0,2]]"), "line 1, pose 2: pose: the quat"));
  EXPECT_TRUE(says(refused("{\"poses\": []}"), "empty list"));
}

TEST(PoseForms, ObjectsOfRosAreRead) {
  const std::string pose = R"({"position": {"x": 5, "y": 0, "z": 0},
      "orientation": {"x": 1, "y": 0, "z": 0, "w": 0}})";
  const std::string header = R"({"header": {"stamp": {"sec": 7, "nanosec": 500000000}}, )";
  const std::string transform = R"({"translation": {"z": 0, "y": 0, "x": 5},
      "rotation": {"w": 0, "x": 1, "y": 0, "z": 0}})";
  for (const std::string& text :
       {pose, "{\"pose\": " + pose + "}", header + "\"pose\": {\"pose\": " + pose + "}}",
        "[" + pose + "]", "{\"poses\": [" + pose + "]}", "{\"transform\": " + transform + "}",
        "# tx ty tz qw qx qy qz\n" + pose}) {
    const Read read = read_all_poses(text);
    EXPECT_EQ(read.x, Numbers{5}) << text;
    EXPECT_EQ(read.turn, Numbers{1}) << text;
  }
  EXPECT_EQ(read_all_poses(header + "\"pose\": " + pose + "}").times, Numbers{7.5});
  EXPECT_TRUE(says(refused(R"({"position": [1, 2, 3], "orientation": [0, 0, 0, 1]})"),
                   R"("position" must be {"x")"));
  EXPECT_TRUE(says(refused(R"({"place": 1, "q": 2})"), R"(it has "place", "q"; give "pose")"));
}

TEST(PoseForms, MatricesByColumnsAreTold) {
  for (const char* const text :
       {"1 0 0 0\n0 1 0 0\n0 0 1 0\n5 2 3 1\n", "1 0 0 0 0 1 0 0 0 0 1 0 5 2 3 1\n",
        "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[5,2,3,1]]",
        "{\"matrix\": [1,0,0,0,0,1,0,0,0,0,1,0,5,2,3,1]}"})
    EXPECT_TRUE(says(refused(text), "last row 5 2 3 1 ends in 1; transpose it")) << text;
  EXPECT_TRUE(
      says(refused("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 1 1\n"), "by columns, or begin the next"));
  EXPECT_TRUE(says(refused("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2\n"), "0 0 0 1, not 0 0 0 2"));
}

TEST(PoseForms, ACamerasPoseIsReadAndRefusedAlike) {
  const auto x_of = [](const std::string& text) {
    const file::TemporaryFolder folder;
    file::write_all(folder.path("p"), text);
    return read_camera_pose(folder.path("p")).translation.x;
  };
  const std::string ros = R"({"position": {"x": 5, "y": 0, "z": 0},
      "orientation": {"x": 1, "y": 0, "z": 0, "w": 0}})";
  for (const std::string& text :
       {ros, "{\"pose\": " + ros + "}", "[" + ros + "]", std::string("[[5,2,3,0,0,0,1]]"),
        std::string("1 0 0 5\n0 1 0 2\n0 0 1 3\n\n")})
    EXPECT_EQ(x_of(text), 5) << text;
  for (const auto& [text, words] : std::vector<std::pair<const char*, const char*>>{
           {"{\"transform_matrix\": [1,0,0,0,0,1,0,0,0,0,1,0,5,2,3,1]}", "transpose it"},
           {"{\"extrinsic\": [1,0,0,5,0,1,0,2,0,0,1,3,0,0,0,1]}", "give it as lists of rows"},
           {"[[5,2,3,0,0,0,1],[5,2,3,0,0,0,1]]", "several poses"},
           {"1 0 0 5\n0 1 0 2\n0 0 1 3\n1 0 0 5\n0 1 0 2\n0 0 1 3\n", "several poses"}})
    EXPECT_TRUE(says(test::refusal([&] { x_of(text); }), words)) << text;
}

TEST(PoseForms, TheScaleOfAMatrixIsTold) {
  EXPECT_TRUE(says(refused("2 0 0 5 0 0 2 2 0 -2 0 3\n"), "scales by 2;"));
  EXPECT_TRUE(says(refused("2 0 0 5 0 0 1 2 0 -1 0 3\n"), "scales its columns by 2, 1 and 1;"));
  EXPECT_TRUE(says(refused("1 1 0 5 0 1 0 2 0 0 1 3\n"), "away from a rotation matrix"));
}

TEST(PoseForms, TablesAreReadOrTellTheColumn) {
  EXPECT_EQ(read_all_poses("5;2;3;0;0;0;1\n6; 2; 3; 0; 0; 0; 1\n").x, (Numbers{5, 6}));
  for (const auto& [text, words] : std::vector<std::pair<const char*, const char*>>{
           {"0,5;2;3;0;0;0;1\n", "decimals with a point"},
           {"5;2;;0;0;0;1\n", "number 3 is missing: nothing stands between the semicolons"},
           {"\"5\",\"2\",\"3\",\"0\",\"0\",\"0\",\"1\"\n", "column 1 stands in quotes"},
           {"% tx ty tz\n", "let comments begin with #"},
           {"// tx ty tz\n", "let comments begin with #"},
           {"7 world 5 2 3 0 0 0 1\n", "column 2 is not a number: world; leave this column out"},
           {"1 1 0 0 0 5 2 3 1 image.png\n", "images.txt of COLMAP"}})
    EXPECT_TRUE(says(refused(text), words)) << text << refused(text);
  EXPECT_FALSE(says(refused("1 3 0 0 0 5 2 3 1 image.png\n"), "COLMAP"));
  EXPECT_FALSE(says(refused("this is no table\n"), "leave this column out"));
}

}  // namespace
}  // namespace vpm
