#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;
using testing::see;

constexpr double kEdge = 0.2;

QueryOptions solid() {
  QueryOptions options;
  options.shadows = Shadows::solid;
  return options;
}

// True for places in the scene "block" behind its front, which is 0.2 m wide at z = 1, or behind
// the wall at z = 1.5.
bool is_behind_what_is_seen(Vec3 x) {
  return x.z > 1.5 || (x.z > 1 && std::abs(x.x) < 0.1 * x.z && std::abs(x.y) < 0.1 * x.z);
}

double part_behind_what_is_seen(const std::vector<Vec3>& places, const Pose& pose) {
  const auto count = std::count_if(places.begin(), places.end(), [&](const Vec3& place) {
    return is_behind_what_is_seen(pose * place);
  });
  return static_cast<double>(count) / static_cast<double>(places.size());
}

TEST(SolidOccludedSpace, CountAllThatIsBehindTheImage) {
  const AnyBody cloud(see(synthetic::make_scene("block")));
  const ToolModel tool = lattice_cube(kEdge, 10, 3);
  const std::vector<Vec3> places = testing::places_in_cube(kEdge, 40);
  ToolQuery query(tool, solid()), near(tool, {});
  int hidden = 0;
  for (int k = 0; k < 300; ++k) {
    // The tool passes through the block, the space that it occludes, the gap beside it and the
    // wall.
    const Pose pose{generic_rotation(), {0.004 * (k % 75), 0.01, 0.95 + 0.15 * (k / 75)}};
    const Result r = query.run(cloud, pose);
    const double expected = part_behind_what_is_seen(places, pose);
    EXPECT_NEAR(r.volume_fraction, expected, 0.015) << k;  // a pixel is 2 mm wide
    EXPECT_LE(near.run(cloud, pose).volume, r.volume) << k;
    hidden += near.run(cloud, pose).volume_fraction < expected - 0.2;
  }
  EXPECT_GT(hidden, 50);
}

// Deep behind the front everything is pushed back to it, or out at the nearest side.
TEST(SolidOccludedSpace, PushToTheNearestPlaceThatIsSeen) {
  const AnyBody cloud(see(synthetic::make_scene("block")));
  const ToolModel tool = lattice_cube(0.05, 6, 3);
  const Result r = ToolQuery(tool, solid()).run(cloud, {generic_rotation(), {0.002, -0.003, 1.09}});
  EXPECT_NEAR(r.volume_fraction, 1, 1e-9);
  EXPECT_GT(dot(normalized_or_zero(r.wrench.force), Vec3{0, 0, -1}), std::cos(0.02));
}

// Without hidden places the results have the same bits.
TEST(SolidOccludedSpace, ChangeNothingNearTheSurface) {
  for (const char* scene : {"wall", "groove", "plate", "block"}) {
    const AnyBody cloud(see(synthetic::make_scene(scene)));
    const ToolModel tool = lattice_cube(kEdge, 8, 3);
    ToolQuery query(tool, solid()), near(tool, {});
    int contacts = 0;
    for (int k = 0; k < 40; ++k) {
      const Pose pose{generic_rotation(), {0.003 * k, 0.01, 0.8 + 0.006 * k}};
      const Result r = query.run(cloud, pose);
      contacts += r.boundary > 0;
      testing::expect_equal(near.run(cloud, pose), r);
    }
    EXPECT_GT(contacts, 10) << scene;
  }
}

TEST(SolidOccludedSpace, NeedNoMemoryOfPosesBefore) {
  const AnyBody cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kEdge, 6, 2);
  QueryOptions options = solid();
  ToolQuery alone(tool, options);
  options.coherent = true;
  ToolQuery query(tool, options);
  for (int k = 0; k <= 40; ++k) {
    const Pose pose{generic_rotation(), {0.01, 0, 0.85 + 0.02 * k}};
    const Result r = alone.run(cloud, pose);
    testing::expect_equal(r, query.run(cloud, pose));
    if (pose.translation.z > 1.2) {
      EXPECT_NEAR(r.volume_fraction, 1, 1e-9) << k;
    }
  }
}

TEST(SolidOccludedSpace, AreRefusedWhereTheyMeanNothing) {
  const ToolModel tool = lattice_cube(kEdge, 2, 2);
  const AnyBody cloud(without_camera(see(synthetic::make_scene("wall"))));
  ToolQuery query(tool, solid());
  EXPECT_THROW(query.run(cloud, Pose{}), Error);
  std::vector<Result> results(1);
  EXPECT_THROW(query.run(cloud, jobs_of(std::vector<Pose>(1)), results), Error);

  QueryOptions options = solid();
  options.measure = Measure::paper;
  EXPECT_THROW(ToolQuery(tool, options), Error);
}

}  // namespace
}  // namespace vpm
