#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/truth.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;
using testing::see;

constexpr double kToolEdge = 0.1, kStep = 0.002;

QueryOptions coherent() {
  QueryOptions options;
  options.coherent = true;
  return options;
}

// Returns poses of the cube that goes into the wall at 1 m until it is `deepest`, and comes back.
std::vector<Pose> through_the_wall(double deepest) {
  std::vector<Pose> path;
  const auto add = [&](double z) { path.push_back({generic_rotation(), {0.013, -0.008, z}}); };
  for (double z = 0.85; z < deepest; z += kStep) add(z);
  for (double z = deepest; z > 0.85; z -= kStep) add(z);
  return path;
}

TEST(CoherentPoses, StayInsideWhenTheToolHasPassedTheSurface) {
  const AnyBody cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kToolEdge, 6, 3);
  ToolQuery query(tool, coherent()), alone(tool, {});
  int near = 0, far = 0;  // poses wholly behind the wall, within the tool radius and beyond
  for (const Pose& pose : through_the_wall(1.6)) {
    const double z = pose.translation.z;
    const Result r = query.run(cloud, pose), seen_alone = alone.run(cloud, pose);
    if (seen_alone.boundary > 0 || z < 1) {
      EXPECT_TRUE(r == seen_alone) << z;  // the memory adds nothing
      continue;
    }
    EXPECT_NEAR(r.volume_fraction, 1, 1e-12) << z;
    EXPECT_NEAR(r.wrench.force.z, -r.volume, 1e-6 * r.volume);
    EXPECT_LE(seen_alone.volume, r.volume);
    near += seen_alone.volume > 0;
    if (z < 1 + 2 * tool.radius) continue;
    ++far;
    EXPECT_EQ(seen_alone.volume, 0) << z;
  }
  EXPECT_GT(near, 5);
  EXPECT_GT(far, 100);
}

TEST(CoherentPoses, ForgetWhenTold) {
  const AnyBody cloud(see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kToolEdge, 6, 3);
  ToolQuery query(tool, coherent());
  const std::vector<Pose> path = through_the_wall(1.3);
  for (std::size_t k = 0; k < path.size() / 2; ++k) query.run(cloud, path[k]);
  const Pose& deep = path[path.size() / 2];
  EXPECT_GT(query.run(cloud, deep).volume, 0);
  query.forget();
  EXPECT_EQ(query.run(cloud, deep).volume, 0);
}

// The tool is free behind an object, further from its front than the tool radius.
TEST(CoherentPoses, DoNotTakeTheHiddenForTheInside) {
  const synthetic::Scene scene = synthetic::make_scene("block");
  const AnyBody cloud(see(scene));
  const ToolModel tool = lattice_cube(0.05, 5, 3);
  ToolQuery query(tool, coherent()), alone(tool, {});
  for (double x = -0.4; x < 0.4; x += kStep) {
    const Pose pose{generic_rotation(), {x, 0.01, 1.25}};
    EXPECT_TRUE(query.run(cloud, pose) == alone.run(cloud, pose)) << x;
  }
}

// Places that count only because an object hides them, near its front, are not remembered when the
// tool moves away behind the object.
TEST(CoherentPoses, DoNotRememberWhatIsMerelyHidden) {
  const AnyBody cloud(see(synthetic::make_scene("block")));
  const ToolModel tool = lattice_cube(0.05, 5, 3);
  ToolQuery query(tool, coherent()), alone(tool, {});
  int hidden = 0;
  const auto expect_nothing_remembered = [&](Vec3 at) {
    const Pose pose{generic_rotation(), at};
    const Result r = query.run(cloud, pose);
    EXPECT_TRUE(r == alone.run(cloud, pose)) << at.x << ' ' << at.z;
    hidden += r.boundary == 0 && r.volume > 0;
  };
  for (double x = 0.25; x > 0; x -= kStep) expect_nothing_remembered({x, 0.01, 1.05});
  for (double z = 1.05; z < 1.3; z += kStep) expect_nothing_remembered({0, 0.01, z});
  EXPECT_GT(hidden, 50);
  EXPECT_EQ(query.run(cloud, {generic_rotation(), {0, 0.01, 1.3}}).volume, 0);
}

// A tool cuts a wall and then moves behind a hand in front of it. Places that count there only
// because the hand hides them are not remembered.
TEST(CoherentPoses, DoNotRememberWhatAnotherObjectHides) {
  DepthImage depth;
  depth.width = 160;
  depth.height = 120;
  for (std::uint32_t i = 0; i < depth.width * depth.height; ++i)
    depth.depth.push_back(i % depth.width < 80 ? 0.92F : 1.2F);
  const Camera camera{{131.25, 131.25, 79.5, 59.5}, 160, 120, {}};
  const AnyBody cloud(make_cloud(depth, camera, NormalOptions{}));
  const ToolModel tool = lattice_cube(0.2, 10, 2);
  ToolQuery query(tool, coherent()), alone(tool, {});
  int cut = 0, hidden = 0;
  const auto run = [&](double x, double z) {
    const Pose pose{generic_rotation(), {x, 0, z}};
    const Result r = query.run(cloud, pose), seen_alone = alone.run(cloud, pose);
    EXPECT_TRUE(r == seen_alone) << x << ' ' << z;
    cut += r.boundary > 0;
    hidden += r.boundary == 0 && r.volume > 0;
  };
  for (double x = 0.15; x > -0.25; x -= kStep) run(x, 1.19);
  for (double z = 1.19; z < 1.5; z += kStep) run(-0.25, z);
  EXPECT_GT(cut, 50);
  EXPECT_GT(hidden, 50);
  EXPECT_EQ(query.run(cloud, {generic_rotation(), {-0.25, 0, 1.5}}).volume, 0);
}

Cloud wall_at(double z) {
  synthetic::Scene scene = synthetic::make_scene("wall");
  scene.surface = synthetic::make_wall({0, 0, z}, {0, 0, -1});
  return see(scene);
}

// Shows a moving wall, a frame every 33 poses, and then a hand in front of the lens.
TEST(CoherentPoses, FollowFramesThatChange) {
  const ToolModel tool = lattice_cube(kToolEdge, 6, 3);
  ToolQuery query(tool, coherent());
  const std::vector<Pose> path = through_the_wall(1.4);
  AnyBody cloud(wall_at(1));
  std::size_t k = 0;
  for (; k < path.size() / 2; ++k) {
    if (k % 33 == 0) cloud = AnyBody(wall_at(1 + 0.01 * std::sin(0.05 * static_cast<double>(k))));
    query.run(cloud, path[k]);
  }
  EXPECT_NEAR(query.run(cloud, path[k]).volume_fraction, 1, 1e-12);
  EXPECT_EQ(query.run(AnyBody(wall_at(0.4)), path[k]).volume, 0);  // another wall is seen
  EXPECT_EQ(query.run(cloud, path[k]).volume, 0);                  // and the memory is gone
  EXPECT_EQ(query.run(AnyBody(wall_at(3)), path[k]).volume, 0);
}

// Returns the cloud of a small camera at `camera` that sees the plane of this z.
Cloud small_view(double z, const Pose& camera = {}) {
  synthetic::Scene scene = synthetic::make_scene("wall");
  scene.surface = synthetic::make_wall({0, 0, z}, {0, 0, -1});
  scene.camera = {{131.25, 131.25, 79.5, 59.5}, 160, 120, camera};
  return see(scene);
}

// Runs 33 queries for each frame, while a wall comes over the tool, passes it and goes back.
template <class MakeFrame>
void expect_right_in_a_moving_scene(const MakeFrame& make_frame) {
  constexpr int kQueriesPerFrame = 33;
  constexpr double kWallStep = 0.015;
  const ToolModel tool = lattice_cube(kToolEdge, 6, 3);
  ToolQuery query(tool, coherent()), alone(tool, {});
  int cut = 0, wholly_behind = 0, lost = 0, k = 0;
  const auto query_frame = [&](double z) {
    const AnyBody cloud(make_frame(z));
    for (int n = 0; n < kQueriesPerFrame; ++n, ++k) {
      const Pose pose{generic_rotation(), {0.01 * std::sin(0.03 * k), -0.008, 1}};
      const Result r = query.run(cloud, pose), seen_alone = alone.run(cloud, pose);
      if (seen_alone.boundary > 0 || z > 1) {
        ++cut;
        ASSERT_TRUE(r == seen_alone) << z << ' ' << n;
      } else {
        ++wholly_behind;
        lost += seen_alone.volume_fraction < 0.5;
        ASSERT_NEAR(r.volume_fraction, 1, 1e-12) << z << ' ' << n;
      }
    }
  };
  for (double z = 1.11; z > 0.89; z -= kWallStep) query_frame(z);
  for (double z = 0.89; z < 1.11; z += kWallStep) query_frame(z);
  EXPECT_GT(cut, 5 * kQueriesPerFrame);
  EXPECT_GT(wholly_behind, kQueriesPerFrame);
  EXPECT_GE(lost, kQueriesPerFrame);  // without the memory
}

TEST(CoherentPoses, AreRightInAMovingScene) {
  expect_right_in_a_moving_scene([](double z) { return small_view(z); });
}

TEST(CoherentPoses, AreRightInAMovingSceneOfPoints) {
  expect_right_in_a_moving_scene([](double z) { return without_camera(small_view(z)); });
}

// The memory holds places in the world, not pixels.
TEST(CoherentPoses, AreRightWhileTheCameraMoves) {
  expect_right_in_a_moving_scene([](double z) {
    const double angle = 2 * (z - 1);
    const Rotation turned =
        rotation_from_quaternion({0, std::sin(angle / 2), 0, std::cos(angle / 2)});
    return small_view(z, {turned, {-0.3 * angle, 0.2 * angle, 0.1 * angle}});
  });
}

// Earlier frames' knowledge of a tool deep inside ends with the frame that shows the tool to be
// free, or shows nothing; no later frame brings it back.
TEST(CoherentPoses, StateEndsWithTheFrameThatContradictsIt) {
  const ToolModel tool = lattice_cube(kToolEdge, 6, 3);
  const AnyBody wall(small_view(1)), far_wall(small_view(2)), hand(small_view(0.4)),
      nothing(small_view(-1));
  const Pose deep{generic_rotation(), {0, 0, 1.2}};
  ASSERT_GT(wall.positions().size(), 0u);
  ASSERT_EQ(nothing.positions().size(), 0u);
  for (const AnyBody* other : {&far_wall, &hand, &nothing}) {
    ToolQuery query(tool, coherent());
    for (double z = 0.85; z < 1.2; z += kStep) query.run(wall, {generic_rotation(), {0, 0, z}});
    ASSERT_NEAR(query.run(wall, deep).volume_fraction, 1, 1e-12);
    EXPECT_EQ(query.run(*other, deep).volume, 0);
    EXPECT_EQ(query.run(*other, deep).volume, 0);
    EXPECT_EQ(query.run(wall, deep).volume, 0);
  }
}

// A wall that jumps over the tool within a frame was not seen to pass it.
TEST(CoherentPoses, DoNotTakeAnObjectThatAppearsForTheOneBefore) {
  const ToolModel tool = lattice_cube(kToolEdge, 6, 3);
  ToolQuery query(tool, coherent());
  const Pose pose{generic_rotation(), {0, 0, 1}};
  EXPECT_EQ(query.run(AnyBody(small_view(1.2)), pose).volume, 0);
  EXPECT_EQ(query.run(AnyBody(small_view(0.8)), pose).volume, 0);
}

TEST(CoherentPoses, AreRefusedWhereTheyMeanNothing) {
  const ToolModel tool = lattice_cube(kToolEdge, 2, 2);
  QueryOptions options = coherent();
  options.measure = Measure::paper;
  EXPECT_THROW(ToolQuery(tool, options), Error);
}

}  // namespace
}  // namespace vpm
