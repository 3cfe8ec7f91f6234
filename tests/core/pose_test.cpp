#include "libvpm/core/pose.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "libvpm/core/error.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

using test::kind_of_fault;

using Matrix = std::array<double, 9>;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double distance(const Rotation& a, const Rotation& b) {
  return std::sqrt(squared_norm(a.row0 - b.row0) + squared_norm(a.row1 - b.row1) +
                   squared_norm(a.row2 - b.row2));
}

void expect_rotation(const Rotation& r) {
  EXPECT_LT(distance(r * transpose(r), Rotation{}), 1e-14);
  EXPECT_NEAR(determinant(r), 1, 1e-14);
}

std::vector<Quaternion> random_quaternions() {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  std::vector<Quaternion> all;
  for (int k = 0; k < 200; ++k) {
    const double x = normal(generator), y = normal(generator), z = normal(generator),
                 w = std::abs(normal(generator));
    const double length = std::sqrt(x * x + y * y + z * z + w * w);
    all.push_back({x / length, y / length, z / length, w / length});
  }
  // Half turns have w = 0.
  all.insert(all.end(), {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}});
  return all;
}

Matrix matrix_of(const Rotation& r, double scale = 1) {
  return {scale * r.row0.x, scale * r.row0.y, scale * r.row0.z, scale * r.row1.x, scale * r.row1.y,
          scale * r.row1.z, scale * r.row2.x, scale * r.row2.y, scale * r.row2.z};
}

TEST(Quaternions, TurnAsTheyShould) {
  const double half = std::sqrt(0.5);
  const Rotation quarter_about_z = rotation_from_quaternion({0, 0, half, half});
  EXPECT_LT(norm(quarter_about_z * Vec3{1, 0, 0} - Vec3{0, 1, 0}), 1e-15);
  EXPECT_LT(norm(quarter_about_z * Vec3{0, 1, 0} - Vec3{-1, 0, 0}), 1e-15);
}

TEST(Quaternions, GoToRotationsAndBack) {
  for (const Quaternion& q : random_quaternions()) {
    const Rotation r = rotation_from_quaternion(q);
    expect_rotation(r);
    const Quaternion back = quaternion_from_rotation(r);
    EXPECT_GE(back.w, 0);
    EXPECT_LT(distance(rotation_from_quaternion(back), r), 1e-14);
  }
}

TEST(Quaternions, SlightlyOffAreNormalised) {
  for (const Quaternion& q : random_quaternions()) {
    double deviation = 0;
    const Rotation r =
        rotation_from_quaternion({1.004 * q.x, 1.004 * q.y, 1.004 * q.z, 1.004 * q.w}, &deviation);
    EXPECT_LT(distance(r, rotation_from_quaternion(q)), 1e-14);
    EXPECT_NEAR(deviation, 0.004, 1e-12);
  }
}

TEST(Quaternions, NonsenseIsRefused) {
  for (const Quaternion& q :
       {Quaternion{0, 0, 0, 0}, Quaternion{kNan, 0, 0, 1}, Quaternion{0, kInfinity, 0, 1},
        Quaternion{0, 0, 0, 1.1}, Quaternion{0, 0, 0, 1e-300}, Quaternion{1e300, 0, 0, 1}}) {
    EXPECT_EQ(kind_of_fault([&] { rotation_from_quaternion(q); }), ErrorKind::refused);
  }
}

// Recorded camera poses have determinants like 0.9996.
TEST(Matrices, SlightlyScaledAreNormalised) {
  for (const Quaternion& q : random_quaternions()) {
    const Rotation r = rotation_from_quaternion(q);
    double deviation = 0;
    const Rotation back = rotation_from_matrix(matrix_of(r, std::cbrt(0.9996)), &deviation);
    expect_rotation(back);
    EXPECT_LT(distance(back, r), 1e-14);
    EXPECT_GT(deviation, kRotationRounding);
    EXPECT_LT(deviation, 1e-3);
  }
}

// M = R S with S symmetric and positive definite has the polar rotation R for every S.
TEST(Matrices, ThePolarRotationIsFound) {
  const Rotation stretch{{1.002, 0.003, -0.001}, {0.003, 0.997, 0.002}, {-0.001, 0.002, 1.001}};
  for (const Quaternion& q : random_quaternions()) {
    const Rotation r = rotation_from_quaternion(q);
    const Rotation back = rotation_from_matrix(matrix_of(r * stretch));
    expect_rotation(back);
    EXPECT_LT(distance(back, r), 1e-13);
  }
}

TEST(Matrices, NonsenseIsRefused) {
  const Matrix mirror{-1, 0, 0, 0, 1, 0, 0, 0, 1}, zero{}, twice{2, 0, 0, 0, 2, 0, 0, 0, 2},
      flat{1, 0, 0, 0, 1, 0, 0, 0, 0}, sheared{1, 0.1, 0, 0, 1, 0, 0, 0, 1},
      nan{1, 0, 0, 0, kNan, 0, 0, 0, 1}, infinite{kInfinity, 0, 0, 0, 1, 0, 0, 0, 1};
  for (const Matrix& m : {mirror, zero, twice, flat, sheared, nan, infinite})
    EXPECT_EQ(kind_of_fault([&] { rotation_from_matrix(m); }), ErrorKind::refused);
}

TEST(Rotations, AreMadeExactWhereTheyAreNot) {
  const Rotation exact = rotation_from_quaternion({0.5, 0.1, -0.7, 0.5 * std::sqrt(1.0)});
  const Rotation again = exact_rotation(exact);
  EXPECT_TRUE(again.row0 == exact.row0 && again.row1 == exact.row1 && again.row2 == exact.row2);
  const auto rounded = [](Vec3 row) { return widen(narrow(row)); };  // rounds to float
  const Rotation of_floats{rounded(exact.row0), rounded(exact.row1), rounded(exact.row2)};
  EXPECT_FALSE(is_rotation(of_floats, kRotationExact));
  const Rotation mended = exact_rotation(of_floats);
  EXPECT_TRUE(is_rotation(mended, kRotationExact));
  EXPECT_LT(norm(mended.row0 - exact.row0) + norm(mended.row1 - exact.row1) +
                norm(mended.row2 - exact.row2),
            1e-6);
}

TEST(Poses, InverseUndoes) {
  for (const Quaternion& q : random_quaternions()) {
    const Pose pose{rotation_from_quaternion(q), {0.1, -20, 3000}};
    const Vec3 point{0.3, 0.2, -0.1};
    EXPECT_LT(norm(inverse(pose) * (pose * point) - point), 1e-12);
    EXPECT_LT(norm((inverse(pose) * pose).translation), 1e-12);
  }
}

TEST(PoseText, IsRead) {
  const Pose pose = pose_from_text("1.5, -2e-3,3,0,0,0,1");
  EXPECT_EQ(pose.translation, (Vec3{1.5, -2e-3, 3}));
  EXPECT_EQ(distance(pose.rotation, Rotation{}), 0);
  for (const char* text :
       {"1.5 -2e-3 3 0 0 0 1", "[1.5,-2e-3,3,0,0,0,1]", " [ 1.5, -2e-3 ,+3 0 0 0 1 ] "})
    EXPECT_EQ(pose_from_text(text).translation, (Vec3{1.5, -2e-3, 3})) << text;
}

TEST(PoseText, WrongFormIsWrongUsage) {
  for (const char* text :
       {"", "1,2,3", "1,2,3,0,0,0,1,", "1,2,3,0,0,0,one", "1,2,3,0,0,0,1,0", "[1 2 3 0 0 0 1",
        "1,2,3,0,0,0,1]", "[]", "+-1,2,3,0,0,0,1", "0x1,2,3,0,0,0,1", "1,,3,0,0,0,1"}) {
    EXPECT_EQ(kind_of_fault([&] { pose_from_text(text); }), ErrorKind::invalid_argument) << text;
  }
}

TEST(PoseText, NoPoseIsRefused) {
  for (const char* text : {"1,2,3,0,0,0,0", "nan,2,3,0,0,0,1", "inf,2,3,0,0,0,1", "1,2,3,nan,0,0,1",
                           "1,2,3,0,0,0,2"}) {
    EXPECT_EQ(kind_of_fault([&] { pose_from_text(text); }), ErrorKind::refused) << text;
  }
}

double difference(const Rotation& a, const Rotation& b) {
  return norm(a.row0 - b.row0) + norm(a.row1 - b.row1) + norm(a.row2 - b.row2);
}

TEST(RotationVector, GoesThereAndBack) {
  for (const Vec3 v : {Vec3{}, Vec3{1e-9, 0, 0}, Vec3{0.3, -1.2, 2.0}, Vec3{0, 0, 3.14}}) {
    EXPECT_LE(norm(rotation_vector(rotation_from_vector(v)) - v), 1e-12) << v.x << ' ' << v.z;
  }
}

TEST(RotationVector, InterpolatesAlongTheShortestTurn) {
  const Rotation from = rotation_from_vector({0.2, 0.1, -0.4});
  const Rotation to = rotation_from_vector({-0.5, 0.9, 0.3});
  EXPECT_LE(difference(interpolate(from, to, 0), from), 1e-14);
  EXPECT_LE(difference(interpolate(from, to, 1), to), 1e-14);
  const Rotation half = interpolate(from, to, 0.5);
  EXPECT_LE(difference(half * transpose(from) * half, to), 1e-14);
}

}  // namespace
}  // namespace vpm
