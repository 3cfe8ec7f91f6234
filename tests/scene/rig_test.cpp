// Several cameras that see one scene are one body (libvpm/scene/rig).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/query/ring_of_cameras.h"

namespace vpm {
namespace {

using testing::images_of;
using testing::ring_of_cameras;

const synthetic::SurfacePtr& box() {
  static const synthetic::SurfacePtr kBox =
      synthetic::make_block({0.24, 0.18, 0.2}, {testing::generic_rotation(), {}});
  return kBox;
}
// The box in a room, and a thin plate beside it.
const synthetic::SurfacePtr& scene() {
  static const synthetic::SurfacePtr kScene = synthetic::make_union(
      {box(), synthetic::make_block({0.004, 0.2, 0.2}, {{}, {0.25, 0.03, 0.02}}),
       synthetic::make_inverted_ball({}, 1.5)});
  return kScene;
}

std::vector<Vec3> places(int count, double reach) {
  std::vector<Vec3> all;
  for (int k = 0; k < count; ++k)
    all.push_back(
        {reach * std::sin(12.9 * k), reach * std::sin(78.2 * k + 1), reach * std::sin(37.7 * k)});
  return all;
}

void expect_same_bits(const SurfaceSample& a, const SurfaceSample& b, int place) {
  ASSERT_EQ(a.known, b.known) << place;
  if (!a.known) return;
  EXPECT_EQ(a.distance, b.distance) << place;
  EXPECT_EQ(a.normal.x, b.normal.x) << place;
  EXPECT_EQ(a.foot.z, b.foot.z) << place;
}

class Rig : public ::testing::Test {
 protected:
  static const std::vector<DepthBody>& images() {
    static const std::vector<DepthBody> kImages = images_of(*scene(), ring_of_cameras(4));
    return kImages;
  }
  static const RigBody& rig() {
    static const RigBody kRig(images());
    return kRig;
  }

  const std::vector<DepthBody>& images_ = images();
  const RigBody& rig_ = rig();
  const RigSurface surface_ = rig_.surface();
  const Pose to_rig_ = inverse(rig_.to_world());
};

TEST_F(Rig, OrderOfCamerasAndOneTwiceChangeNoBit) {
  const ToolModel tool = testing::lattice_cube(0.1, 4, 3);
  ToolQuery query(tool, {});
  const RigBody other({images_[2], images_[0], images_[3], images_[2], images_[1]});
  double most = 0;
  for (const Vec3& at : places(40, 0.12)) {
    const Pose pose{testing::generic_rotation(), at};
    const Result expected = query.run(AnyBody(rig_), pose);
    testing::expect_equal(expected, query.run(AnyBody(other), pose));
    most = std::max(most, expected.volume_fraction);
  }
  EXPECT_GT(most, 0.8);
}

TEST_F(Rig, DistanceIsThatToTheSolid) {
  int near = 0, wrong = 0, other_side = 0;
  for (const Vec3& x : places(40000, 0.17)) {
    const double truth = scene()->distance(x);
    if (std::fabs(truth) > 0.004) continue;
    const SurfaceSample seen = surface_.sample(to_rig_ * x);
    if (!seen.known) continue;
    ++near;
    const bool is_wrong = std::fabs(seen.distance - truth) > 0.002;
    wrong += is_wrong;
    other_side += is_wrong && (seen.distance < 0) != (truth < 0);
  }
  EXPECT_GT(near, 500);
  EXPECT_LT(wrong, 0.02 * near);
  EXPECT_LT(other_side, 0.005 * near);
}

TEST_F(Rig, SideOfABallHoldsForAllPlacesInIt) {
  int decided[3] = {};
  const std::vector<Vec3> centers = places(4000, 0.2);
  for (std::size_t k = 0; k < centers.size(); ++k) {
    const Vec3 center = to_rig_ * centers[k];
    const double radius = 0.001 + 0.03 * std::abs(std::sin(4.1 * static_cast<double>(k)));
    const RigSurface::BallClass in_ball = surface_.classify_ball(center, radius);
    const Side side = surface_.side_of(in_ball, center, radius);
    if (side == Side::ambiguous) continue;
    ++decided[side == Side::behind ? 2 : in_ball.sight == Sight::seen];
    for (const Vec3& off : places(20, 0.57)) {
      const Vec3 x = center + radius * off;
      const SurfaceSample seen = surface_.sample(x);
      EXPECT_TRUE(side == Side::behind ? seen.known && seen.distance < 0
                                       : !seen.known || seen.distance > 0)
          << k;
      if (in_ball.sight == Sight::mixed) continue;
      EXPECT_EQ(surface_.sight_at(x), in_ball.sight) << k;
    }
  }
  EXPECT_GT(decided[1], 300);  // free
  EXPECT_GT(decided[2], 30);   // behind
}

TEST_F(Rig, CamerasThatDecideInABallTellWhatAllTell) {
  int fewer = 0;
  const std::vector<Vec3> centers = places(4000, 0.15);
  for (std::size_t k = 0; k < centers.size(); ++k) {
    const Vec3 center = to_rig_ * centers[k];
    const double radius = 0.001 + 0.01 * std::abs(std::sin(4.1 * static_cast<double>(k)));
    const RigSurface::BallClass in_ball = surface_.classify_ball(center, radius);
    if (in_ball.side != Side::ambiguous) continue;
    fewer += in_ball.point != surface_.all_cameras();
    const auto near = surface_.around_ball(center, radius, in_ball.point);
    for (const Vec3& off : places(10, 0.57)) {
      const Vec3 x = center + radius * off;
      expect_same_bits(surface_.sample(x), near.sample(x), static_cast<int>(k));
    }
  }
  EXPECT_GT(fewer, 20);
}

TEST_F(Rig, FourLanesHaveTheBitsOfOne) {
  const std::vector<Vec3> all = places(4000, 0.3);
  for (std::size_t k = 0; k < all.size(); k += 4) {
    const Vec3 four[] = {to_rig_ * all[k], to_rig_ * all[k + 1], to_rig_ * all[k + 2],
                         to_rig_ * all[k + 3]};
    SurfaceSample lanes[4];
    sample_four(surface_, four, lanes);
    for (std::size_t lane = 0; lane < 4; ++lane)
      expect_same_bits(surface_.sample(four[lane]), lanes[lane], static_cast<int>(k + lane));
  }
}

// What a camera saw free by more than the images disagree by is free.
TEST_F(Rig, NothingCountsThatACameraSawClearlyFree) {
  int clearly = 0;
  for (const Vec3& x : places(8000, 0.3)) {
    bool is_free = false;
    for (const DepthBody& image : images_) {
      const SurfaceSample seen = image.surface().sample(inverse(image.to_world()) * x);
      is_free |= seen.known && seen.distance > surface_.most_agreement &&
                 scene()->distance(x) > surface_.most_agreement;
    }
    if (!is_free) continue;
    ++clearly;
    EXPECT_GT(surface_.sample(to_rig_ * x).distance, 0);
  }
  EXPECT_GT(clearly, 1000);
}

TEST(RigOfAllSides, HoldsAToolInsideAsAWhole) {
  const RigBody rig(images_of(*box(), ring_of_cameras(6)));
  const ToolModel tool = testing::lattice_cube(0.02, 3, 2);  // its radius is less than its depth
  ToolQuery query(tool, {});
  for (const Vec3& off : places(20, 0.03)) {
    const Pose pose{{}, off};
    const Result found = query.run(AnyBody(rig), pose);
    EXPECT_NEAR(found.volume_fraction, 1, 1e-9);
    const Vec3 force = normalized_or_zero(found.wrench.force);
    const double depth = -box()->distance(off);
    EXPECT_GT(-box()->distance(off + depth * force), -0.004);
    EXPECT_LT(-box()->distance(off + depth * force), 0.35 * depth + 0.004);  // it leads out
  }
}

TEST(RigOfAllSides, OneCameraAloneDoesNotKnowThat) {
  const AnyBody image(images_of(*box(), ring_of_cameras(1)).front());
  const ToolModel tool = testing::lattice_cube(0.02, 3, 2);
  EXPECT_EQ(ToolQuery(tool, {}).run(image, Pose{}).volume, 0);
}

TEST(RigBody, RefusesNoneAndTooMany) {
  EXPECT_THROW(RigBody({}), Error);
}

}  // namespace
}  // namespace vpm
