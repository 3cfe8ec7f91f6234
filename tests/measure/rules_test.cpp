// The rules of the measure that backends only schedule, each by its name.

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/measure/body_sum.h"
#include "libvpm/measure/cell_measure.h"
#include "libvpm/measure/classify.h"
#include "libvpm/measure/flood_rules.h"
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
