// Forms in which programs write poses: matrices over several lines, lists, objects of ROS, tables.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

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

TEST(PoseForms, KeysNearlyThoseOfPosesAreRefusedWithAGuess) {
  const std::string pose = "\"pose\": [1,0,0,0,0,0,1]";
  for (const auto& [key, meant] : {std::pair{"tme", "time"},
                                   {"times", "time"},
                                   {"solid", "solids"},
                                   {"tools", "tool"},
                                   {"timestmap", "timestamp"},
                                   {"Solids", "solids"}}) {
    const std::string line = "{" + pose + ", \"" + key + "\": 3}";
    const std::string refusal = refused("{" + pose + "}\n" + line + "\n");
    EXPECT_TRUE(says(refusal, std::string("line 2: there is no key '") + key + "'")) << refusal;
    EXPECT_TRUE(says(refusal, std::string("is '") + meant + "' meant?")) << refusal;
  }
  for (const std::string other : {"type", "name", "metric", "frame_id", "header", "child_frame_id",
                                  "sharpness", "file_path", "seq", "role", "note", "label", "score",
                                  "covariance", "volume", "grasp", "camera", "robot", "timeout"})
    EXPECT_EQ(read_all_poses("{" + pose + ", \"" + other + "\": 3}\n").x, Numbers{1}) << other;
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
  EXPECT_EQ(read_all_poses("sep=;\r\n5;2;3;0;0;0;1\r\n").x, Numbers{5});
  EXPECT_EQ(read_all_poses("sep=;\r\nx;y;z;qw;qx;qy;qz\r\n5;2;3;1;0;0;0\r\n").x, Numbers{5});
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

TEST(PoseForms, AnglesAreNamedWithTheWayToQuaternions) {
  for (const std::string header :
       {"x,y,z,roll,pitch,yaw", "x y z rx ry rz", "# x y z roll pitch yaw", "tx;ty;tz;rx;ry;rz",
        "x [m],y [m],z [m],roll [deg],pitch [deg],yaw [deg]", "X,Y,Z,Roll,Pitch,Yaw",
        "pos_x,pos_y,pos_z,euler_x,euler_y,euler_z", "x,y,z,yaw_rad,pitch_rad,roll_rad",
        "# px py pz rot_x rot_y rot_z"}) {
    const std::string text = refused(header + "\n.1 .2 .3 0 0 1\n");
    EXPECT_TRUE(says(text, "line 1 names angles where a quaternion should be")) << text;
    EXPECT_TRUE(says(text, "from_euler")) << text;
  }
  for (const std::string header : {"time,x,y,z,roll,pitch,yaw", "# t x y z rx ry rz"}) {
    const std::string text = refused(header + "\n0 .1 .2 0 0 0 1\n");  // would be a quaternion
    EXPECT_TRUE(says(text, "line 1 names angles")) << text;
  }
  EXPECT_TRUE(says(refused(".1 .2 .3 0 0 1\n"), "found 6 numbers, like a position with three"));
  EXPECT_TRUE(says(refused("tx ty tz qx qy qz\n.1 .2 .3 0 0 0\n"), "not clearly"));
  // Quaternions beside angles, and words about them, are read.
  EXPECT_EQ(read_all_poses("x,y,z,qx,qy,qz,qw,roll,pitch,yaw\n5,0,0,0,0,0,1,0,0,0\n").x,
            Numbers{5});
  EXPECT_EQ(read_all_poses("x y z rx ry rz rw\n5 0 0 0 0 0 1\n").x, Numbers{5});
  EXPECT_EQ(read_all_poses("# roll, pitch and yaw are 0\n5 0 0 0 0 0 1\n").x, Numbers{5});
}

// Returns an array of NumPy of these numbers, which stand as `Value`.
template <class Value>
std::string npy(const std::string& type, const std::string& shape, const Numbers& numbers,
                bool by_columns = false) {
  const std::string header = "{'descr': '" + type +
                             "', 'fortran_order': " + (by_columns ? "True" : "False") +
                             ", 'shape': " + shape + ", }\n";
  std::string bytes = std::string("\x93NUMPY\1\0", 8);
  bytes += static_cast<char>(header.size() & 0xFF);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  for (const double number : numbers) {
    const auto value = static_cast<Value>(number);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return bytes;
}

// Two poses: turned about x by half a turn at (5, 2, 3), and upright at (6, 2, 3).
const Numbers kMatrices{1, 0, 0, 5, 0, -1, 0, 2, 0, 0, -1, 3, 0, 0, 0, 1,
                        1, 0, 0, 6, 0, 1,  0, 2, 0, 0, 1,  3, 0, 0, 0, 1};
const Numbers kQuaternions{5, 2, 3, 1, 0, 0, 0, 6, 2, 3, 0, 0, 0, 1};

// Returns the numbers of an array of these sizes by columns, the first index running fastest.
Numbers by_columns(const Numbers& rows, const std::vector<std::size_t>& shape) {
  Numbers columns(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    std::size_t left = k, place = 0, stride = rows.size();
    for (std::size_t d = shape.size(); d-- > 0;) {
      stride /= shape[d];
      place += left % shape[d] * stride;
      left /= shape[d];
    }
    columns[place] = rows[k];
  }
  return columns;
}

TEST(PoseForms, ArraysOfNumPyAreRead) {
  Numbers three, timed;
  for (std::size_t k = 0; k < kMatrices.size(); ++k)
    if (k % 16 < 12) three.push_back(kMatrices[k]);
  for (std::size_t k = 0; k < kQuaternions.size(); ++k) {
    if (k % 7 == 0) timed.push_back(0.5 + static_cast<double>(k));
    timed.push_back(kQuaternions[k]);
  }
  for (const std::string& file :
       {npy<double>("<f8", "(2, 4, 4)", kMatrices), npy<float>("<f4", "(2, 4, 4)", kMatrices),
        npy<double>("<f8", "(2, 3, 4)", three), npy<double>("<f8", "(2, 7)", kQuaternions),
        npy<float>("<f4", "(2, 7)", kQuaternions), npy<double>("<f8", "(2, 16)", kMatrices),
        npy<double>("<f8", "(2, 12)", three), npy<std::int64_t>("<i8", "(2, 7)", kQuaternions),
        npy<double>("<f8", "(2, 4, 4)", by_columns(kMatrices, {2, 4, 4}), true),
        npy<float>("<f4", "(2, 7)", by_columns(kQuaternions, {2, 7}), true)}) {
    const Read read = read_all_poses(file);
    EXPECT_EQ(read.x, (Numbers{5, 6})) << file;
    EXPECT_EQ(read.turn, (Numbers{1, 0})) << file;
    EXPECT_TRUE(read.times.empty());
    EXPECT_EQ(read.place, ", pose 2");
  }
  EXPECT_EQ(read_all_poses(npy<double>("<f8", "(2, 8)", timed)).times, (Numbers{0.5, 7.5}));
  EXPECT_EQ(read_all_poses(npy<double>("<f8", "(7,)", {9, 0, 0, 0, 0, 0, 1})).x, (Numbers{9}));
  EXPECT_EQ(
      read_all_poses(npy<double>("<f8", "(4, 4)", Numbers(kMatrices.begin() + 16, kMatrices.end())))
          .x,
      (Numbers{6}));
  const file::TemporaryFolder folder;  // also for one camera
  file::write_all(folder.path("p"),
                  npy<float>("<f4", "(1, 4, 4)", Numbers(kMatrices.begin() + 16, kMatrices.end())));
  EXPECT_EQ(read_camera_pose(folder.path("p")).translation.x, 6);
}

TEST(PoseForms, OtherArraysAreRefused) {
  EXPECT_TRUE(says(refused(npy<double>("<f8", "(2, 3, 3)", Numbers(18))), "an array of 2 x 3 x 3"));
  EXPECT_TRUE(says(refused(npy<double>("<f8", "(3, 2)", Numbers(6))), "N x 4 x 4"));
  EXPECT_TRUE(says(refused(npy<double>("<f8", "()", {1})), "holds no poses"));
  EXPECT_TRUE(says(refused(npy<double>("<f8", "(9, 7)", kQuaternions)), "truncated"));
  EXPECT_TRUE(says(refused(npy<double>("|O", "(2, 7)", kQuaternions)), "not floats or integers"));
  Numbers scaled = kQuaternions;
  scaled[13] = 2;
  EXPECT_TRUE(says(refused(npy<double>("<f8", "(2, 7)", scaled)), "pose 2"));
  const std::string sound = npy<double>("<f8", "(2, 7)", kQuaternions);
  for (std::size_t size = 1; size < sound.size(); ++size)
    EXPECT_NE(refused(sound.substr(0, size)), "") << size;
}

TEST(PoseForms, TextsInUtf16AreRead) {
  const std::string text = "# tx ty tz qx qy qz qw\r\n5 0 0 0 0 0 1\r\n{\"pose\": [6,0,0,0,0,0,1]}";
  for (const bool is_big : {false, true}) {
    std::string wide = is_big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char letter : text)
      wide += is_big ? std::string{'\0', letter} : std::string{letter, '\0'};
    EXPECT_EQ(read_all_poses(wide).x, (Numbers{5, 6}));
  }
}

TEST(PoseForms, WhatHoldsNoPosesIsNamed) {
  for (const auto& [start, name] : std::vector<std::pair<std::string, std::string>>{
           {"MATLAB 5.0 MAT-file, Platform", "a MATLAB file"},
           {"\x89HDF\r\n\x1a\n", "an HDF5 file"},
           {"\x1a\x45\xdf\xa3", "a Matroska recording"},
           {"#ROSBAG V2.0\n", "a ROS bag"},
           {"\x89PNG\r\n", "a PNG picture"},
           {"solid cube\nfacet", "a mesh in STL"},
           {"PK\3\4", "an archive (zip, npz)"}})
    EXPECT_TRUE(says(refused(start), "this is " + name)) << start;
}

}  // namespace
}  // namespace vpm
