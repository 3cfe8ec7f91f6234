// A device takes any body of the scene, with the bits of the CPU.

#include "tests/cuda/any_body.h"

#include <gtest/gtest.h>

#include "libvpm/backend/cpu/measure_refined.h"
#include "libvpm/device/device.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::below;
using testing::Both;
using testing::HalfSpace;

template <class Body>
void expect_same(const Body& body) {
  if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  for (const ToolModel& tool :
       {testing::lattice_cube(0.2, 5, 3), testing::lattice_cube(0.2, 9, 1)}) {
    RefinedMeasure measure(tool, tool.levels.back(), {});
    for (const double z : {-0.06, 0.02, 0.09}) {
      const Pose pose{testing::generic_rotation(), {0.01, -0.02, z}};
      const BodySum expected = measure.run_on(body, Pose{}, pose);
      ASSERT_GT(expected.boundary, 0U);
      EXPECT_EQ(expected, testing::run_on_device(tool, body, pose));
    }
  }
}

TEST(AnyBodyOnDevice, AHalfSpace) {
  expect_same(below({0.2, -0.3, 0.9}, 0.01));
}

TEST(AnyBodyOnDevice, OneThatTellsInside) {
  expect_same(testing::seen_below({0.2, -0.3, 0.9}, 0.01));
}

TEST(AnyBodyOnDevice, OneThatSeesFreeSpace) {
  expect_same(testing::Step{below({0.2, -0.3, 0.9}, 0.01).top, {{1, 0, 0}, {0.03, 0, 0}}});
}

TEST(AnyBodyOnDevice, TwoAtOnePlace) {
  expect_same(Both<HalfSpace, HalfSpace>{below({0.2, -0.3, 0.9}, 0.01), below({1, 0.1, 0}, 0.02)});
}

}  // namespace
}  // namespace vpm
