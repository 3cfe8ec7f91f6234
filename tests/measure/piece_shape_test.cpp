// With another piece shape the rule of clipped weights, and the bodies, give that shape's volumes.

#include "libvpm/scene/piece_shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/measure/tool_piece.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {
namespace {

// An axis-parallel box, for planes with normals along an axis.
struct BoxShape {
  Vec3 half;

  double reach_toward(const Vec3& normal) const {
    return std::fabs(normal.x) * half.x + std::fabs(normal.y) * half.y +
           std::fabs(normal.z) * half.z;
  }
  double fraction_of_cut(double distance, const Vec3& normal) const {
    const double reach = reach_toward(normal);
    return 0.5 * (reach - distance) / reach;
  }
};

// Returns the volume behind a plane at height `height` of a block of 4 x 4 x 4 pieces that fill the
// unit cube about the origin.
template <class Shape>
double volume_behind(const Shape& shape, const Vec3& normal, double height) {
  double volume = 0;
  for (int k = 0; k < 64; ++k) {
    const Vec3 center{(k % 4 - 1.5) / 4, (k / 4 % 4 - 1.5) / 4, (k / 16 - 1.5) / 4.0};
    bool is_cut = false;
    volume += weight_behind(shape, normal, dot(normal, center) - height, 1.0 / 64, is_cut);
  }
  return volume;
}

TEST(PieceShape, BoxesAreCutExactly) {
  const BoxShape box{{0.125, 0.125, 0.125}};
  for (const Vec3 normal : {Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}}) {
    for (double height = -0.6; height < 0.6; height += 0.037) {
      const double expected = std::min(1.0, std::max(0.0, height + 0.5));
      EXPECT_NEAR(volume_behind(box, normal, height), expected, 1e-14);
    }
  }
}

// The section is the derivative of the fraction; the moment is made of sections where they lie.
TEST(PieceShape, SectionAndMomentBelongToTheFraction) {
  const BallShape<double> ball{0.7};
  const Vec3 normal{0, 0, 1};
  double moment = 0;
  constexpr double kStep = 1e-3;
  for (double at = 0.7 - kStep / 2; at > -0.7; at -= kStep) {
    const double section = ball.section_of_cut(at, normal), below = at - kStep / 2;
    EXPECT_NEAR(ball.fraction_of_cut(below, normal) - ball.fraction_of_cut(at + kStep / 2, normal),
                kStep * section, 1e-9);
    moment += at * kStep * section;
    EXPECT_NEAR(ball.moment_of_cut(below, normal), moment, 1e-6);
  }
}

TEST(PieceShape, BallsOfTheSameMomentErrByAPartOfAPieceOnly) {
  // A cube of edge a has the second moment of a ball of radius a sqrt(5 / 12).
  const BallShape<double> ball{0.25 * std::sqrt(5.0 / 12)};
  double largest = 0;
  for (double height = -0.6; height < 0.6; height += 0.037) {
    const double expected = std::min(1.0, std::max(0.0, height + 0.5));
    largest = std::max(largest, std::fabs(volume_behind(ball, {1, 0, 0}, height) - expected));
  }
  EXPECT_LT(largest, 0.02);
  EXPECT_GT(largest, 0.0);  // a ball is no box
}

TEST(PieceShape, BodiesAskTheShape) {
  const BoxShape box{{0.1, 0.2, 0.3}};
  SurfaceSample on_surface{true, 0, {0, 0, 1}, {}};
  for (const double height : {-0.4, -0.3, -0.15, 0.0, 0.15, 0.3, 0.4}) {
    on_surface.distance = height;
    const double expected = std::min(1.0, std::max(0.0, 0.5 - height / 0.6));
    EXPECT_NEAR(DepthSurface::fraction_inside(on_surface, {}, box), expected, 1e-14);
    EXPECT_NEAR(fraction_behind(box, height, Vec3{0, 0, 1}), expected, 1e-14);
  }
}

TEST(PieceShape, BodiesOfSamplesAreTheBallsOfTheirRadius) {
  CellSample sample;
  sample.radius = 0.25F;
  EXPECT_EQ(shape_of(sample).reach_toward(Vec3{0, 0, 1}), 0.25);
  EXPECT_EQ(fraction_behind(shape_of(sample), 0.0, Vec3{0, 0, 1}), 0.5);
  // A cap as high as half the radius holds 5 / 32 of a ball.
  EXPECT_NEAR(fraction_behind(shape_of(sample), 0.125, Vec3{0, 0, 1}), 5.0 / 32, 1e-15);
}

TEST(PieceShape, WhatIsOnlyTouchedIsNotCut) {
  const BoxShape box{{0.1, 0.2, 0.3}};
  bool is_cut = true;
  EXPECT_EQ(weight_behind(box, {0, 0, 1}, 0.3, 1.0, is_cut), 0);
  EXPECT_FALSE(is_cut);
  EXPECT_EQ(weight_behind(box, {0, 0, 1}, -0.3, 1.0, is_cut), 1);
  EXPECT_FALSE(is_cut);
  EXPECT_EQ(weight_behind(box, {1, 0, 0}, 0.0, 1.0, is_cut), 0.5);
  EXPECT_TRUE(is_cut);
}

}  // namespace
}  // namespace vpm
