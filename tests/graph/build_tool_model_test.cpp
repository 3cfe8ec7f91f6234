#include "libvpm/graph/build_tool_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/model/tool_model.h"
#include "tests/graph/test_packing.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

GraphOptions with_levels(std::vector<std::uint32_t> levels) {
  GraphOptions options;
  options.levels = std::move(levels);
  return options;
}

Packing scaled(Packing packing, double by) {
  for (Vec3& v : packing.solid.vertices) v = by * v;
  for (Sphere& s : packing.spheres) s = {by * s.center, by * s.radius};
  return packing;
}

// Returns the model with all lengths multiplied.
ToolModel scaled(ToolModel m, double by) {
  const double cubed = by * by * by;
  const float narrow_by = static_cast<float>(by);
  m.volume *= cubed;
  m.center_of_mass = by * m.center_of_mass;
  m.radius *= by;
  for (Vec3& v : m.surface.vertices) v = by * v;
  for (Sphere& s : m.spheres) s = {by * s.center, by * s.radius};
  for (Level& level : m.levels) {
    level.epsilon *= by;
    for (HierarchyNode& n : level.hierarchy.nodes)
      n.bound = {by * n.bound.center, by * n.bound.radius};
    level.grid.low = by * level.grid.low;
    level.grid.cell *= by;
    for (double& v : level.cell_volume) v *= cubed;
    for (Vec3& g : level.cell_centroid) g = by * g;
    for (double& r : level.cell_radius) r *= by;
    for (CellBlock& b : level.blocks) {
      b.center = narrow(by * widen(b.center));
      b.radius *= narrow_by;
    }
    for (CellSample& s : level.samples) {
      s.center = narrow(by * widen(s.center));
      s.radius *= narrow_by;
    }
    for (SampleFace& face : level.faces)
      for (float* const extent : {&face.toward, &face.away, &face.along, &face.across})
        *extent *= narrow_by;
  }
  return m;
}

std::string bytes_of(const ToolModel& model) {
  const file::TemporaryFolder folder;
  write_tool_model(folder.path("model"), model);
  return test::text_of(folder.path("model"));
}

TEST(BuildToolModel, GivesTheSameBytesForAnyThreadCount) {
  const Packing packing = test::greedy_packing(test::torus(), 300, 40000);
  std::string first;
  for (const int threads : {1, 2, 8}) {
    set_thread_count(threads);
    const std::string bytes = bytes_of(build_tool_model(packing, with_levels({50})));
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes == first, true) << threads << " threads";
  }
  set_thread_count(0);
}

TEST(BuildToolModel, PowersOfTwoChangeExponentsOnly) {
  const Packing packing = test::greedy_packing(test::tetrahedron(), 200, 40000);
  const ToolModel model = build_tool_model(packing, {});
  for (const int exponent : {-40, -7, 1, 40}) {
    const double by = std::ldexp(1.0, exponent);
    ToolModel other = build_tool_model(scaled(packing, by), {});
    other.solid_hash = model.solid_hash;
    EXPECT_EQ(bytes_of(scaled(model, by)) == bytes_of(other), true) << "2^" << exponent;
  }
}

TEST(BuildToolModel, FarFromTheOriginIsTheSameTool) {
  Packing packing = test::greedy_packing(test::cube(), 100, 20000);
  const ToolModel near = build_tool_model(packing, {});
  const Vec3 far{1 << 20, -(1 << 18), 1 << 22};
  for (Vec3& v : packing.solid.vertices) v += far;
  for (Sphere& s : packing.spheres) s = {s.center + far, 0.999 * s.radius};
  const ToolModel there = build_tool_model(packing, {});
  EXPECT_NEAR(there.volume / near.volume, 1, 1e-7);
  EXPECT_LT(norm(there.center_of_mass - far - near.center_of_mass), 1e-8);
}

TEST(BuildToolModel, FillsSoundLevelsOfPrefixes) {
  const Packing packing = test::greedy_packing(test::octahedron(), 300, 40000);
  const ToolModel model = build_tool_model(packing, with_levels({100, 20, 100, 5000}));
  ASSERT_EQ(model.levels.size(), 3u);
  EXPECT_EQ(model.levels[0].sphere_count, 20u);
  EXPECT_EQ(model.levels[1].sphere_count, 100u);
  EXPECT_EQ(model.levels[2].sphere_count, 300u);
  EXPECT_EQ(model.levels[1].epsilon, 0.1 * packing.spheres[99].radius);
  EXPECT_NO_THROW(validate(model, "model"));
  for (const Level& level : model.levels) {
    double sum = 0;
    for (const double v : level.cell_volume) sum += v;
    EXPECT_NEAR(sum / model.volume, 1, 1e-12);
    EXPECT_EQ(level.bridges, level.components_before - 1);
  }
}

// Two cubes of edge 1 that overlap by a quarter of one: the surface bounds both together, once.
TEST(BuildToolModel, KeepsTheBoundaryOfWhatACrossingMeshEncloses) {
  Packing packing = test::greedy_packing(test::cube(), 1, 8000);
  const MassProperties one = mass_properties(packing.solid);
  const Solid cube = packing.solid;
  const double side = std::cbrt(one.volume);
  const auto first = static_cast<std::uint32_t>(cube.vertices.size());
  for (const Vec3& v : cube.vertices)
    packing.solid.vertices.push_back(v + side * Vec3{0.5, 0.5, 0.013});
  for (const auto& [a, b, c] : cube.triangles)
    packing.solid.triangles.push_back({a + first, b + first, c + first});
  const ToolModel model = build_tool_model(packing, {});
  EXPECT_NO_THROW(validate(model, "model"));
  ASSERT_FALSE(model.surface.triangles.empty());
  EXPECT_NEAR(mass_properties(model.surface).volume / one.volume, 2 - 0.25 * (1 - 0.013), 1e-12);
}

TEST(BuildToolModel, LeavesTheSurfaceOutIfAsked) {
  const Packing packing = test::greedy_packing(test::cube(), 10, 8000);
  GraphOptions options;
  options.surface = false;
  EXPECT_TRUE(build_tool_model(packing, options).surface.triangles.empty());
  EXPECT_EQ(build_tool_model(packing, {}).surface.triangles, packing.solid.triangles);
}

TEST(BuildToolModel, RefusesASolidThatIsOpen) {
  Packing packing = test::greedy_packing(test::cube(), 1, 8000);
  packing.solid.triangles.pop_back();
  EXPECT_NE(test::refusal([&] { build_tool_model(packing, {}); }).find("3 edges"),
            std::string::npos);
}

TEST(BuildToolModel, OneSphereIsATool) {
  const Packing packing = test::greedy_packing(test::cube(), 1, 8000);
  const ToolModel model = build_tool_model(packing, {});
  EXPECT_NO_THROW(validate(model, "model"));
  EXPECT_EQ(model.levels[0].graph.neighbors.size(), 0u);
}

TEST(BuildToolModel, RefusesWhatIsNoPacking) {
  const auto kind_of = [](const Packing& packing, const GraphOptions& options) {
    return test::kind_of_fault([&] { build_tool_model(packing, options); });
  };
  const Packing good = test::greedy_packing(test::cube(), 10, 1000);
  EXPECT_FALSE(kind_of(good, {}));
  Packing bad = good;
  bad.spheres.clear();
  EXPECT_EQ(kind_of(bad, {}), ErrorKind::refused);
  bad = good;
  std::swap(bad.spheres.front(), bad.spheres.back());
  EXPECT_EQ(kind_of(bad, {}), ErrorKind::refused);
  bad = good;
  for (Triangle& t : bad.solid.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(kind_of(bad, {}), ErrorKind::refused);
  bad = good;
  for (Sphere& s : bad.spheres) s.radius *= 2;
  EXPECT_EQ(kind_of(bad, {}), ErrorKind::refused);
  GraphOptions negative;
  negative.epsilon = -1;
  EXPECT_EQ(kind_of(good, negative), ErrorKind::invalid_argument);
  EXPECT_EQ(kind_of(good, with_levels({0})), ErrorKind::invalid_argument);
}

}  // namespace
}  // namespace vpm
