#include "libvpm/recording/pose_reader.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

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

// Returns the first pose of a file with this first line and numbers in its order.
std::vector<double> named(const std::string& names, const std::string& numbers) {
  return first_pose(names + "\n" + numbers + "\n").numbers;
}

TEST(PoseReader, PassesOverOtherWordsAndUnitsBesideTheNames) {
  for (const char* names :
       {"# Format: timestamp tx ty tz qw qx qy qz", "# timestamp tx ty tz qw qx qy qz (metres)",
        "# timestamp [s] tx [m] ty [m] tz [m] qw [] qx qy qz", "# [timestamp tx ty tz qw qx qy qz]",
        "# (timestamp tx ty tz qw qx qy qz)", "#(timestamp, tx, ty, tz, qw, qx, qy, qz)",
        "# Format: timestamp, tx, ty, tz, qw, qx, qy, qz in metres", "# timestamp tx ty tz w x y z",
        "# timestamp, (tx, ty, tz), (qw, qx, qy, qz)", "# time stamp tx ty tz qw qx qy qz",
        "# <timestamp> <tx> <ty> <tz> <qw> <qx> <qy> <qz>", "timestamp x y z q[w] q[x] q[y] q[z]",
        "# time position (x y z) orientation (w x y z)", "  # tx ty tz qw qx qy qz",
        "# time, pose.position.x, pose.position.y, pose.position.z, pose.orientation.w, "
        "pose.orientation.x, pose.orientation.y, pose.orientation.z",
        "# Each line is: timestamp tx ty tz and qw qx qy qz, blanks between",
        "# t;x;y;z;qw;qx;qy;qz"})
    EXPECT_EQ(named(names, "7 1 2 3 0 1 0 0"), kTurned) << names;
  for (const char* names : {"# pose tx ty tz qw qx qy qz", "# (tx ty tz w x y z)",
                            "# tx ty tz qw qx qy qz (w first)", "# Format: tx ty tz qw qx qy qz"})
    EXPECT_EQ(named(names, "1 2 3 0 1 0 0"), kTurned) << names;
  EXPECT_EQ(named("# w x y z tx ty tz", "0 1 0 0 1 2 3"), kTurned);
  EXPECT_EQ(named("# rotation: w x y z, translation: x y z", "0 1 0 0 1 2 3"), kTurned);
  EXPECT_EQ(named("# tx ty tz x y z w", "1 2 3 1 0 0 0"), kTurned);
  EXPECT_EQ(named("", "1 2 3 0 1 0 0 # tx ty tz qw qx qy qz"), kTurned);
  EXPECT_EQ(named("# tx ty tz qw qx qy qz", "[1, 2, 3, 0, 1, 0, 0]"), kTurned);
}

TEST(PoseReader, NamesInTheUsualOrderAreOnlyACommentWhereTheyDoNotFit) {
  for (const char* names :
       {"# Format: timestamp tx ty tz qx qy qz qw", "# timestamp tx ty tz qx qy qz qw (metres)",
        "# a quaternion, w last", "# real poses first",
        "# tx ty tz qx qy qz qw, where q is a unit quaternion", "# position and quaternion",
        "# x y z x y z w", "# position in m, orientation as a unit quaternion (x, y, z, w)"}) {
    EXPECT_EQ(named(names, "1 2 3 1 0 0 0"), kTurned) << names;
    EXPECT_EQ(first_pose(std::string(names) + "\n7 1 2 3 1 0 0 0\n").time, 7) << names;
  }
}

TEST(PoseReader, PassesOverColumnsThatAreNoneOfThePoses) {
  for (const char* names : {"# id tx ty tz qw qx qy qz", "frame,tx,ty,tz,qw,qx,qy,qz",
                            "# anything, tx, ty, tz, qw, qx, qy, qz"}) {
    EXPECT_EQ(named(names, "7 1 2 3 0 1 0 0"), kTurned) << names;
    EXPECT_EQ(first_pose(std::string(names) + "\n7 1 2 3 0 1 0 0\n").time, 0) << names;
  }
  EXPECT_EQ(named("# tx ty tz qw qx qy qz confidence", "1 2 3 0 1 0 0 1"), kTurned);
  EXPECT_EQ(named("# tx ty tz and qw qx qy qz", "7 1 2 3 0 1 0 0"), kTurned);
}

TEST(PoseReader, RefusesAnEighthNumberThatMayBeATimeOrNone) {
  for (const char* names : {"# tx ty tz qx qy qz qw metres", "# anything tx ty tz qw qx qy qz",
                            "# tx ty tz qw qx qy qz metres"}) {
    EXPECT_TRUE(says(test::refusal([&] { named(names, "7 1 2 3 0 0 0 1"); }), "not clearly"))
        << names;
    EXPECT_NO_THROW(named(names, "1 2 3 0 0 0 1")) << names;
  }
  EXPECT_TRUE(
      says(test::refusal([] { named("# the first tx ty tz qw qx qy qz", "7 1 2 3 0 0 0 1"); }),
           "found 8 numbers where the line of names has 7 (line 1)"));
}

TEST(PoseReader, TheUnitOfTheTimeIsTaken) {
  const std::string rest = " tx ty tz qx qy qz qw\n2000 1 2 3 1 0 0 0\n";
  EXPECT_EQ(first_pose("# timestamp [s]" + rest).time, 2000);
  EXPECT_EQ(first_pose("# timestamp [ms]" + rest).time, 2);
  EXPECT_EQ(first_pose("# timestamp (us)" + rest).time, 0.002);
  EXPECT_EQ(first_pose("# timestamp[ns]" + rest).time, 1e-9 * 2000);
}

TEST(PoseReader, RefusesNamesThatDoNotTellTheOrder) {
  for (const char* names :
       {"# tx ty tz q0 q1 q2 q3", "# tx ty tz q[0] q[1] q[2] q[3]", "# tx ty tz qi qj qk qr",
        "# x y z w x y z", "# pose as xyz wxyz", "# quaternions are scalar first",
        "# the quaternion begins with its w: w first", "# tx ty tz quaternion",
        "# tx ty tz qw qx qy", "tx,ty,tz,q0,q1,q2,q3", "# (x, y, z), (q1, q2, q3, q4)"}) {
    const std::string text = std::string("# poses\n") + names + "\n1 2 3 0 1 0 0\n";
    const auto fault = test::refusal([&] { first_pose(names[0] == '#' ? text : text.substr(8)); });
    EXPECT_TRUE(says(fault, "seems to tell the order")) << names;
    EXPECT_TRUE(says(fault, names[0] == '#' ? "line 2 seems" : "line 1 seems")) << names;
    EXPECT_TRUE(says(fault, "qx qy qz qw, or qw qx qy qz")) << names;
  }
  const auto fault =
      test::refusal([] { first_pose("# poses\n# time tx ty tz qw qx qy qz\n1 2 3 0 1 0 0\n"); });
  EXPECT_TRUE(says(fault, "found 7 numbers where the line of names has 8 (line 2)"));
}

TEST(PoseReader, AClearLineOfNamesWinsOverAnUnclearOne) {
  const std::string clear = "# tx ty tz qw qx qy qz\n", unclear = "# tx ty tz q0 q1 q2 q3\n";
  EXPECT_EQ(first_pose(clear + unclear + "1 2 3 0 1 0 0\n").numbers, kTurned);
  EXPECT_EQ(first_pose(unclear + clear + "1 2 3 0 1 0 0\n").numbers, kTurned);
}

TEST(PoseReader, TakesTheUsualNamesOfTheTimeInJson) {
  for (const char* key : {"time", "timestamp", "t", "stamp"})
    EXPECT_EQ(first_pose("{\"" + std::string(key) + "\": 2, \"pose\": [1,2,3,1,0,0,0]}\n").time, 2);
  const auto fault =
      test::refusal([] { first_pose("{\"time\": 2, \"stamp\": 2, \"pose\": [1,2,3,1,0,0,0]}\n"); });
  EXPECT_TRUE(says(fault, "both \"time\" and \"stamp\""));
}

TEST(PoseReader, KeepsTheIdOfAnObject) {
  const file::TemporaryFolder folder;
  const std::string pose = "\"pose\": [1,2,3,1,0,0,0]}";
  file::write_all(
      folder.path("poses"),
      "{\"id\": \"a\", " + pose + "\n1 2 3 1 0 0 0\n[{\"id\": 7, " + pose + ", {" + pose + "]\n");
  PoseReader reader(folder.path("poses"));
  for (const char* const id : {"\"a\"", "", "7", ""}) {
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.id(), id);
  }
}

TEST(PoseReader, TakesMatricesOfThreeRows) {
  const std::string numbers = "1 0 0 1 0 -1 0 2 0 0 -1 3";
  EXPECT_EQ(first_pose(numbers + "\n").numbers, kTurned);
  EXPECT_EQ(first_pose("# tx ty tz qw qx qy qz\n" + numbers + "\n").numbers, kTurned);
  EXPECT_EQ(first_pose("{\"matrix\": [[1,0,0,1],[0,-1,0,2],[0,0,-1,3]]}\n").numbers, kTurned);
  EXPECT_TRUE(says(test::refusal([] { first_pose("1 0 0 1 0 -1 0 2 0 0 1 3\n"); }), "mirrors"));
  EXPECT_TRUE(says(test::refusal([] { first_pose("[[1,0,0],[0,1,0],[0,0,1],[1,2,3]]\n"); }),
                   "a row of a matrix must have four numbers"));
}

TEST(PoseReader, OnlyTheFirstMatrixMayLackItsLastRow) {
  const std::string rows = "1 0 0 1\n0 1 0 2\n0 0 1 3\n";
  const file::TemporaryFolder folder;
  file::write_all(folder.path("poses.txt"), rows + "0 0 0 1\n" + rows);
  PoseReader reader(folder.path("poses.txt"));
  EXPECT_TRUE(reader.next());
  EXPECT_TRUE(says(test::refusal([&] { reader.next(); }), "ends inside of a 4x4 matrix"));
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
  EXPECT_EQ(camera_pose("{\"extrinsic\": [[1,0,0,-1],\n [0,1,0,-2],\n [0,0,1,-3],\n [0,0,0,1]]}"),
            there);
  EXPECT_EQ(camera_pose("1 0 0 1\n0 1 0 2\n0 0 1 3\n"), there);
  EXPECT_EQ(camera_pose("1 0 0 1 0 1 0 2 0 0 1 3\n"), there);
}

TEST(CameraPoseFile, ReadsListsOverSeveralLines) {
  const std::vector<double> there{1, 2, 3};
  for (const char* text :
       {"[[1,0,0,1],\n [0,1,0,2],\n [0,0,1,3],\n [0,0,0,1]]",
        "[1,0,0,1,\n0,1,0,2,\n0,0,1,3,\n0,0,0,1]\n",
        "[[1. 0. 0. 1.]\n [0. 1. 0. 2.]\n [0. 0. 1. 3.]\n [0. 0. 0. 1.]]\n",
        "[[1., 0., 0., 1.],\n [0., 1., 0., 2.],\n [0., 0., 1., 3.]]",
        "[\n1,\n2,\n3,\n0,\n0,\n0,\n1\n]\n", "[1. 2. 3. 0. 0. 0. 1.]\n",
        "\n [[1e0 0 0 1]\n[0 1 0 2]\n[0 0 1 3]\n[0 0 0 1]]", "[7, 1, 2, 3, 0, 0, 0, 1]\n"})
    EXPECT_EQ(camera_pose(text), there) << text;
}

TEST(CameraPoseFile, RefusesListsThatAreNoPose) {
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"[[1. 0. 0.]\n [0. 1. 0.]\n [0. 0. 1.]\n [1. 2. 3.]]", "four numbers"},
           {"[[1,0,0,1],\n[0,1,0,2],\n[0,0,1,3],\n[0,0,1,1]]", "0 0 0 1"},
           {"[[1. 0. ... 0.]\n [0. 1. ... 0.]]", "not JSON"},
           {"[1,2,3,0,0,0,1]\n[1,2,3,0,0,0,1]\n", "several poses"},
           {"{\"extrinsic\": [1,0,0,0,0,1,0,0,0,0,1,0]}", "nor lists of rows"},
           {"{\"extrinsic\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[1,2,3,1]]}", "0 0 0 1"}})
    EXPECT_TRUE(says(test::refusal([&] { camera_pose(text); }), message)) << text;
}

TEST(CameraPoseFile, RefusesSeveral) {
  EXPECT_TRUE(
      says(test::refusal([] { camera_pose("1 2 3 0 0 0 1\n1 2 3 0 0 0 1\n"); }), "several poses"));
  EXPECT_TRUE(says(test::refusal([] { camera_pose("\n"); }), "no pose"));
}

TEST(PoseReader, KeysGivenTwiceAreRefused) {
  for (const char* const text :
       {R"({"pose": [1, 2, 3, 0, 0, 0, 1], "pose": [1, 2, 4, 0, 0, 0, 1]})",
        R"({"t": 1, "pose": [1, 2, 3, 0, 0, 0, 1], "t": 2})",
        R"({"head": {"a": 1, "a": 2}, "pose": [1, 2, 3, 0, 0, 0, 1]})"})
    EXPECT_TRUE(says(test::refusal([&] { camera_pose(text); }), "twice; leave one of them out"))
        << text;
  // Keys of different objects may be the same.
  camera_pose(R"({"a": {"t": 1}, "b": [{"t": 1}, {"t": 2}], "pose": [1, 2, 3, 0, 0, 0, 1]})");
}

TEST(PoseReader, DecimalCommasAreRefused) {
  for (const char* const line : {"0,1 0 1 0 0 0 1", "0,0 0 1,0 0 0 0 1", "5 0,1 0 1 0 0 0 1"})
    EXPECT_TRUE(says(test::refusal([&] { camera_pose(line); }), "decimals with a point")) << line;
}

// A pose with all that is told of it.
using Told = std::tuple<std::vector<double>, std::optional<double>, std::string, std::size_t>;

Told told(const Pose& pose, std::optional<double> time, const std::string& id,
          const std::vector<Pose>& solids) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  const Vec3 t = pose.translation;
  return {{t.x, t.y, t.z, q.x, q.y, q.z, q.w}, time, id, solids.size()};
}

// Holds what a reader says: the poses before the first that it refuses, and that refusal.
struct AllPoses {
  std::vector<Told> poses;
  std::string refusal;

  void add_all(PoseReader& reader) {
    try {
      while (const auto pose = reader.next())
        poses.push_back(told(*pose, reader.time(), reader.id(), reader.solids()));
    } catch (const Error& fault) {
      refusal = fault.where() + ": " + fault.problem();
    }
  }
  bool operator==(const AllPoses&) const = default;
};

// Reads plain lines apart from the reader, until there are none or one is not plain.
AllPoses by_lines(const std::string& path, std::size_t& plain) {
  PoseReader reader(path);
  AllPoses all;
  const auto first = reader.next();
  if (first) all.poses.push_back(told(*first, reader.time(), reader.id(), reader.solids()));
  std::optional<PoseLines> lines = reader.next_lines();
  std::string_view left = lines ? std::string_view(lines->text) : std::string_view();
  while (!left.empty()) {
    const std::size_t end = left.find('\n');
    const auto pose = lines->parser.of_plain_line(std::string(left.substr(0, end)));
    if (!pose) break;
    all.poses.push_back(told(pose->pose, pose->time, pose->id, pose->solids));
    left.remove_prefix(end + 1);
    ++plain;
  }
  reader.give_back(left);
  all.add_all(reader);
  return all;
}

TEST(PoseReader, PlainLinesAreReadApartAsTheyAreReadInOrder) {
  const file::TemporaryFolder folder;
  const std::string path = folder.path("poses.txt");
  const std::string pose = "[1,2,3,1,0,0,0]\n";
  const auto expect_plain = [&](const std::string& text, std::size_t lines) {
    file::write_all(path, text);
    PoseReader reader(path);
    AllPoses in_order;
    in_order.add_all(reader);
    std::size_t plain = 0;
    EXPECT_EQ(by_lines(path, plain), in_order) << text;
    EXPECT_EQ(plain, lines) << text;
  };
  expect_plain(pose + pose + pose, 2);
  expect_plain(pose + R"({"id": {"b": 1, "a": "#"}, "t": 5, "pose": [1,2,3,1,0,0,0]})" + "\n", 1);
  expect_plain(pose + R"({"tool": [1,2,3,1,0,0,0], "solids": [[1,2,3,1,0,0,0]]})" + "\n", 1);
  expect_plain("1 2 3 1 0 0 0\r\n4 5 6 0 1 0 0\r\n[4,5,6,0,1,0,0]\r\n", 2);
  expect_plain("# t tx ty tz qw qx qy qz\n7 1 2 3 0 1 0 0\n8 1 2 3 0 0 1 0\n", 1);
  // These need the lines around them, are several poses, none, or end before the line does.
  expect_plain(pose + pose + "{\n\"pose\":\n[1,2,3,1,0,0,0]\n}\n" + pose, 1);
  expect_plain(pose + pose + "[[1,2,3,1,0,0,0],[1,2,3,0,1,0,0]]\n" + pose, 1);
  expect_plain(pose + pose + "# of names: tx ty tz qw qx qy qz\n1 2 3 0 1 0 0\n", 1);
  expect_plain(pose + "\n" + pose, 0);
  expect_plain(pose + pose + "[1,2,3,1,0,0,0", 1);
  expect_plain(pose + "1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n" + pose, 0);
  expect_plain("[" + pose + "," + pose + "]\n" + pose, 0);
  // These are refused, with the number of the line.
  expect_plain(pose + pose + "[1,2,3,\"x\",0,0,0]\n" + pose, 1);
  expect_plain(pose + pose + "1 2 3 1 0 0 zero\n" + pose, 1);
  expect_plain(pose + pose + pose + "{\"pose\": [1,2,3,0,0,0,0]}\n", 2);
}

}  // namespace
}  // namespace vpm
