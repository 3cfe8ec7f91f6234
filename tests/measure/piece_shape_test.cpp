// With another piece shape the rule of clipped weights, and the bodies, give that shape's volumes.

#include "libvpm/scene/piece_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
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
  double reach_away(const Vec3& normal) const { return reach_toward(normal); }
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

FaceShape<double> face_of(Vec3 axis, double toward, double away, double along, double across) {
  const double square = across * across;
  return {axis, square, toward * toward - square, away * away - square, along * along - square};
}

// Seen along the axis, equal parts of its thickness then hold equal parts of the piece.
TEST(FaceShape, IsAUniformLayerWhereItsVarianceIsThatOfOne) {
  const double along = std::sqrt(5.0 / 3) * 0.2;
  const FaceShape<double> layer = face_of({0, 0, 1}, 0.2, 0.2, along, 0.3);
  for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{0, 0, -1}})
    for (double distance = -0.3; distance < 0.3; distance += 0.01)
      EXPECT_NEAR(fraction_behind(layer, distance, normal),
                  std::clamp(0.5 - distance / 0.4, 0.0, 1.0), 1e-12);
}

TEST(FaceShape, IsABallWhereAllItsExtentsAreEqual) {
  const FaceShape<double> round = face_of(normalized_or_zero({1, 2, 3}), 0.7, 0.7, 0.7, 0.7);
  const BallShape<double> ball{0.7};
  for (const Vec3 normal : {Vec3{0, 0, 1}, Vec3{0.6, -0.8, 0}})
    for (double distance = -0.8; distance < 0.8; distance += 0.03)
      EXPECT_NEAR(fraction_behind(round, distance, normal), fraction_behind(ball, distance, normal),
                  1e-12);
}

// Calls visit(shape, normal) for shapes of all proportions that a reader takes, from all sides.
template <class Visit>
void for_shapes(const Visit& visit) {
  for (const double toward : {0.02, 0.3, 0.6, 1.0})
    for (const double away : {0.02, 0.45, 0.7, 1.0})
      for (const double across : {0.0, 0.1, 1.2}) {
        const double most = std::sqrt(5 * most_variance_at_face(toward, away));
        for (const double along : {0.5 * most, most})
          for (double turn = 0; turn < 3.2; turn += 0.2)
            visit(face_of({0, 0, 1}, std::min(toward, along), std::min(away, along), along, across),
                  Vec3{std::sin(turn), 0, std::cos(turn)});
      }
}

TEST(FaceShape, HasVolumeCentroidAndSecondMomentOfItsPieceInEveryDirection) {
  for_shapes([](const FaceShape<double>& shape, const Vec3& normal) {
    const double below = shape.reach_toward(normal), above = shape.reach_away(normal);
    EXPECT_EQ(above, shape.reach_toward(-normal));
    if (!(below + above > 0)) return;
    EXPECT_NEAR(shape.fraction_of_cut(below, normal), 0, 1e-9);
    EXPECT_NEAR(shape.fraction_of_cut(-above, normal), 1, 1e-9);
    const int steps = 400;
    const double step = (below + above) / steps;
    double first = 0, second = 0, moment = 0, last = 0;
    for (int k = steps; k-- > 0;) {
      const double at = -above + k * step, middle = at + step / 2;
      const double here = shape.fraction_of_cut(at, normal), part = here - last;
      EXPECT_GE(part, -1e-9);  // nowhere less than nothing
      EXPECT_NEAR(part, step * shape.section_of_cut(middle, normal), 1e-5);
      first += middle * part;
      second += middle * middle * part;
      moment += middle * part;
      EXPECT_NEAR(shape.moment_of_cut(at, normal), moment, 1e-4 * (below + above));
      last = here;
    }
    const double square = normal.z * normal.z;
    EXPECT_NEAR(first, 0, 1e-4 * (below + above));
    EXPECT_NEAR(second, (shape.across + square * shape.along) / 5,
                1e-4 * (below + above) * (below + above));
  });
}

TEST(FaceShape, ChangesLittleWhereThePlaneTurnsALittle) {
  for_shapes([](const FaceShape<double>& shape, const Vec3& normal) {
    const double angle = std::atan2(normal.x, normal.z) + 1e-6;
    const Vec3 turned{std::sin(angle), 0, std::cos(angle)};
    for (double distance = -1; distance < 1; distance += 0.1)
      EXPECT_NEAR(shape.reach_toward(normal), shape.reach_toward(turned), 2e-6);
  });
}

// Damaged models may have such shapes, too: what rounding leaves of them is no reason for sums to
// overflow.
TEST(FaceShape, CountsAtMostWholeHoweverThinItIs) {
  for (const double thin : {0x1p-11, 1e-3, 0.02})
    for (const double away : {1.0, 1.001, 2.0})
      for (const double long_axis : {1.0, 1 + 5e-7}) {
        const double toward = thin, far = away * thin;
        const double along =
            std::max(far, std::sqrt((1 + 1e-6) * 5 * most_variance_at_face(toward, far)));
        const FaceShape<double> shape = face_of({0, 0, long_axis}, toward, far, along, 1.0);
        for (double turn = 0; turn < 3.2; turn += 0.01) {
          const Vec3 normal{std::sin(turn), 0, std::cos(turn)};
          for (double at = -1; at <= 1; at += 0.05) {
            const double distance =
                at * (at < 0 ? shape.reach_away(normal) : shape.reach_toward(normal));
            const double fraction = fraction_behind(shape, distance, normal);
            ASSERT_TRUE(fraction >= 0 && fraction <= 1) << thin << " " << turn << " " << at;
          }
        }
      }
}

TEST(PieceShape, OfASampleIsTheBallOfItsRadiusOrTheShapeOfItsFace) {
  CellSample sample;
  sample.radius = 0.25F;
  const PieceShape ball = shape_of(sample, {});
  EXPECT_EQ(ball.reach_toward(Vec3{0, 0, 1}), 0.25);
  EXPECT_EQ(fraction_behind(ball, 0.0, Vec3{0, 0, 1}), 0.5);
  // A cap as high as half the radius holds 5 / 32 of a ball.
  EXPECT_NEAR(fraction_behind(ball, 0.125, Vec3{0, 0, 1}), 5.0 / 32, 1e-15);
  FaceRow rows[2];
  rows[1].set(2, sample, {0, {1, 0, 0}, 0.25F, 0.3F, 0.3F, 0.5F});
  sample.radius = -1 - (4 + 2);
  const PieceShape at_face = shape_of(sample, {rows});
  EXPECT_EQ(at_face.reach_toward(Vec3{-1, 0, 0}), 0.25);  // from outside of the face
  EXPECT_NEAR(at_face.reach_toward(Vec3{1, 0, 0}), double{0.3F}, 1e-15);
  EXPECT_EQ(at_face.reach_toward(Vec3{0, 1, 0}), 0.5);
  const Rotation turn{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}};  // of x to y, y to z, z to x
  const TurnedShape turned{at_face, turn};
  EXPECT_EQ(turned.reach_toward(Vec3{0, -1, 0}), 0.25);
  EXPECT_EQ(turned.fraction_of_cut(0.1, Vec3{0, -1, 0}),
            at_face.fraction_of_cut(0.1, Vec3{-1, 0, 0}));
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
