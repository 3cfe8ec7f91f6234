// The algorithm as printed gives the volume, counts and states of the CPU's printed measure.

#include "tools/bench/paper_baseline.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libvpm/query/tool_query.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

// Returns poses deeper and deeper, turned by no simple angle.
Pose pose_of(int k, int count) {
  const double depth = static_cast<double>(k) / count;
  return {testing::generic_rotation(), {0.02 * depth, -0.03 * depth, 0.85 + 0.25 * depth}};
}

// Number of poses with spheres of each kind.
struct Met {
  int boundary = 0, inside = 0;
};

Met expect_same(const PreparedCloud& cloud, const ToolModel& tool, int poses,
                bench::Traversals traversals) {
  QueryOptions options;
  options.measure = Measure::paper;
  ToolQuery on_cpu(tool, options);
  const auto baseline = bench::make_paper_baseline(tool, on_cpu.level(), cloud, traversals, 0);
  Met met;
  for (int k = 0; k < poses; ++k) {
    SCOPED_TRACE(k);
    const Result expected = on_cpu.run(cloud, pose_of(k, poses));
    const Result result = baseline->run(pose_of(k, poses));
    EXPECT_EQ(expected.volume, result.volume);
    EXPECT_EQ(expected.boundary, result.boundary);
    EXPECT_EQ(expected.inside, result.inside);
    EXPECT_EQ(expected.points, result.points);
    EXPECT_TRUE(std::ranges::equal(on_cpu.states(), baseline->states()));
    met.boundary += expected.boundary > 0;
    met.inside += expected.inside > 0;
  }
  return met;
}

class PaperBaseline : public ::testing::Test {
 protected:
  void SetUp() override {
    if (cuda_device_count() == 0) GTEST_SKIP() << "no CUDA device here";
  }
};

void expect_what_the_measure_finds(bench::Traversals traversals) {
  for (const char* scene : {"wall", "groove", "block"}) {
    SCOPED_TRACE(scene);
    const PreparedCloud cloud(testing::see(synthetic::make_scene(scene)));
    Met met;
    for (const ToolModel& tool :
         {testing::lattice_cube(0.2, 9, 1), testing::lattice_cube(0.25, 20, 1)}) {
      const Met here = expect_same(cloud, tool, 24, traversals);
      met.boundary += here.boundary;
      met.inside += here.inside;
    }
    EXPECT_GT(met.boundary, 8);
    EXPECT_GT(met.inside, 8);
  }
}

TEST_F(PaperBaseline, FindsWhatTheMeasureAsPrintedFinds) {
  expect_what_the_measure_finds(bench::Traversals::in_one_kernel);
}

TEST_F(PaperBaseline, FindsTheSameByTraversalsThatTheDeviceLaunches) {
  expect_what_the_measure_finds(bench::Traversals::launched);
}

// Is small enough for compute-sanitizer.
TEST_F(PaperBaseline, SmallQuery) {
  const PreparedCloud cloud(testing::see(synthetic::make_scene("wall")));
  const ToolModel tool = testing::lattice_cube(0.2, 4, 1);
  EXPECT_GT(expect_same(cloud, tool, 4, bench::Traversals::in_one_kernel).boundary, 1);
  EXPECT_GT(expect_same(cloud, tool, 4, bench::Traversals::launched).boundary, 1);
}

TEST_F(PaperBaseline, InAnEmptyCloud) {
  const PreparedCloud cloud{Cloud{}};
  const ToolModel tool = testing::lattice_cube(0.2, 4, 1);
  expect_same(cloud, tool, 1, bench::Traversals::in_one_kernel);
  expect_same(cloud, tool, 1, bench::Traversals::launched);
}

}  // namespace
}  // namespace vpm
