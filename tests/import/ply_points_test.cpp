#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

#include "libvpm/import/point_files.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

PointSet points_of_ply(const std::string& file) {
  return parse_ply_points(bytes_of(file), "file");
}
std::string refusal_of_ply(const std::string& file) {
  return test::refusal([&] { points_of_ply(file); });
}

template <class Value>
void append(std::string& bytes, Value value, bool big_endian) {
  std::string one;
  vpm::append(one, value);
  if (big_endian) std::reverse(one.begin(), one.end());
  bytes += one;
}

// Returns a header with a list before the points, properties in an unusual order, and faces after
// them.
std::string header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment made by hand\nelement patch 1\nproperty list uchar short ids\n"
         "element vertex 2\nproperty float nz\nproperty double x\nproperty uchar red\n"
         "property float y\nproperty float z\nproperty float nx\nproperty float ny\n"
         "element face 1\nproperty list uint8 int32 vertex_indices\nend_header\n";
}

std::string ascii_ply() {
  return header("ascii") + "2 5 6\n-1 0.5 200 2 3 0 0.25\n1 -0.5 100 5 6 0.5 0\n3 0 1 1\n";
}

std::string binary_file(bool big) {
  std::string f = header(big ? "binary_big_endian" : "binary_little_endian");
  append(f, std::uint8_t{2}, big), append(f, std::int16_t{5}, big), append(f, std::int16_t{6}, big);
  append(f, -1.0F, big), append(f, 0.5, big), append(f, std::uint8_t{200}, big);
  for (const float value : {2.0F, 3.0F, 0.0F, 0.25F}) append(f, value, big);
  append(f, 1.0F, big), append(f, -0.5, big), append(f, std::uint8_t{100}, big);
  for (const float value : {5.0F, 6.0F, 0.5F, 0.0F}) append(f, value, big);
  append(f, std::uint8_t{3}, big);
  for (const std::int32_t index : {0, 1, 1}) append(f, index, big);
  return f;
}

// A header of two points without normals.
const std::string kTwo =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
    "property float z\nend_header\n";

TEST(PlyPoints, EveryFormatGivesTheSamePoints) {
  for (const std::string& file : {ascii_ply(), binary_file(false), binary_file(true)}) {
    const PointSet points = points_of_ply(file);
    ASSERT_EQ(points.positions.size(), 2U);
    EXPECT_EQ(points.positions[0], (Vec3{0.5, 2, 3}));
    EXPECT_EQ(points.positions[1], (Vec3{-0.5, 5, 6}));
    ASSERT_EQ(points.normals.size(), 2U);
    EXPECT_EQ(points.normals[0], (Vec3{0, 0.25, -1}));
    EXPECT_EQ(points.normals[1], (Vec3{0.5, 0, 1}));
  }
}

TEST(PlyPoints, EveryDamageIsRefused) {
  const std::string ascii = ascii_ply();
  for (const std::string& file :
       {binary_file(false), binary_file(true), ascii.substr(0, ascii.size() - 1)})
    expect_damage_is_refused(file, 10000, [](auto bytes) { parse_ply_points(bytes, "file"); });
}

TEST(PlyPoints, SaysWhatIsWrong) {
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
  EXPECT_TRUE(says(refusal_of_ply(start + "end_header\n1 2\n"), "no field holds z"));
  EXPECT_TRUE(
      says(refusal_of_ply(start + "property float Y\nproperty float z\nend_header\n1 2 3 4\n"),
           "two fields hold y of its points"));
  EXPECT_TRUE(
      says(refusal_of_ply(start + "property quaternion z\n"), "line 6: quaternion is not a type"));
  EXPECT_TRUE(says(refusal_of_ply(start + "property float z\nend_header\n1 2 three\n"),
                   "line 8: a value is 'three', which is not a number"));
  // A surplus number must not shift the numbers of the points after it.
  EXPECT_TRUE(says(refusal_of_ply(kTwo + "1 2 3 4\n5 6\n"), "line 9: a value is missing"));
  EXPECT_TRUE(says(refusal_of_ply(kTwo + "1 2\n3 4 5 6\n"), "line 8: a value is missing"));
  EXPECT_TRUE(says(refusal_of_ply("ply\nformat ascii 1.0\nelement face 0\nend_header\n"),
                   "no element 'vertex'"));
  EXPECT_TRUE(says(refusal_of_ply("ply\nformat ascii 1.0\nelement vertex many\n"),
                   "is not a whole number"));
  EXPECT_TRUE(says(refusal_of_ply("ply\nformat ascii 1.0\nproperty float x\n"),
                   "a property before the first element"));
  EXPECT_TRUE(says(refusal_of_ply("ply\nformat xml 1.0\nelement vertex 1\nend_header\n"),
                   "line 2: unknown format"));
  EXPECT_TRUE(says(refusal_of_ply(kTwo), "it is truncated"));
  const std::string again = "element vertex 1\nproperty float x\nend_header\n0 0 0\n0\n";
  EXPECT_TRUE(says(refusal_of_ply(start + "property float z\n" + again), "two elements 'vertex'"));
}

TEST(PlyPoints, WhatTheHeaderDoesNotCountIsSaid) {
  const auto only_remark = [](const std::string& file) {
    const PointSet points = points_of_ply(file);
    EXPECT_EQ(points.positions.size(), 2U);
    return points.remarks.size() == 1 ? points.remarks[0].text : "";
  };
  EXPECT_TRUE(says(only_remark(kTwo + "1 2 3 255 0 0\n4 5 6 255 0 0\n"),
                   "2 lines, the first of them line 8, hold more numbers"));
  EXPECT_TRUE(
      says(only_remark(kTwo + "1 2 3\n4 5 6\n7 8 9\n"), "counts 2 x vertex, but more follows"));
  for (const std::string& file : {ascii_ply(), binary_file(false), binary_file(true)}) {
    EXPECT_TRUE(says(only_remark(file + file), "another PLY file follows"));
    EXPECT_TRUE(points_of_ply(file + "\n").remarks.empty());
  }
}

TEST(PlyPoints, WordsMayBeInEitherCaseAndNormalsHaveTheNamesOfPcd) {
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
      text.replace(at, from.size(), to);
    return text;
  };
  std::string capitals = ascii_ply();
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const std::string file = ascii_ply();
  const PointSet told = points_of_ply(file);
  for (const std::string& other :
       {capitals, "\xEF\xBB\xBF" + file, replaced(file, "ply\n", "ply \n"),
        replaced(file, "float n", "float normal_")}) {
    EXPECT_EQ(points_of_ply(other).positions, told.positions) << other;
    EXPECT_EQ(points_of_ply(other).normals, told.normals) << other;
  }
}

TEST(PlyPoints, CountsAreCheckedBeforeMemoryIsTaken) {
  const std::string properties =
      "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
  for (const std::string format : {"ascii", "binary_little_endian"}) {
    for (const std::string count : {"60000000", "18446744073709551615"}) {
      EXPECT_NE(refusal_of_ply("ply\nformat " + format + " 1.0\nelement vertex " + count + "\n" +
                               properties),
                "");
    }
    // An element without properties takes no bytes, however many there are.
    EXPECT_TRUE(
        says(refusal_of_ply("ply\nformat " + format +
                            " 1.0\nelement void 1000000000000\nelement vertex 1\n" + properties),
             "no properties"));
  }
}

}  // namespace
}  // namespace vpm
