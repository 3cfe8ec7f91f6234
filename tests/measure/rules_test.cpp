// The rules of the measure that backends only schedule, each by its name.

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/measure/body_sum.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/measure/classify.h"
#include "libvpm/measure/flood_rules.h"
#include "libvpm/scene/depth/depth_surface.h"
#include "libvpm/scene/mean_plane.h"
#include "libvpm/scene/points/disk_surface.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

ToolSum sum_of(double part) {
  ToolSum sum;
  sum.add(part, {0, 0, 1}, {0.5, 0, 0});
  return sum;
}

TEST(Counts, WhatHasAVolumeThatTheSumsResolve) {
  EXPECT_FALSE(counts(ToolSum{}));
  EXPECT_FALSE(counts(sum_of(0x1p-62)));
  EXPECT_TRUE(counts(sum_of(0x1p-60)));
}

TEST(ClassOfResult, IsCutIfTheSurfacePassesElsePartialIfAnythingIsBehindIt) {
  CellResult result;
  EXPECT_EQ(class_of_result(result), CellClass::free);
  result.is_far = true;  // may be inside, if a plane supports it
  EXPECT_EQ(class_of_result(result), CellClass::partial);
  result.is_far = false;
  result.sum = sum_of(0.1);
  EXPECT_EQ(class_of_result(result), CellClass::partial);
  result.plane.add({0, 0, 1}, {});
  EXPECT_EQ(class_of_result(result), CellClass::cut);
}

TEST(SideOfCells, IsThatOfTheClusterUnlessTheSurfacePasses) {
  EXPECT_EQ(side_of_cells(ClusterClass::free), Side::free);
  for (const ClusterClass found :
       {ClusterClass::behind, ClusterClass::behind_near, ClusterClass::uniform})
    EXPECT_EQ(side_of_cells(found), Side::behind);
  for (const ClusterClass found : {ClusterClass::no_surface, ClusterClass::by_middle})
    EXPECT_EQ(side_of_cells(found), Side::no_surface);
  for (const ClusterClass found : {ClusterClass::ambiguous, ClusterClass::cut})
    EXPECT_EQ(side_of_cells(found), Side::ambiguous);
}

TEST(ClassOnSide, IsWholeBehindTheSurface) {
  EXPECT_EQ(class_on_side(Side::free), CellClass::free);
  EXPECT_EQ(class_on_side(Side::behind), CellClass::whole);
  EXPECT_EQ(class_on_side(Side::no_surface), CellClass::no_surface);
}

TEST(FloodStateOf, IsClosedToWhatIsFreeAndNearWhereNothingIsFurther) {
  EXPECT_EQ(flood_state_of(ClusterClass::free), FloodState::closed);
  EXPECT_EQ(flood_state_of(ClusterClass::no_surface), FloodState::unknown);
  EXPECT_EQ(flood_state_of(ClusterClass::behind), FloodState::unknown);
  EXPECT_EQ(flood_state_of(ClusterClass::by_middle), FloodState::middle);
  EXPECT_EQ(flood_state_of(ClusterClass::behind_near), FloodState::near);
  EXPECT_EQ(flood_state_of(ClusterClass::uniform), FloodState::near);
  EXPECT_EQ(flood_state_of(ClusterClass::cut), FloodState::planar);
}

// Pushes what is before the plane nowhere, what it cuts along the plane's normal, and what is
// behind along the way out: its own, or that of its neighbours where bodies search for it.
template <class Body>
void expect_ways(WayOut of_sample) {
  const Body body{};
  const CellMeasure<Body> measure(body, Pose{}, ToolRadius(0.1, Shadows::near), CellView{});
  CellSample sample;
  sample.radius = 0.01F;
  const ToolPiece piece = piece_of(sample, {});
  const auto way = [&](double distance, bool is_sample) {
    const SurfaceSample on_surface{true, distance, {0, 0, 1}, {}};
    return measure.way_out(measure.sample_of(piece, {}, on_surface), is_sample);
  };
  for (const bool is_sample : {false, true}) {
    EXPECT_EQ(way(0.02, is_sample), WayOut::none);
    EXPECT_EQ(way(0.005, is_sample), WayOut::sampled);
    EXPECT_EQ(way(-0.005, is_sample), WayOut::sampled);
    EXPECT_EQ(way(-0.2, is_sample), WayOut::own);  // far
  }
  EXPECT_EQ(way(-0.05, false), WayOut::own);
  EXPECT_EQ(way(-0.05, true), of_sample);
  EXPECT_EQ(measure.way_out(measure.sample_of(piece, {}, {}), true), WayOut::none);
}
TEST(WayOut, IsSharedBySamplesOfABodyThatSearches) {
  expect_ways<DepthSurface>(WayOut::shared);
  expect_ways<DiskSurface>(WayOut::own);
  EXPECT_TRUE(is_searched(WayOut::own) && is_searched(WayOut::shared));
  EXPECT_FALSE(is_searched(WayOut::none) || is_searched(WayOut::sampled));
}

TEST(MeanOfFive, IsAsHighAsTheMeanOfAParaboloidOverABoxInTheBall) {
  struct Paraboloid {  // about the z axis, z = -curve (x^2 + y^2) / 2
    double curve;
    SurfaceSample sample(Vec3 x) const {
      const double below = 0.5 * curve * (x.x * x.x + x.y * x.y);
      const Vec3 foot{x.x, x.y, -below};
      return {true, x.z + below, normalized_or_zero({curve * x.x, curve * x.y, 1}), foot};
    }
  };
  constexpr double kCurve = 0.5, kRadius = 0.1;
  TangentPlane plane;
  ASSERT_TRUE(mean_of_five(Paraboloid{kCurve}, {0, 0, 0.02}, kRadius, 0.9, SampleInTurn{}, plane));
  EXPECT_NEAR(plane.normal.z, 1, 1e-12);
  // A cube in the ball has sides of 2 r / sqrt(3), over which x^2 + y^2 is 2 r^2 / 9 in the mean.
  EXPECT_NEAR(plane.foot.z, -0.5 * kCurve * 2 * kRadius * kRadius / 9,
              0.03 * 0.5 * kCurve * kRadius * kRadius);
  EXPECT_FALSE(mean_of_five(Paraboloid{20}, {0, 0, 0.02}, kRadius, 0.9, SampleInTurn{}, plane));
}

TEST(WholePart, IsACompactCellOnceElseEachOfItsBlocks) {
  for (const bool has_block : {true, false}) {
    EXPECT_EQ(whole_part(true, true, has_block), WholePart::cell);
    EXPECT_EQ(whole_part(true, false, has_block), WholePart::nothing);
    for (const bool is_first : {true, false})
      EXPECT_EQ(whole_part(false, is_first, has_block),
                has_block ? WholePart::block : WholePart::nothing);
  }
}

TEST(Enters, NearASheetOrBehindTheCutCellsPlane) {
  const auto asked = [](bool& is_asked, bool answer) {
    return [&is_asked, answer] {
      is_asked = true;
      return answer;
    };
  };
  constexpr double kReach = 0.01, kNear = kSheetReach * 2 * kReach;
  bool is_asked = false;
  EXPECT_TRUE(enters(kNear * kNear, kReach, kReach, asked(is_asked, false)));
  EXPECT_FALSE(is_asked);  // planes are asked only where they matter
  EXPECT_FALSE(enters(1.01 * kNear * kNear, kReach, kReach, asked(is_asked, false)));
  EXPECT_TRUE(is_asked);
  EXPECT_TRUE(enters(HUGE_VAL, kReach, kReach, asked(is_asked, true)));
}

TEST(Passes, WhatNothingElseMayHideOrWhatThePlaneHasBehindIt) {
  bool is_asked = false;
  const auto ask = [&] {
    is_asked = true;
    return false;
  };
  EXPECT_TRUE(passes(false, ask));
  EXPECT_FALSE(is_asked);
  EXPECT_FALSE(passes(true, ask));
  EXPECT_TRUE(passes(true, [] { return true; }));
}

TEST(IsHiddenCell, FromTheToolsRadiusOnAndWhereNothingWasMeasured) {
  EXPECT_FALSE(is_hidden_cell(0.04, 0.2));
  EXPECT_TRUE(is_hidden_cell(0.0401, 0.2));
  EXPECT_TRUE(is_hidden_cell(squared_gap({}), 0.2));
}

TEST(IsNearerCut, ByDistanceThenByIndex) {
  EXPECT_TRUE(is_nearer_cut(1, 9, 2, 3));
  EXPECT_FALSE(is_nearer_cut(2, 3, 1, 9));
  EXPECT_TRUE(is_nearer_cut(1, 3, 1, 9));
  EXPECT_FALSE(is_nearer_cut(1, 9, 1, 3));
}

TEST(SideInCutCluster, IsFreeWhereItsOwnPixelsSaySo) {
  int asked = 0;
  const auto is_free = [&](bool answer) {
    return [&asked, answer] {
      ++asked;
      return answer;
    };
  };
  EXPECT_EQ(side_in_cut_cluster(2, 1, is_free(true)), PlaneSide::before);
  EXPECT_EQ(asked, 0);  // the plane has freed it
  EXPECT_EQ(side_in_cut_cluster(-2, 1, is_free(true)), PlaneSide::before);
  EXPECT_EQ(side_in_cut_cluster(-2, 1, is_free(false)), PlaneSide::behind);
  EXPECT_EQ(side_in_cut_cluster(0, 1, is_free(false)), PlaneSide::cut);
}

// A body's sum cannot pass the tool's volume by more than rounding; that of a scene may, by bodies.
TEST(SceneSum, AddsBodiesExactlyInAnyOrder) {
  const ToolModel tool = testing::lattice_cube(0.2, 2, 1);
  BodySum whole, third;
  whole.sum = sum_of(1);
  third.sum = sum_of(1.0 / 3);
  SceneSum one, other;
  for (int k = 0; k < 20; ++k) one.add(k % 2 == 0 ? whole : third);
  for (int k = 0; k < 20; ++k) other.add(k < 10 ? third : whole);
  const Result a = one.result(tool, {}), b = other.result(tool, {});
  EXPECT_EQ(a, b);
  EXPECT_NEAR(a.volume_fraction, 10 + 10.0 / 3, 1e-14);
  BodySum too_much;
  too_much.sum = sum_of(1 + 1e-9);
  EXPECT_EQ(result_of(too_much, tool, {}).volume_fraction, 1);
}

}  // namespace
}  // namespace vpm
