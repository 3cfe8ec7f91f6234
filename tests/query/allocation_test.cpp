// Control loops rely on queries that allocate no memory after the first one.
#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/core/parallel.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/counted_allocation.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

struct Case {
  const char* name;
  Measure measure;
  bool camera, coherent;
};

class Allocation : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override { set_thread_count(1); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(Allocation, NoneAfterTheFirstQuery) {
  const Case& tested = GetParam();
  const Cloud seen = testing::see(synthetic::make_scene("inverted-ball"));
  const AnyBody cloud(tested.camera ? seen : without_camera(seen));
  const ToolModel tool = testing::lattice_cube(0.2, 12, 2);
  ToolQuery query(tool, {.measure = tested.measure, .coherent = tested.coherent});
  const auto pose = [](int k) {  // moves from free space into contact
    return Pose{testing::generic_rotation(), {0.01, -0.02, 0.8 + 0.015 * k}};
  };
  EXPECT_EQ(query.run(cloud, pose(0)).volume, 0);
  const int before = testing::allocations();
  double most = 0;
  for (int k = 1; k < 16; ++k) most = std::max(most, query.run(cloud, pose(k)).volume);
  EXPECT_EQ(testing::allocations() - before, 0);
  EXPECT_GT(most, 0);
}

INSTANTIATE_TEST_SUITE_P(Measures, Allocation,
                         ::testing::Values(Case{"RefinedCamera", Measure::refined, true, false},
                                           Case{"RefinedPoints", Measure::refined, false, false},
                                           Case{"Coherent", Measure::refined, true, true},
                                           Case{"PaperCamera", Measure::paper, true, false}),
                         [](const ::testing::TestParamInfo<Case>& tested) {
                           return tested.param.name;
                         });

}  // namespace
}  // namespace vpm
