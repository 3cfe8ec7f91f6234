// Options that leave out results which nobody asks for.
#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/query/query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::see;

TEST(QueryOptions, WithoutPointsEverythingElseStays) {
  const Cloud seen = see(synthetic::make_scene("step"));
  const ToolModel tool = testing::lattice_cube(0.2, 6, 4);
  for (const bool camera : {true, false}) {
    const PreparedCloud cloud(camera ? seen : without_camera(seen));
    for (const Measure measure : {Measure::refined, Measure::paper}) {
      Query with(tool, {.measure = measure}),
          without(tool, {.measure = measure, .counts_points = false});
      for (const double z : {0.7, 0.9, 0.96, 1.0}) {
        const Pose pose{testing::generic_rotation(), {0.01, 0.02, z}};
        Result counted = with.run(cloud, pose);
        const Result result = without.run(cloud, pose);
        EXPECT_TRUE(counted.points.has_value());
        EXPECT_FALSE(result.points.has_value());
        counted.points.reset();
        testing::expect_equal(counted, result);
      }
    }
  }
}

TEST(QueryOptions, NoDeviceStandsByForLongerThanASecond) {
  const ToolModel tool = testing::lattice_cube(0.2, 2, 1);
  EXPECT_NO_THROW(const Query query(tool, {.standby_us = QueryOptions::kLongestStandby}));
  try {
    const Query query(tool, {.standby_us = QueryOptions::kLongestStandby + 1});
    FAIL() << "stands by for too long";
  } catch (const Error& fault) {
    EXPECT_EQ(fault.kind(), ErrorKind::usage);
  }
}

}  // namespace
}  // namespace vpm
