#include "libvpm/model/tool_model.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "tests/formats/golden_content.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

TEST(ToolModel, LevelsAreFoundBySphereCount) {
  const ToolModel model = golden::cube_model();
  EXPECT_EQ(model.level(4).sphere_count, 4U);
  EXPECT_EQ(model.level(8).sphere_count, 8U);
  EXPECT_EQ(model.level(0).sphere_count, 8U) << "0 is the finest";
}

TEST(ToolModel, AMissingLevelIsWrongUsageAndTheLevelsAreListed) {
  const auto fault = test::fault_of([] { golden::cube_model().level(5); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->kind(), ErrorKind::invalid_argument);
  EXPECT_STREQ(fault->what(), "the tool model has no level of 5 spheres; it has 4, 8");
}

TEST(ToolModel, SoundModelsAreValid) {
  EXPECT_NO_THROW(validate(golden::cube_model(), "model"));
}

// The writer refuses the same content as the reader.
TEST(ToolModel, UnsoundModelsAreNotWritten) {
  const auto expect_refused = [](const char* defect, auto spoil) {
    ToolModel model = golden::cube_model();
    spoil(model);
    EXPECT_THROW(validate(model, "model"), Error) << defect;
    EXPECT_THROW(write_tool_model("/dev/null", model), Error) << defect;
  };
  expect_refused("no spheres", [](ToolModel& m) { m.spheres.clear(); });
  expect_refused("no levels", [](ToolModel& m) { m.levels.clear(); });
  expect_refused("no nodes", [](ToolModel& m) { m.levels[0].hierarchy.nodes.clear(); });
  expect_refused("no row offsets", [](ToolModel& m) { m.levels[0].graph.begin.clear(); });
  expect_refused("loop", [](ToolModel& m) { m.levels[0].graph.neighbors[0] = 0; });
  expect_refused("missing leaf", [](ToolModel& m) {
    m.levels[0].hierarchy.leaves.pop_back();
    --m.levels[0].hierarchy.nodes[1].end;
  });
  expect_refused("missing share", [](ToolModel& m) { m.levels[1].cell_volume.pop_back(); });
  expect_refused("orphaned samples", [](ToolModel& m) { m.levels[1].samples.push_back({}); });
  expect_refused("empty grid", [](ToolModel& m) { m.levels[1].grid.nz = 0; });
  expect_refused("sphere of another level", [](ToolModel& m) { m.levels[0].grid.spheres[3] = 5; });
}

}  // namespace
}  // namespace vpm
