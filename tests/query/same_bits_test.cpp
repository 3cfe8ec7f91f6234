// The same input gives the same bits for any threads, order of points, points given twice, scale by
// a power of two, far origin and compiler.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "libvpm/core/parallel.h"
#include "libvpm/file/checksum.h"
#include "libvpm/file/stream.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/query/replay.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;
using testing::see;

struct Variant {
  const char* name;
  Measure measure;
  bool camera;
};

class SameBits : public ::testing::TestWithParam<Variant> {
 protected:
  Cloud cloud() const {
    const Cloud seen = see(synthetic::make_scene("inverted-ball"));
    return GetParam().camera ? seen : without_camera(seen);
  }
  std::vector<Result> sweep(const Cloud& cloud, const ToolModel& tool, double scale = 1,
                            Vec3 shift = {}) const {
    QueryOptions options;
    options.measure = GetParam().measure;
    options.interval = options.measure == Measure::refined;
    ToolQuery query(tool, options);
    const AnyBody prepared(cloud);
    std::vector<Result> results(12);
    for (int k = 0; k < 12; ++k) {
      results[k] = query.run(
          prepared, {generic_rotation(), scale * Vec3{0.01, -0.02, 0.84 + 0.015 * k} + shift});
    }
    return results;
  }
};

void expect_same(const std::vector<Result>& a, const std::vector<Result>& b, double scale = 1) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_GT(a.back().volume, 0);
  for (std::size_t k = 0; k < a.size(); ++k) {
    SCOPED_TRACE(k);
    testing::expect_equal(a[k], b[k], scale);
    if (a[k].volume_interval && a[k].boundary > 0) {
      EXPECT_GT(a[k].volume_interval->high, a[k].volume_interval->low);
    }
  }
}

// Rounds a pose as programs do that keep matrices in single precision.
Pose in_floats(const Pose& pose) {
  const auto rounded = [](Vec3 row) { return widen(narrow(row)); };
  const Rotation& r = pose.rotation;
  return {{rounded(r.row0), rounded(r.row1), rounded(r.row2)}, pose.translation};
}

TEST_P(SameBits, ForARoundedRotationAndTheNearestOne) {
  const ToolModel tool = lattice_cube(0.2, 6, 4);
  const AnyBody prepared(cloud());
  QueryOptions options;
  options.measure = GetParam().measure;
  ToolQuery query(tool, options);
  for (int k = 0; k < 12; ++k) {
    const Pose rounded = in_floats({generic_rotation(), {0.01, -0.02, 0.84 + 0.015 * k}});
    const Pose nearest{exact_rotation(rounded.rotation), rounded.translation};
    ASSERT_FALSE(rounded.rotation.row0 == nearest.rotation.row0);
    testing::expect_equal(query.run(prepared, nearest), query.run(prepared, rounded));
  }
}

TEST_P(SameBits, ForAnyNumberOfThreads) {
  const ToolModel tool = lattice_cube(0.2, 8, 2);
  const Cloud seen = cloud();
  set_thread_count(1);
  const std::vector<Result> one = sweep(seen, tool);
  for (const int threads : {2, 3, 7, 16}) {
    set_thread_count(threads);
    expect_same(one, sweep(seen, tool));
  }
  set_thread_count(0);
}

// Joins the lattice's spheres to one long line, which leads back and forth between two sides of the
// cube, and so does the flood.
ToolModel lattice_line(double edge, std::uint32_t n) {
  ToolModel tool = lattice_cube(edge, n, 2);
  SphereGraph& graph = tool.levels[0].graph;
  graph = {{0}, {}};
  const auto at = [n](std::uint32_t step) {
    const std::uint32_t x = step % n, y = step / n % n, z = step / (n * n);
    const std::uint32_t along_y = z % 2 == 0 ? y : n - 1 - y;
    return (z * n + along_y) * n + (step / n % 2 == 0 ? x : n - 1 - x);
  };
  const std::uint32_t count = n * n * n;
  std::vector<std::uint32_t> step_of(count);
  for (std::uint32_t step = 0; step < count; ++step) step_of[at(step)] = step;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (step_of[i] > 0) graph.neighbors.push_back(at(step_of[i] - 1));
    if (step_of[i] + 1 < count) graph.neighbors.push_back(at(step_of[i] + 1));
    std::sort(graph.neighbors.begin() + graph.begin.back(), graph.neighbors.end());
    graph.begin.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
  }
  return tool;
}

struct Step {
  Result result;
  std::vector<SphereState> states;
};
std::vector<Step> go_through(const AnyBody& cloud, const ToolModel& tool) {
  ToolQuery query(tool, {.coherent = true});
  std::vector<Step> steps(12);
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Pose pose{generic_rotation(), {0.01, -0.02, 0.84 + 0.03 * static_cast<double>(k)}};
    steps[k].result = query.run(cloud, pose);
    steps[k].states.assign(query.states().begin(), query.states().end());
  }
  return steps;
}

// The tools are so large that threads share the flood.
TEST(SameBitsOfAFlood, ForAnyNumberOfThreads) {
  const AnyBody cloud(see(synthetic::make_scene("inverted-ball")));
  for (const ToolModel& tool : {lattice_cube(0.2, 24, 2), lattice_line(0.2, 24)}) {
    set_thread_count(1);
    const std::vector<Step> one = go_through(cloud, tool);
    std::uint32_t most_cut = 0, most_inside = 0;
    for (const Step& step : one) {
      most_cut = std::max(most_cut, step.result.boundary);
      most_inside = std::max(most_inside, step.result.inside);
    }
    EXPECT_GT(most_cut, 500u);
    EXPECT_GT(most_inside, 5000u);
    for (const int threads : {2, 3, 5, 16}) {
      set_thread_count(threads);
      const std::vector<Step> steps = go_through(cloud, tool);
      for (std::size_t k = 0; k < one.size(); ++k) {
        EXPECT_TRUE(steps[k].result == one[k].result) << threads << ' ' << k;
        EXPECT_EQ(steps[k].states, one[k].states) << threads << ' ' << k;
      }
    }
  }
  set_thread_count(0);
}

TEST_P(SameBits, ForAnyOrderOfThePoints) {
  const ToolModel tool = lattice_cube(0.2, 8, 2);
  expect_same(sweep(cloud(), tool), sweep(testing::permuted(cloud()), tool));
}

TEST_P(SameBits, IfEveryPointIsGivenTwice) {
  const ToolModel tool = lattice_cube(0.2, 8, 2);
  expect_same(sweep(cloud(), tool), sweep(testing::doubled(cloud()), tool));
}

ToolModel scaled(ToolModel tool, double s) {
  const float f = static_cast<float>(s);
  const auto stretch = [f](Vec3f& x) { x = {f * x.x, f * x.y, f * x.z}; };
  tool.volume *= s * s * s;
  tool.center_of_mass = s * tool.center_of_mass;
  tool.radius *= s;
  for (Sphere& sphere : tool.spheres) sphere = {s * sphere.center, s * sphere.radius};
  for (Level& level : tool.levels) {
    for (HierarchyNode& node : level.hierarchy.nodes)
      node.bound = {s * node.bound.center, s * node.bound.radius};
    level.grid.low = s * level.grid.low;
    level.grid.cell *= s;
    for (double& radius : level.cell_radius) radius *= s;
    for (CellBlock& block : level.blocks) stretch(block.center), block.radius *= f;
    for (CellSample& sample : level.samples) stretch(sample.center), sample.radius *= f;
    for (SampleFace& face : level.faces)
      for (float* const extent : {&face.toward, &face.away, &face.along, &face.across})
        *extent *= f;
  }
  return tool;
}

Cloud scaled(Cloud cloud, double s) {
  const float f = static_cast<float>(s);
  cloud.origin = s * cloud.origin;
  for (Vec3f& p : cloud.positions) p = {f * p.x, f * p.y, f * p.z};
  for (float& radius : cloud.radii) radius *= f;
  if (cloud.sensor) {
    cloud.sensor->camera.to_world.translation = s * cloud.sensor->camera.to_world.translation;
    for (float& depth : cloud.sensor->depth.depth) depth *= f;
  }
  return cloud;
}

TEST_P(SameBits, ExceptTheExponentForPowersOfTwo) {
  const ToolModel tool = lattice_cube(0.2, 8, 2);
  const std::vector<Result> plain = sweep(cloud(), tool);
  for (const int exponent : {-66, -40, -7, 1, 40, 66}) {
    // Of points so small the processor takes ten times as long: squares of floats are denormal.
    if (std::abs(exponent) > 60 && !cloud().sensor) continue;
    const double s = std::ldexp(1.0, exponent);
    expect_same(plain, sweep(scaled(cloud(), s), scaled(tool, s), s), s);
  }
}

TEST_P(SameBits, FarFromTheOriginToWhatDoubleHolds) {
  const ToolModel tool = lattice_cube(0.2, 8, 2);
  Cloud far = cloud();
  const Vec3 shift{1e7, -1e7, 1e7};
  far.origin += shift;
  if (far.sensor) far.sensor->camera.to_world.translation += shift;
  const std::vector<Result> near_results = sweep(cloud(), tool),
                            far_results = sweep(far, tool, 1, shift);
  for (std::size_t k = 0; k < near_results.size(); ++k) {
    EXPECT_NEAR(near_results[k].volume, far_results[k].volume, 1e-6 * tool.volume);
  }
}

// Shows a change of any bit of any result. For a change that is meant, renew the hash (target
// renew_replay_hash) and give the reason in the commit.
TEST(Replay, GivesTheBytesThatItAlwaysGave) {
  const std::vector<std::byte> text = file::read_all(VPM_SOURCE_DIR "/tests/query/replay.hash");
  const std::string recorded(reinterpret_cast<const char*>(text.data()), text.size());
  EXPECT_EQ(file::content_hash({testing::replay()}) + "\n", recorded);
}

INSTANTIATE_TEST_SUITE_P(Measures, SameBits,
                         ::testing::Values(Variant{"RefinedCamera", Measure::refined, true},
                                           Variant{"RefinedPoints", Measure::refined, false},
                                           Variant{"PaperCamera", Measure::paper, true},
                                           Variant{"PaperPoints", Measure::paper, false}),
                         [](const auto& variant) { return std::string(variant.param.name); });

}  // namespace
}  // namespace vpm
