// Tests that options change no more than they say.
#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::see;

TEST(QueryOptions, CountingPointsChangesNothingElse) {
  const Cloud seen = see(synthetic::make_scene("step"));
  const ToolModel tool = testing::lattice_cube(0.2, 6, 4);
  for (const bool camera : {true, false}) {
    const PreparedCloud cloud(camera ? seen : without_camera(seen));
    ToolQuery counting(tool, {.counts_points = true}), query(tool, {});
    for (const double z : {0.7, 0.9, 0.96, 1.0}) {
      const Pose pose{testing::generic_rotation(), {0.01, 0.02, z}};
      Result counted = counting.run(cloud, pose);
      EXPECT_TRUE(counted.points.has_value());
      counted.points.reset();
      testing::expect_equal(counted, query.run(cloud, pose));
    }
  }
}

TEST(QueryOptions, ThePrintedMeasureCountsPointsAnyway) {
  const PreparedCloud cloud(see(synthetic::make_scene("step")));
  const ToolModel tool = testing::lattice_cube(0.2, 6, 4);
  ToolQuery counting(tool, {.measure = Measure::paper, .counts_points = true}),
      query(tool, {.measure = Measure::paper});
  const Pose pose{testing::generic_rotation(), {0.01, 0.02, 0.96}};
  const Result result = query.run(cloud, pose);
  EXPECT_GT(result.points.value_or(0), 0U);
  testing::expect_equal(counting.run(cloud, pose), result);
}

}  // namespace
}  // namespace vpm
