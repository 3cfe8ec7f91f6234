#include <gtest/gtest.h>

#include <cctype>
#include <cmath>

#include "libvpm/import/point_files.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

PointSet points_of_pcd(const std::string& file) {
  return parse_pcd(bytes_of(file), "file");
}
std::string refusal_of_pcd(const std::string& file) {
  return test::refusal([&] { points_of_pcd(file); });
}

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   const std::string& count, int points) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + size + "\nTYPE " + type +
         "\nCOUNT " + count + "\nWIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA ";
}

// Fields in an unusual order and of unusual types, one of them with several values.
constexpr const char* kFields = "normal_z rgb y x z normal_x hist normal_y";
constexpr const char* kSizes = "4 4 8 4 2 4 1 4";
constexpr const char* kTypes = "F U F F I F U F";
constexpr const char* kCounts = "1 1 1 1 1 1 3 1";

struct Row {
  float nz;
  std::uint32_t rgb;
  double y;
  float x;
  std::int16_t z;
  float nx;
  char hist[3];
  float ny;
};
constexpr Row kPcdRows[] = {{1, 7, 2.5, -1, 3, 0, {1, 2, 3}, 0.5F},
                            {-1, 8, -2.25, 4, -7, 0.25F, {4, 5, 6}, 0}};

std::string by_point() {
  std::string bytes;
  for (const Row& r : kPcdRows) {
    append(bytes, r.nz), append(bytes, r.rgb), append(bytes, r.y), append(bytes, r.x);
    append(bytes, r.z), append(bytes, r.nx), bytes.append(r.hist, sizeof r.hist),
        append(bytes, r.ny);
  }
  return bytes;
}

std::string by_field() {
  std::string bytes;
  for (const Row& r : kPcdRows) append(bytes, r.nz);
  for (const Row& r : kPcdRows) append(bytes, r.rgb);
  for (const Row& r : kPcdRows) append(bytes, r.y);
  for (const Row& r : kPcdRows) append(bytes, r.x);
  for (const Row& r : kPcdRows) append(bytes, r.z);
  for (const Row& r : kPcdRows) append(bytes, r.nx);
  for (const Row& r : kPcdRows) bytes.append(r.hist, sizeof r.hist);
  for (const Row& r : kPcdRows) append(bytes, r.ny);
  return bytes;
}

// Returns LZF without references: runs of literals.
std::string as_literals(const std::string& data) {
  std::string bytes;
  for (std::size_t i = 0; i < data.size(); i += 32) {
    const std::string run = data.substr(i, 32);
    bytes.push_back(static_cast<char>(run.size() - 1));
    bytes += run;
  }
  return bytes;
}

std::string ascii_pcd() {
  return header(kFields, kSizes, kTypes, kCounts, 2) +
         "ascii\n1 7 2.5 -1 3 0 1 2 3 0.5\n-1 8 -2.25 4 -7 .25 4 5 6 0\n";
}
std::string binary_file() {
  return header(kFields, kSizes, kTypes, kCounts, 2) + "binary\n" + by_point();
}
std::string compressed_file() {
  std::string file = header(kFields, kSizes, kTypes, kCounts, 2) + "binary_compressed\n";
  const std::string data = as_literals(by_field());
  append(file, static_cast<std::uint32_t>(data.size()));
  append(file, static_cast<std::uint32_t>(by_field().size()));
  return file + data;
}

TEST(Pcd, EveryEncodingGivesTheSamePoints) {
  for (const std::string& file : {ascii_pcd(), binary_file(), compressed_file()}) {
    const PointSet points = points_of_pcd(file);
    ASSERT_EQ(points.positions.size(), 2U);
    EXPECT_FALSE(points.organised());
    EXPECT_EQ(points.positions[0], (Vec3{-1, 2.5, 3}));
    EXPECT_EQ(points.positions[1], (Vec3{4, -2.25, -7}));
    ASSERT_EQ(points.normals.size(), 2U);
    EXPECT_EQ(points.normals[0], (Vec3{0, 0.5, 1}));
    EXPECT_EQ(points.normals[1], (Vec3{0.25, 0, -1}));
  }
}

TEST(Pcd, EveryDamageIsRefused) {
  for (const std::string& file : {binary_file(), compressed_file()})
    expect_damage_is_refused(file, 10000, [](auto bytes) { parse_pcd(bytes, "file"); });
  // Text may lose its last digits and remain valid, so only whole values are missed.
  const std::string ascii = ascii_pcd();
  expect_damage_is_refused(ascii.substr(0, ascii.size() - 1), 10000,
                           [](auto bytes) { parse_pcd(bytes, "file"); });
}

TEST(Pcd, TextHoldsNaNAndWindowsLineEnds) {
  const PointSet points = points_of_pcd(
      "# .PCD v.7\r\nVERSION .7\r\nFIELDS x y z\r\nSIZE 4 4 4\r\nTYPE F F F\r\nWIDTH 2\r\n"
      "HEIGHT 1\r\nPOINTS 2\r\nDATA ascii\r\nnan nan NaN\r\n1 +2 3e-1\r\n");
  EXPECT_TRUE(std::isnan(points.positions[0].z));
  EXPECT_EQ(points.positions[1], (Vec3{1, 2, 0.3}));
  EXPECT_TRUE(points.normals.empty());
}

TEST(Pcd, KeepsGridAndViewpoint) {
  const PointSet points = points_of_pcd(
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 2\n"
      "VIEWPOINT 1 2 3 0 1 0 0\nPOINTS 4\nDATA ascii\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n");
  EXPECT_TRUE(points.organised());
  EXPECT_EQ(points.width, 2U);
  EXPECT_EQ(*points.viewpoint * (Vec3{1, 1, 1}), (Vec3{2, 1, 2}));
}

TEST(Pcd, AViewpointOfZerosIsNone) {
  for (const char* const zeros : {"0 0 0 0 0 0 0", "0 0 0 0 0 0 0 0 0 0", "0.0 0 0 0 0 0 -0"}) {
    const PointSet points = points_of_pcd(
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
        "VIEWPOINT " +
        std::string(zeros) + "\nPOINTS 1\nDATA ascii\n0 0 1\n");
    EXPECT_FALSE(points.viewpoint) << zeros;
  }
  EXPECT_TRUE(says(refusal_of_pcd("VERSION 0.7\nVIEWPOINT 1 0 0 0 0 0 0\n"), "VIEWPOINT"));
}

TEST(Pcd, SaysWhatIsWrong) {
  const std::string plain = header("x y z", "4 4 4", "F F F", "1 1 1", 2);
  EXPECT_TRUE(
      says(refusal_of_pcd(plain + "ascii\n1 2 3\n4 x 6\n"), "point 1: 'x' is not a number"));
  // A surplus number must not shift the numbers of the points after it.
  EXPECT_TRUE(says(refusal_of_pcd(plain + "ascii\n1 2 3 4\n5 6\n"), "point 0 has 4 numbers"));
  EXPECT_TRUE(says(refusal_of_pcd(plain + "ascii\n1 2\n3 4 5 6\n"), "point 0 has 2 numbers"));
  EXPECT_TRUE(says(refusal_of_pcd(plain + "ascii\n1 2 3\n4 5,5 6\n"), "decimals have a point"));
  EXPECT_TRUE(says(refusal_of_pcd(plain + "zip\n"), "DATA 'zip'"));
  EXPECT_TRUE(
      says(refusal_of_pcd(header("x y z X", "4 4 4 4", "F F F F", "1 1 1 1", 1) + "ascii\n"),
           "two fields hold x of its points: x and X"));
  EXPECT_TRUE(says(refusal_of_pcd(header("x y", "4 4", "F F", "1 1", 1) + "ascii\n1 2\n"),
                   "no field holds z of its points; its fields are x, y"));
  EXPECT_TRUE(says(refusal_of_pcd(header("x y z", "4 4 3", "F F F", "1 1 1", 1) + "ascii\n1 2 3\n"),
                   "no number"));
  EXPECT_TRUE(says(refusal_of_pcd("VERSION 0.8\n"), "version 0.8"));
  EXPECT_TRUE(says(refusal_of_pcd("VERSION 0.7\nFIELDS x y z\nSIZE 4 4\n"), "SIZE names 2 fields"));
  EXPECT_TRUE(says(refusal_of_pcd("VERSION 0.7\nWIDTH -1\n"), "is not a count"));
  EXPECT_TRUE(says(refusal_of_pcd("VERSION 0.7\nWIDTH"), "has no value"));
}

TEST(Pcd, WordsMayBeInEitherCaseAndNormalsHaveTheNamesOfPly) {
  const PointSet told = points_of_pcd(ascii_pcd());
  std::string small = ascii_pcd();
  for (char& c : small) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const std::string types = header(kFields, kSizes, "f u f f i f u f", kCounts, 2);
  const std::string ply = header("nz rgb Y X Z NX hist ny", kSizes, kTypes, kCounts, 2) + "ASCII\n";
  const std::string rows = ascii_pcd().substr(ascii_pcd().find("ascii\n") + 6);
  for (const std::string& file :
       {small, "\xEF\xBB\xBF" + ascii_pcd(), types + "ascii\n" + rows, ply + rows}) {
    const PointSet points = points_of_pcd(file);
    EXPECT_EQ(points.positions, told.positions) << file;
    EXPECT_EQ(points.normals, told.normals) << file;
    EXPECT_TRUE(points.remarks.empty());
  }
}

TEST(Pcd, WhatFollowsThePointsIsSaid) {
  for (const std::string& file : {ascii_pcd(), binary_file(), compressed_file()}) {
    const PointSet joined = points_of_pcd(file + file);
    EXPECT_EQ(joined.positions, points_of_pcd(file).positions);
    ASSERT_EQ(joined.remarks.size(), 1U);
    EXPECT_TRUE(says(
        joined.remarks[0].text,
        "the header counts 2 points, but " + std::to_string(file.size()) + " bytes more follow"));
    for (const std::string& end : {std::string("\n"), std::string("\r\n"), std::string(3, '\0')})
      EXPECT_TRUE(points_of_pcd(file + end).remarks.empty());
  }
}

TEST(Pcd, CountsAreCheckedBeforeMemoryIsTaken) {
  const std::string fields = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  for (const std::string size : {"60000000", "4294967296", "18446744073709551615"}) {
    for (const std::string encoding : {"ascii", "binary", "binary_compressed"}) {
      const std::string counts = "WIDTH " + size + "\nHEIGHT 1\nPOINTS " + size;
      EXPECT_NE(refusal_of_pcd(fields + counts + "\nDATA " + encoding + "\n12345678 12345678"), "");
    }
  }
  EXPECT_TRUE(
      says(refusal_of_pcd(fields + "WIDTH 4294967296\nHEIGHT 4294967296\nPOINTS 0\nDATA ascii\n"),
           "promises 4294967296 points"));
  EXPECT_TRUE(says(refusal_of_pcd(fields + "WIDTH 0\nHEIGHT 0\nPOINTS 0\nDATA ascii\n"),
                   "holds no points"));
  EXPECT_TRUE(
      says(refusal_of_pcd(fields + "WIDTH 3\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3 4 5 6\n"),
           "is not POINTS 2"));
  // A compression beyond what LZF can do is refused before memory is taken.
  std::string bomb = fields + "WIDTH 50000000\nHEIGHT 1\nPOINTS 50000000\nDATA binary_compressed\n";
  append(bomb, std::uint32_t{4});
  append(bomb, std::uint32_t{600000000});
  EXPECT_TRUE(says(refusal_of_pcd(bomb + "1234"), "too short"));
}

TEST(Lzf, CopiesRunsThatOverlapThemselves) {
  // The data are "ab", then 7 bytes from 2 back, then a long reference of 9 + 1 bytes from 1 back.
  const std::string data{'\x01', 'a', 'b', '\xA0', '\x01', '\xE0', '\x01', '\x00'};
  std::string out(2 + 7 + 10, '?');
  EXPECT_TRUE(decode_lzf(bytes_of(data), std::as_writable_bytes(std::span(out))));
  EXPECT_EQ(out, "ababababaaaaaaaaaaa");
}

TEST(Lzf, RefusesToLeaveItsBuffers) {
  std::string out(8, '?');
  const auto decodes = [&](const std::string& data) {
    return decode_lzf(bytes_of(data), std::as_writable_bytes(std::span(out)));
  };
  EXPECT_FALSE(decodes(std::string{'\x07', 'a'}));                     // a run past the end
  EXPECT_FALSE(decodes(std::string{'\x20', '\x00'}));                  // a reference to nothing
  EXPECT_FALSE(decodes(std::string{'\x00', 'a', '\x20'}));             // a reference cut off
  EXPECT_FALSE(decodes(std::string{'\x00', 'a', '\xE0'}));             // a length cut off
  EXPECT_FALSE(decodes(std::string{'\x00', 'a', '\xE0', '\x40', 0}));  // more than the buffer holds
  EXPECT_FALSE(decodes(std::string{'\x00', 'a'}));                     // less than promised
}

}  // namespace
}  // namespace vpm
