// Bodies of a scene add up: exactly, in any order, on every way of asking.

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/query/level_tool_query.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

using testing::expect_equal;
using testing::see;

Pose pose_of(int k) {
  return {testing::generic_rotation(), {0.01, -0.02, 0.9 + 0.02 * k}};
}

class SceneOfBodies : public ::testing::Test {
 protected:
  const ToolModel tool_ = testing::lattice_cube(0.2, 8, 2);
  const AnyBody wall_{see(synthetic::make_scene("wall"))},
      ball_{see(synthetic::make_scene("ball"))},
      points_{without_camera(see(synthetic::make_scene("step")))};
};

TEST_F(SceneOfBodies, IsTheSumOverThem) {
  ToolQuery query(tool_, {});
  const std::vector<AnyBody> scene{wall_, ball_, points_};
  double most = 0;
  for (int k = 0; k < 10; ++k) {
    const Result all = query.run(scene, pose_of(k));
    Result sum;
    for (const AnyBody& body : scene) {
      const Result one = query.run(body, pose_of(k));
      sum.volume += one.volume;
      sum.wrench.force += one.wrench.force;
      sum.wrench.torque += one.wrench.torque;
      sum.boundary += one.boundary;
      sum.inside += one.inside;
    }
    EXPECT_NEAR(all.volume, sum.volume, 1e-15 * tool_.volume);
    EXPECT_NEAR(all.volume_fraction, all.volume / tool_.volume, 1e-15);
    EXPECT_LT(norm(all.wrench.force - sum.wrench.force), 1e-15 * tool_.volume);
    EXPECT_LT(norm(all.wrench.torque - sum.wrench.torque), 1e-15 * tool_.volume);
    EXPECT_EQ(all.boundary, sum.boundary);
    EXPECT_EQ(all.inside, sum.inside);
    most = std::max(most, all.volume_fraction);
  }
  EXPECT_GT(most, 1);  // a place in two bodies counts for both
}

TEST_F(SceneOfBodies, HasTheSameBitsInAnyOrder) {
  ToolQuery query(tool_, {});
  for (int k = 0; k < 10; ++k)
    expect_equal(query.run(std::vector<AnyBody>{wall_, ball_, points_}, pose_of(k)),
                 query.run(std::vector<AnyBody>{points_, wall_, ball_}, pose_of(k)));
}

// More than seven would not fit into the sums of one.
TEST_F(SceneOfBodies, MayBeMany) {
  ToolQuery query(tool_, {});
  const std::vector<AnyBody> many(50, wall_);
  const Pose pose = pose_of(8);
  const Result one = query.run(wall_, pose), all = query.run(many, pose);
  EXPECT_GT(one.volume_fraction, 0.5);
  EXPECT_NEAR(all.volume, 50 * one.volume, 1e-13 * tool_.volume);
  EXPECT_LT(norm(all.wrench.force - 50 * one.wrench.force), 1e-13 * tool_.volume);
}

TEST_F(SceneOfBodies, GivesASphereTheStrongestState) {
  ToolQuery query(tool_, {});
  const Pose pose = pose_of(6);
  query.run(wall_, pose);
  const std::vector<SphereState> at_wall(query.states().begin(), query.states().end());
  query.run(ball_, pose);
  const std::vector<SphereState> at_ball(query.states().begin(), query.states().end());
  query.run(std::vector<AnyBody>{wall_, ball_}, pose);
  int cut = 0, inside = 0;
  for (std::size_t k = 0; k < at_wall.size(); ++k) {
    const auto is = [&](SphereState state) { return at_wall[k] == state || at_ball[k] == state; };
    const SphereState expected = is(SphereState::boundary) ? SphereState::boundary
                                 : is(SphereState::inside) ? SphereState::inside
                                                           : SphereState::outside;
    EXPECT_EQ(query.states()[k], expected) << k;
    cut += expected == SphereState::boundary;
    inside += expected == SphereState::inside;
  }
  EXPECT_GT(cut, 0);
  EXPECT_GT(inside, 0);
}

TEST_F(SceneOfBodies, GivesTheSameInABatchAndAtALevel) {
  ToolQuery query(tool_, {});
  const std::vector<AnyBody> scene{wall_, points_};
  std::vector<Pose> poses;
  for (int k = 0; k < 5; ++k) poses.push_back(pose_of(k));
  std::vector<Result> batch(poses.size());
  query.run(scene, jobs_of(poses), batch);
  LevelToolQuery at_level(tool_, {}, {}, scene, poses[0]);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    expect_equal(query.run(scene, poses[k]), batch[k]);
    expect_equal(at_level.run(scene, poses[k]), batch[k]);
  }
}

// Each body has a memory of its own: a tool that has passed wholly into one stays inside of it.
TEST_F(SceneOfBodies, RemembersEachBodyOfAMotion) {
  ToolQuery alone(tool_, {.coherent = true}), both(tool_, {.coherent = true});
  for (int k = 0; k < 24; ++k) {
    const Pose pose = pose_of(k);
    const Result wall = alone.run(wall_, pose);
    const Result all = both.run(std::vector<AnyBody>{wall_, wall_}, pose);
    EXPECT_NEAR(all.volume, 2 * wall.volume, 1e-15 * tool_.volume) << k;
  }
}

TEST_F(SceneOfBodies, NeedsABody) {
  ToolQuery query(tool_, {});
  EXPECT_EQ(test::kind_of_fault([&] { query.run(std::span<const AnyBody>(), pose_of(0)); }),
            ErrorKind::invalid_argument);
}

}  // namespace
}  // namespace vpm
