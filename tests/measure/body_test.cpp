// The measure takes any body of the scene: for analytic ones it gives the volume of the tool's
// samples behind them, and the right wrench.

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/backend/cpu/measure_refined.h"
#include "tests/measure/analytic_bodies.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::below;
using testing::Both;
using testing::HalfSpace;

static_assert(MeasuredBody<DepthSurface> && SeesFreeSpace<DepthSurface> && BoundsGap<DepthSurface>);
static_assert(!HasOtherWalls<DepthSurface>);
static_assert(MeasuredBody<DiskSurface> && HasOtherWalls<DiskSurface>);
static_assert(!SeesFreeSpace<DiskSurface> && !BoundsGap<DiskSurface>);

constexpr double kEdge = 0.2;

// Returns the part of the tool's samples below a plane.
double part_behind(const ToolModel& tool, const Pose& pose, const TangentPlane& plane) {
  double part = 0;
  const NumberedSamples numbered = numbered_samples(tool.levels[0]);
  for (const CellSample& sample : numbered.samples) {
    const Vec3 at = pose * (tool.center_of_mass + widen(sample.center));
    const TurnedShape shape{shape_of(sample, numbered.faces()), pose.rotation};
    part += sample.weight * fraction_behind(shape, plane.distance(at), plane.normal);
  }
  return part;
}

// Asks a body whose frame is the world's.
class Asked {
 public:
  explicit Asked(const ToolModel& tool) : tool_(tool), measure_(tool, tool.levels[0], {}) {}
  template <class Body>
  Result operator()(const Body& body, const Pose& pose) {
    return result_of(measure_.run_on(body, Pose{}, pose), tool_, pose.rotation);
  }

 private:
  const ToolModel& tool_;
  RefinedMeasure measure_;
};

TEST(AnyBody, AHalfSpaceHoldsWhatOfTheToolIsBelowIt) {
  for (const ToolModel& tool :
       {testing::lattice_cube(kEdge, 6, 2), testing::lattice_cube(kEdge, 16, 1)}) {
    Asked answer(tool);
    for (double height = -0.2; height < 0.2; height += 0.013) {
      const HalfSpace body = below({0.2, -0.3, 0.9}, height);
      const Pose pose{testing::generic_rotation(), {0.01, -0.02, 0.03}};
      const Result result = answer(body, pose);
      const double expected = part_behind(tool, pose, body.top);
      // Where the plane cuts nothing, points alone cannot tell that the tool is inside.
      if (result.boundary == 0) continue;
      EXPECT_NEAR(result.volume_fraction, expected, 1e-12) << height;
      EXPECT_NEAR(norm(result.wrench.force - result.volume * body.top.normal), 0,
                  1e-12 * tool.volume);
    }
  }
}

// As far as the plane cuts the tool, what is behind it counts whether a flood decides or the body.
TEST(AnyBody, OneThatTellsInsideNeedsNoFlood) {
  for (const ToolModel& tool :
       {testing::lattice_cube(kEdge, 6, 2), testing::lattice_cube(kEdge, 16, 1)}) {
    Asked answer(tool);
    for (double height = -0.2; height < 0.2; height += 0.013) {
      const Pose pose{testing::generic_rotation(), {0.01, -0.02, 0.03}};
      const auto body = testing::seen_below({0.2, -0.3, 0.9}, height);
      const Result result = answer(body, pose);
      if (result.boundary == 0) continue;
      const double expected = part_behind(tool, pose, body.top);
      EXPECT_NEAR(result.volume_fraction, expected, 1e-12) << height;
    }
  }
}

TEST(AnyBody, WhatWasSeenFreeBehindAMeanPlaneIsFree) {
  const ToolModel tool = testing::lattice_cube(kEdge, 16, 1);
  Asked answer(tool);
  const testing::Step body{{{0, 0, 1}, {}}, {{1, 0, 0}, {}}};
  for (double x = -0.08; x < 0.08; x += 0.013) {
    const Result result = answer(body, {{}, {x, 0, 0}});
    const double expected = 0.5 * (0.5 * kEdge - x) / kEdge;
    EXPECT_NEAR(result.volume_fraction, expected, 1.0 / 16)
        << x;  // two layers of cells straddle the side
  }
}

TEST(AnyBody, TwoBodiesAtOnePlaceAreOne) {
  const ToolModel tool = testing::lattice_cube(kEdge, 8, 2);
  Asked answer(tool);
  const Pose pose{testing::generic_rotation(), {0.01, -0.02, 0.03}};
  for (double height = -0.1; height < 0.1; height += 0.021) {
    // Two cameras see one wall, and one errs by 4 mm: the lower surface shows free space.
    const HalfSpace near = below({0.2, -0.3, 0.9}, height),
                    far = below({0.2, -0.3, 0.9}, height - 0.004);
    const Result expected = answer(far, pose);
    const Result both = answer(Both<HalfSpace, HalfSpace>{near, far}, pose);
    const Result turned = answer(Both<HalfSpace, HalfSpace>{far, near}, pose);
    EXPECT_NEAR(both.volume_fraction, expected.volume_fraction, 1e-12);
    EXPECT_EQ(both.volume, turned.volume);
    EXPECT_EQ(both.wrench, turned.wrench);
  }
}

TEST(AnyBody, AnEdgeIsCutByBothItsFaces) {
  const ToolModel tool = testing::lattice_cube(kEdge, 20, 2);
  Asked answer(tool);
  const Both<HalfSpace, HalfSpace> edge{below({0, 0, 1}, 0.02), below({1, 0, 0}, -0.03)};
  const Result result = answer(edge, Pose{});
  EXPECT_NEAR(result.volume, kEdge * (0.5 * kEdge + 0.02) * (0.5 * kEdge - 0.03),
              0.002 * tool.volume);
}

}  // namespace
}  // namespace vpm
