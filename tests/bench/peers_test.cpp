// Peers are implemented fairly: refined, they come to the truth; what is meant to be faster gives
// the same answer.

#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/pose.h"
#include "libvpm/synthetic/render.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"
#include "libvpm/synthetic/shared_volume.h"
#include "libvpm/synthetic/truth.h"
#include "tools/bench/peers/fcl_pair.h"
#include "tools/bench/peers/shells.h"
#include "tools/bench/penetration_case.h"

namespace vpm::bench {
namespace {

std::shared_ptr<const DistanceField> field_of(const synthetic::Surface& surface, double voxel) {
  Box box;
  for (const double side : {-.09, .09}) box.add({side, side, 1 + side});
  return std::make_shared<const DistanceField>(box, voxel,
                                               [&](Vec3 x) { return surface.distance(x); });
}

// A torus with part of its tube in a scene.
class ShellBefore : public testing::TestWithParam<const char*> {
 protected:
  PeerAnswer answer(double spacing, double voxel, ShellWalk walk, double deadline = 0) const {
    ShellPeer peer(std::make_shared<const PointShell>(tool_, spacing),
                   field_of(*scene_.surface, voxel), walk, deadline);
    return peer.query(pose_);
  }

  const synthetic::Scene scene_ = synthetic::make_scene(GetParam());
  const Solid tool_ = synthetic::make_torus(.04, .02, 48, 32);
  const Pose pose_{turned(), {.01, -.02, .98}};
};
INSTANTIATE_TEST_SUITE_P(Scenes, ShellBefore, testing::Values("wall", "tilted-wall", "ball"),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(ShellBefore, HasForcesThatConvergeToTheTruth) {
  const synthetic::TrueSolid tool(tool_);
  const synthetic::Penetration truth = tool.penetration(pose_, *scene_.surface);
  ASSERT_GT(truth.volume, .02 * tool.mass().volume);
  const auto error = [&](int parts) {
    const PeerAnswer a = answer(tool.radius() / parts, tool.radius() / 30, ShellWalk::flat);
    return std::max(norm(a.wrench.force - truth.force),
                    norm(a.wrench.torque - truth.torque) / tool.radius()) /
           norm(truth.force);
  };
  const double coarse = error(6), fine = error(100);
  EXPECT_LT(coarse, .2);
  EXPECT_LT(fine, .005);
  EXPECT_LT(fine, .2 * coarse);
}

TEST_P(ShellBefore, HasTheSameContactsInATree) {
  for (const double spacing : {.01, .002}) {
    const PeerAnswer flat = answer(spacing, .002, ShellWalk::flat),
                     tree = answer(spacing, .002, ShellWalk::tree),
                     levels = answer(spacing, .002, ShellWalk::nested, 1e9);
    EXPECT_GT(flat.contacts, 10U);
    for (const PeerAnswer& other : {tree, levels}) {
      EXPECT_EQ(other.contacts, flat.contacts);
      EXPECT_NEAR(other.volume, flat.volume, 1e-4 * flat.volume);
      EXPECT_LT(norm(other.wrench.force - flat.wrench.force), 1e-4 * norm(flat.wrench.force));
    }
  }
}

// Out of time, few points stand for many: the answer is rough, but it is one.
TEST_P(ShellBefore, AnswersByItsCoarseLevelsOutOfTime) {
  const PeerAnswer fine = answer(.002, .002, ShellWalk::flat),
                   rough = answer(.002, .002, ShellWalk::nested, 0);
  EXPECT_LT(rough.contacts, fine.contacts / 4);
  EXPECT_FALSE(std::isnan(rough.wrench.force.x));
}

TEST(PointShell, HasThePlanesVolumeAndTheToolsArea) {
  const Solid cube = synthetic::make_cube(.1);
  const auto shell = std::make_shared<const PointShell>(cube, .004);
  double area = 0;
  for (const PointShell::Point& p : shell->points()) area += norm(widen(p.area));
  EXPECT_NEAR(area, .06, 1e-6);
  EXPECT_LT(shell->points().size(), 1.3 * .06 / (.004 * .004));
  ShellPeer peer(shell, field_of(*synthetic::make_scene("wall").surface, .005), ShellWalk::tree);
  EXPECT_NEAR(peer.query({{}, {0, 0, .98}}).volume, .1 * .1 * .03, 1e-3 * .1 * .1 * .1);
  EXPECT_EQ(peer.query({{}, {0, 0, .94}}).volume, 0);
}

TEST(DistanceField, OfPointsIsThatOfTheirSurface) {
  for (const char* name : {"tilted-wall", "ball"}) {
    const synthetic::Scene scene = synthetic::make_scene(name);
    const Cloud cloud =
        make_cloud(synthetic::render(*scene.surface, scene.camera), scene.camera, NormalOptions{});
    Box box;
    for (const double side : {-.1, .1}) box.add({side, side, 1 + side});
    const DistanceField field = DistanceField::of_points(cloud, box, .004);
    const auto to_voxels = field.to_voxels({});
    for (const double x : {-.03, .0, .04})
      for (const double z : {.96, .99, 1.02, 1.05}) {
        const Vec3 place{x, .02, z};
        const auto [distance, gradient] = field.sample(to_voxels(narrow(place)));
        EXPECT_NEAR(distance, scene.surface->distance(place), 4e-4) << name << x << ' ' << z;
        EXPECT_GT(dot(widen(gradient), scene.surface->gradient(place)), .98) << name;
      }
  }
}

// Beside an edge the nearest points' normals do not tell the side.
TEST(DistanceField, HasNothingInsideWhereACameraSeesThatItIsFree) {
  const synthetic::Scene scene = synthetic::make_scene("block");
  const Cloud cloud = make_cloud(
      synthetic::render_with_kinect_noise(*scene.surface, scene.camera, 1), scene.camera, {});
  Box box;
  box.add({.02, .02, .9}), box.add({.22, .22, 1.2});
  constexpr double kVoxel = .004;
  const DistanceField field = DistanceField::of_points(cloud, box, kVoxel);
  const auto to_voxels = field.to_voxels({});
  int free = 0, inside = 0;
  for (double x = .03; x < .2; x += .01)
    for (double y = .03; y < .2; y += .01)
      for (double z = .91; z < 1.1; z += .01) {
        const double truth = scene.surface->distance({x, y, z});
        const float distance = field.distance(to_voxels(narrow({x, y, z})));
        if (truth > 5 * kVoxel) {
          EXPECT_GT(distance, 0) << x << ' ' << y << ' ' << z;
          ++free;
        } else if (truth < -5 * kVoxel) {
          EXPECT_LT(distance, 0) << x << ' ' << y << ' ' << z;
          ++inside;
        }
      }
  EXPECT_GT(free, 100);
  EXPECT_GT(inside, 100);
}

TEST(VoxelCount, ComesToTheVolume) {
  const auto wall = field_of(*synthetic::make_scene("wall").surface, .002);
  for (const double deep : {.0, .03, .05}) {
    VoxelCountPeer peer(voxels_of(synthetic::make_cube(.1), 50), wall);
    EXPECT_NEAR(peer.query({{}, {0, 0, .95 + deep}}).volume, .1 * .1 * deep, 1.1e-2 * 1e-3);
  }
}

TEST(FclPair, PushesTheToolAwayWhereThereIsFcl) {
  const Solid cube = synthetic::make_cube(.1);
  const std::unique_ptr<Peer> fcl = make_fcl_pair(cube, cube);
  ASSERT_EQ(fcl != nullptr, kHasFcl);
  if (!fcl) return;
  EXPECT_EQ(fcl->query({turned(), {.3, 0, 0}}).contacts, 0U);
  const PeerAnswer answer = fcl->query({turned(), {.09, .01, .02}});
  EXPECT_GT(answer.contacts, 0U);
  EXPECT_GT(answer.wrench.force.x, 0);
  EXPECT_TRUE(std::isnan(answer.volume));
  EXPECT_GT(fcl->bytes(), 24 * sizeof(Vec3));
}

}  // namespace
}  // namespace vpm::bench
