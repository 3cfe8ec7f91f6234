// Tests that options change no more than they say.
#include <gtest/gtest.h>

#include "libvpm/query/tool_query.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::see;

TEST(QueryOptions, OnlyThePrintedMeasureCountsPoints) {
  const AnyBody cloud(see(synthetic::make_scene("step")));
  const ToolModel tool = testing::lattice_cube(0.2, 6, 4);
  const Pose pose{testing::generic_rotation(), {0.01, 0.02, 0.96}};
  EXPECT_GT(ToolQuery(tool, {.measure = Measure::paper}).run(cloud, pose).points.value_or(0), 0U);
  EXPECT_FALSE(ToolQuery(tool, {}).run(cloud, pose).points.has_value());
}

}  // namespace
}  // namespace vpm
