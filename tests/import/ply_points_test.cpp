#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/import/point_files.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

PointSet parse(const std::string& file) {
  return parse_ply_points(bytes_of(file), "file");
}
std::string refused(const std::string& file) {
  return test::refusal([&] { parse(file); });
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

std::string ascii_file() {
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

TEST(PlyPoints, EveryFormatGivesTheSamePoints) {
  for (const std::string& file : {ascii_file(), binary_file(false), binary_file(true)}) {
    const PointSet points = parse(file);
    ASSERT_EQ(points.positions.size(), 2U);
    EXPECT_EQ(points.positions[0], (Vec3{0.5, 2, 3}));
    EXPECT_EQ(points.positions[1], (Vec3{-0.5, 5, 6}));
    ASSERT_EQ(points.normals.size(), 2U);
    EXPECT_EQ(points.normals[0], (Vec3{0, 0.25, -1}));
    EXPECT_EQ(points.normals[1], (Vec3{0.5, 0, 1}));
  }
}

TEST(PlyPoints, EveryDamageIsRefused) {
  const std::string ascii = ascii_file();
  for (const std::string& file :
       {binary_file(false), binary_file(true), ascii.substr(0, ascii.size() - 1)})
    expect_damage_is_refused(file, 10000, [](auto bytes) { parse_ply_points(bytes, "file"); });
}

TEST(PlyPoints, SaysWhatIsWrong) {
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n";
  EXPECT_TRUE(says(refused(start + "end_header\n1 2\n"), "no property z"));
  EXPECT_TRUE(says(refused(start + "property quaternion z\n"), "unknown type"));
  EXPECT_TRUE(says(refused(start + "property float z\nend_header\n1 2 three\n"),
                   "vertex 0: 'three' is not a number"));
  const std::string two =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  // A surplus number must not shift the numbers of the points after it.
  EXPECT_TRUE(says(refused(two + "1 2 3 4\n5 6\n"), "vertex 0 has more numbers"));
  EXPECT_TRUE(says(refused(two + "1 2\n3 4 5 6\n"), "vertex 0 has fewer numbers"));
  EXPECT_TRUE(says(refused(two + "1 2 3\n4 5 6\n7 8 9\n"), "more rows"));
  EXPECT_TRUE(
      says(refused("ply\nformat ascii 1.0\nelement face 0\nend_header\n"), "no element vertex"));
  EXPECT_TRUE(says(refused("ply\nformat ascii 1.0\nelement vertex many\n"), "is not a count"));
  EXPECT_TRUE(says(refused("ply\nformat ascii 1.0\nproperty float x\n"), "malformed"));
  EXPECT_TRUE(says(refused("ply\nformat xml 1.0\nelement vertex 1\nend_header\n"), "no format"));
}

TEST(PlyPoints, CountsAreCheckedBeforeMemoryIsTaken) {
  const std::string properties =
      "property float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
  for (const std::string format : {"ascii", "binary_little_endian"}) {
    for (const std::string count : {"60000000", "18446744073709551615"}) {
      EXPECT_NE(
          refused("ply\nformat " + format + " 1.0\nelement vertex " + count + "\n" + properties),
          "");
    }
    // An element without properties takes no bytes, however many there are.
    EXPECT_TRUE(says(refused("ply\nformat " + format +
                             " 1.0\nelement void 1000000000000\nelement vertex 1\n" + properties),
                     "no properties"));
  }
}

}  // namespace
}  // namespace vpm
