// Several cameras that see one scene are one body (libvpm/scene/rig).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"
#include "tests/query/ring_of_cameras.h"
#include "tests/scene/rig_scenes.h"

namespace vpm {
namespace {

using testing::box;
using testing::expect_same_bits;
using testing::images_of;
using testing::make_holes;
using testing::places;
using testing::ring_of_cameras;
using testing::room_with;
using testing::scene;

// True if one of the cameras sees a place of the surface, and not along it.
bool is_seen(const synthetic::Surface& surface, const std::vector<Camera>& cameras, const Vec3& at,
             const Vec3& normal) {
  constexpr double kAlong = 0.1, kSame = 1e-4;  // cosine; m
  return std::ranges::any_of(cameras, [&](const Camera& camera) {
    const Vec3 way = camera.to_world.translation - at, x = inverse(camera.to_world) * at;
    if (dot(way, normal) < kAlong * norm(way)) return false;
    const Intrinsics& k = camera.intrinsics;
    const auto depth = synthetic::RayCaster(surface, camera)
                           .depth(k.fx * x.x / x.z + k.cx, k.fy * x.y / x.z + k.cy);
    return depth && std::fabs(*depth - x.z) < kSame;
  });
}

// Counts places near surfaces that cameras see, and those at which a rig is wrong by more than a
// pixel is wide.
struct Deviations {
  int near = 0, wrong = 0, on_other_side = 0;
};
Deviations deviations_of(const synthetic::Surface& surface, const std::vector<Camera>& cameras) {
  const RigBody rig(images_of(surface, cameras));
  const Pose to_rig = inverse(rig.to_world());
  double width = 0;  // m, of the largest pixels, 1 m away
  for (const Camera& camera : cameras)
    width = std::max(width, 1 / std::min(camera.intrinsics.fx, camera.intrinsics.fy));
  Deviations found;
  for (const Vec3& x : places(20000, 0.17)) {
    const double truth = surface.distance(x);
    if (std::fabs(truth) > 2 * width) continue;
    const Vec3 normal = surface.gradient(x);
    if (!is_seen(surface, cameras, x - truth * normal, normal)) continue;
    const SurfaceSample seen = rig.surface().sample(to_rig * x);
    if (!seen.known) continue;
    ++found.near;
    const bool is_wrong = std::fabs(seen.distance - truth) > width;
    found.wrong += is_wrong;
    found.on_other_side += is_wrong && (seen.distance < 0) != (truth < 0);
  }
  return found;
}

std::vector<Camera> with_larger_pixels(std::vector<Camera> cameras, std::uint32_t across,
                                       std::uint32_t down) {
  for (Camera& camera : cameras) camera = testing::with_larger_pixels(camera, across, down);
  return cameras;
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

// Returns what cameras see, each with holes of its own.
std::vector<DepthBody> images_with_holes(const synthetic::Surface& surface,
                                         const std::vector<Camera>& cameras) {
  std::vector<DepthBody> images;
  for (const Camera& camera : cameras) {
    DepthImage image = synthetic::render(surface, camera);
    make_holes(image, images.size() + 1);
    images.emplace_back(make_cloud(image, camera, {}));
  }
  return images;
}
RigBody rig_with_holes(const synthetic::Surface& surface, int count) {
  return RigBody(images_with_holes(surface, with_larger_pixels(ring_of_cameras(count), 2, 2)));
}

// Two of the four images are from one place and differ in their holes only, so what both tell is
// equal: no such tie may fall to the image that is listed first.
TEST(RigOfAnyScene, OrderOfImagesWithHolesChangesNoBit) {
  std::vector<Camera> cameras = with_larger_pixels(ring_of_cameras(3), 2, 2);
  cameras.push_back(cameras.front());
  const std::vector<DepthBody> images = images_with_holes(*scene(), cameras);
  const ToolModel tool = testing::lattice_cube(0.1, 4, 3);
  ToolQuery query(tool, {});
  const std::vector<Vec3> all = places(5, 0.12);
  const auto answers = [&](const std::vector<std::size_t>& order) {
    std::vector<DepthBody> ordered;
    for (const std::size_t k : order) ordered.push_back(images[k]);
    const AnyBody rig(RigBody(std::move(ordered)));
    std::vector<Result> results;
    for (const Vec3& at : all) results.push_back(query.run(rig, {testing::generic_rotation(), at}));
    return results;
  };
  std::vector<std::size_t> order{0, 1, 2, 3};
  const std::vector<Result> expected = answers(order);
  EXPECT_GT(expected.front().volume_fraction, 0.1);
  while (std::ranges::next_permutation(order).found) {
    const std::vector<Result> found = answers(order);
    for (std::size_t k = 0; k < all.size(); ++k) testing::expect_equal(expected[k], found[k]);
  }
}

// Counts balls by what is told of them, and expects it of places in them.
struct Decided {
  int free = 0, behind = 0;
};
Decided expect_sides_to_hold(const RigBody& rig) {
  const RigSurface surface = rig.surface();
  const Pose to_rig = inverse(rig.to_world());
  Decided decided;
  const std::vector<Vec3> centers = places(4000, 0.2);
  for (std::size_t k = 0; k < centers.size(); ++k) {
    const Vec3 center = to_rig * centers[k];
    const double radius = 0.001 + 0.03 * std::abs(std::sin(4.1 * static_cast<double>(k)));
    const RigSurface::BallClass in_ball = surface.classify_ball(center, radius);
    const Side side = surface.side_of(in_ball, center, radius);
    if (side == Side::ambiguous) continue;
    decided.behind += side == Side::behind;
    decided.free += side == Side::free && in_ball.sight == Sight::seen;
    for (const Vec3& off : places(20, 0.57)) {
      const Vec3 x = center + radius * off;
      const SurfaceSample seen = surface.sample(x);
      EXPECT_TRUE(side == Side::behind ? seen.known && seen.distance < 0
                                       : !seen.known || seen.distance > 0)
          << k;
      if (in_ball.sight == Sight::mixed) continue;
      EXPECT_EQ(surface.sight_at(x), in_ball.sight) << k;
    }
  }
  return decided;
}

TEST_F(Rig, SideOfABallHoldsForAllPlacesInIt) {
  const Decided decided = expect_sides_to_hold(rig_);
  EXPECT_GT(decided.free, 300);
  EXPECT_GT(decided.behind, 30);
}
TEST(RigOfAnyScene, SideOfABallHoldsUnderNoiseAndForOblongPixels) {
  std::vector<DepthBody> images;
  for (const Camera& camera : with_larger_pixels(ring_of_cameras(4), 2, 3))
    images.emplace_back(make_cloud(
        synthetic::render_with_kinect_noise(*scene(), camera, images.size()), camera, {}));
  EXPECT_GT(expect_sides_to_hold(RigBody(images)).free, 100);
}
TEST(RigOfAnyScene, SideOfABallHoldsBesideHoles) {
  EXPECT_GT(expect_sides_to_hold(rig_with_holes(*scene(), 2)).free, 100);
}

// Whoever asks only what is nearer than some distance gets that with the bits of all.
TEST_F(Rig, SamplesUpToADistanceAreThoseWithoutIt) {
  int exact = 0, further = 0;
  for (const Vec3& place : places(8000, 0.3)) {
    const Vec3 x = to_rig_ * place;
    const double enough = 0.002 + 0.01 * std::abs(std::sin(1e4 * place.x));
    const SurfaceSample all = surface_.sample(x),
                        near = surface_.sample_near(x, surface_.all_cameras(), enough);
    ASSERT_EQ(all.known, near.known);
    if (!all.known) continue;
    if (all.distance < enough) {
      expect_same_bits(all, near, ++exact);
    } else {
      EXPECT_GE(near.distance, enough);
      further += near.distance != all.distance;
    }
  }
  EXPECT_GT(exact, 100);
  EXPECT_GT(further, 500);
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
  const double most = surface_.most_agreement * 1.5;  // m, the depth of all places
  for (const Vec3& x : places(8000, 0.3)) {
    bool is_free = false;
    for (const DepthBody& image : images_) {
      const SurfaceSample seen = image.surface().sample(inverse(image.to_world()) * x);
      is_free |= seen.known && seen.distance > most && scene()->distance(x) > most;
    }
    if (!is_free) continue;
    ++clearly;
    EXPECT_GT(surface_.sample(to_rig_ * x).distance, 0);
  }
  EXPECT_GT(clearly, 1000);
}

// Noisy images of cameras whose poses are wrong by millimetres, of which nobody knows the truth.
RigBody wrong_rig() {
  std::vector<DepthBody> images;
  for (Camera camera : with_larger_pixels(ring_of_cameras(4), 2, 2)) {
    const auto k = static_cast<double>(images.size());
    const DepthImage image = synthetic::render_with_kinect_noise(*scene(), camera, images.size());
    camera.to_world.translation += 0.004 * Vec3{std::sin(k), std::sin(2 * k + 1), std::sin(5 * k)};
    images.emplace_back(make_cloud(image, camera, {}));
  }
  return RigBody(std::move(images));
}

// However a tool lies, no more of it counts than what no camera saw free all about.
TEST(RigOfAnyScene, NothingOfAToolCountsThatACameraSawClearlyFree) {
  const RigBody rig = wrong_rig();
  const RigSurface surface = rig.surface();
  const Pose to_rig = inverse(rig.to_world());
  constexpr double kSide = 0.1;
  const ToolModel tool = testing::lattice_cube(kSide, 4, 3);
  ToolQuery query(tool, {});
  const std::vector<Vec3> inside = places(1000, kSide / 2);
  const auto is_clearly_free = [&](const Vec3& x) {
    const double apart = surface.classify_ball(to_rig * x, 0).margin;
    const auto sees = [&](const DepthBody& image) {
      const DepthSurface::BallClass around =
          image.surface().classify_ball(inverse(image.to_world()) * x, apart);
      return around.side == Side::free && DepthSurface::sight_of(around) == Sight::seen;
    };
    return std::ranges::any_of(rig.prepared().images(), sees);
  };
  int partly = 0;
  for (const Vec3& at : places(150, 0.22)) {
    const Pose pose{rotation_from_vector(9 * at), at};
    const auto free = std::ranges::count_if(
        inside, [&](const Vec3& place) { return is_clearly_free(pose * place); });
    const double most = 1 - static_cast<double>(free) / static_cast<double>(inside.size());
    const double found = query.run(AnyBody(rig), pose).volume_fraction;
    EXPECT_LE(found, most + 0.04);
    partly += found > 0.02 && most < 0.9;
  }
  EXPECT_GT(partly, 30);
}

// True if a place of a surface has no edge within so much, m.
bool is_on_face(const synthetic::Surface& surface, const Vec3& at, const Vec3& normal,
                double within) {
  const auto goes_on = [&](const Vec3& way) {
    const Vec3 beside = at + within * (way - dot(way, normal) * normal);
    return dot(surface.gradient(beside - 1e-4 * normal), normal) > 0.99;
  };
  return std::ranges::all_of(
      std::vector<Vec3>{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      goes_on);
}

// A camera that looks past a face from behind knows only that the face is somewhere before the
// border of what it hides. Where another one sees the face that moves nothing, however far apart
// readings of one surface may be, as under noise.
TEST(RigOfAnyScene, SilhouettesMoveNoFaceThatIsSeen) {
  const std::vector<Camera> cameras = with_larger_pixels(ring_of_cameras(4), 2, 2);
  const RigBody rig(images_of(*scene(), cameras));
  RigSurface surface = rig.surface();
  surface.most_agreement = 6 / cameras.front().intrinsics.fx;
  std::vector<double> agreement(surface.agreement, surface.agreement + 16);
  for (std::size_t pair = 0; pair < 16; ++pair)
    if (pair % 5 != 0) agreement[pair] = surface.most_agreement;  // of different cameras
  surface.agreement = agreement.data();
  double sum = 0;
  int count = 0;
  for (const Vec3& x : places(60000, 0.17)) {
    const double truth = scene()->distance(x);
    if (std::fabs(truth) > 0.003) continue;
    const Vec3 normal = scene()->gradient(x), foot = x - truth * normal;
    if (!is_seen(*scene(), cameras, foot, normal) || !is_on_face(*scene(), foot, normal, 0.008))
      continue;
    sum += surface.sample(inverse(rig.to_world()) * x).distance - truth, ++count;
  }
  EXPECT_GT(count, 400);
  EXPECT_LT(std::fabs(sum / count), 0.00005);  // m; a pixel is 3.4 mm wide
}

// Where a camera has not measured anything, its image around the hole tells what goes on there:
// hardly anything is then solid, or not, that is otherwise without holes.
TEST(RigOfAnyScene, SmallHolesChangeHardlyAnything) {
  const Pose turned{testing::generic_rotation(), {}};
  const synthetic::SurfacePtr scenes[] = {
      scene(), room_with(synthetic::make_ball({}, 0.12)),
      room_with(synthetic::make_block({0.26, 0.01, 0.2}, turned)),
      room_with(synthetic::make_prism({{-0.1, 0.1}, {0, 0}, {0.1, 0.1}, {0.1, -0.1}, {-0.1, -0.1}},
                                      turned))};
  for (const synthetic::SurfacePtr& surface : scenes) {
    for (int count = 2; count <= 4; ++count) {
      const RigBody rig = rig_with_holes(*surface, count),
                    all(images_of(*surface, with_larger_pixels(ring_of_cameras(count), 2, 2)));
      const Pose to_rig = inverse(rig.to_world());
      int known = 0, free = 0, solid = 0;
      for (const Vec3& place : places(8000, 0.2)) {
        const SurfaceSample truth = all.surface().sample(to_rig * place),
                            seen = rig.surface().sample(to_rig * place);
        if (!truth.known || std::fabs(truth.distance) < 0.01) continue;
        ++known;
        free += truth.distance < 0 && !is_behind_surface(seen);
        solid += truth.distance > 0 && is_behind_surface(seen);
      }
      SCOPED_TRACE(count);
      EXPECT_GT(known, 3000);
      EXPECT_LT(free, 0.004 * known);
      EXPECT_LT(solid, 0.01 * known);
    }
  }
}

// Two cameras before a wall have their holes at one place. What goes on there is solid; nobody has
// seen free what is before it.
TEST(RigOfAnyScene, BehindAHoleOfAllCamerasIsWhatGoesOnThere) {
  const synthetic::SurfacePtr wall = synthetic::make_wall({}, {0, 0, 1});
  std::vector<DepthBody> images;
  for (const Vec3& from : {Vec3{0.5, 0, 0.7}, {-0.5, 0.1, 0.7}}) {
    Camera camera = synthetic::default_camera();
    camera.to_world = testing::looking_at_origin(from);
    DepthImage image = synthetic::render(*wall, camera);
    for (std::uint32_t v = 0; v < image.height; ++v)
      for (std::uint32_t u = 0; u < image.width; ++u)
        if (std::hypot(u - camera.intrinsics.cx, v - camera.intrinsics.cy) < 12)
          image.depth[image.index(u, v)] = 0;
    images.emplace_back(make_cloud(image, camera, {}));
  }
  const AnyBody rig(RigBody(std::move(images)));
  const ToolModel tool = testing::lattice_cube(0.01, 3, 2);
  ToolQuery query(tool, {});
  for (const double height : {-0.003, -0.001, 0.0, 0.003, 0.0055}) {
    const Result found = query.run(rig, {{}, {0, 0, height}});
    const double inside = std::clamp(0.5 - height / 0.01, 0.0, 1.0);
    EXPECT_NEAR(found.volume_fraction, inside, 0.02) << height;
    if (inside == 0) {
      EXPECT_NEAR(found.visibility->unseen, 1, 1e-9);
    } else {
      EXPECT_GT(found.wrench.force.z, 0.99 * norm(found.wrench.force)) << height;
    }
  }
}

// Two cameras see a dark thing on a table: one measures it, in the other's image it is a hole with
// the table all around. It must stay solid.
TEST(RigOfAnyScene, WhatOneCameraMeasuresIsNotSeenThroughAHoleOfAnother) {
  const synthetic::SurfacePtr table = synthetic::make_wall({}, {0, 0, 1}),
                              thing =
                                  synthetic::make_block({0.03, 0.03, 0.03}, {{}, {0, 0, 0.015}}),
                              both = synthetic::make_union({table, thing});
  std::vector<DepthBody> images;
  for (const Vec3& from : {Vec3{0.5, 0, 0.7}, {-0.5, 0.1, 0.7}}) {
    Camera camera = synthetic::default_camera();
    camera.to_world = testing::looking_at_origin(from);
    DepthImage image = synthetic::render(*both, camera);
    const DepthImage beyond = synthetic::render(*table, camera);
    for (std::size_t k = 0; k < image.depth.size() && !images.empty(); ++k)
      if (image.depth[k] != beyond.depth[k]) image.depth[k] = 0;
    images.emplace_back(make_cloud(image, camera, {}));
  }
  EXPECT_EQ(images[1].silhouettes().holes().fits().size(), 1U);
  const RigBody rig(std::move(images));
  for (const Vec3& off : places(500, 0.012)) {
    const SurfaceSample seen =
        rig.surface().sample(inverse(rig.to_world()) * (off + Vec3{0, 0, 0.015}));
    EXPECT_TRUE(is_behind_surface(seen)) << off.x << ' ' << off.y << ' ' << off.z;
  }
}

// However a box is turned: some of its faces are then seen along, by one camera or another.
TEST(RigOfAnyScene, DistanceIsThatToTheSurfaceThatIsSeen) {
  const std::vector<Camera> cameras = with_larger_pixels(ring_of_cameras(4), 2, 2);
  for (int k = 0; k < 4; ++k) {
    const Rotation turned = rotation_from_vector(
        {0.4 * std::sin(3.1 * k + 1), 0.9 * std::sin(1.7 * k), 1.3 * std::sin(2.3 * k + 2)});
    const Deviations found =
        deviations_of(*room_with(synthetic::make_block({0.24, 0.18, 0.2}, {turned, {}})), cameras);
    EXPECT_GT(found.near, 500) << k;
    EXPECT_LT(found.wrong, 0.05 * found.near) << k;
    EXPECT_LT(found.on_other_side, 0.005 * found.near) << k;
  }
}

// A ball before a wall: what is beside it is as far from it whichever way it lies in the image.
TEST(RigOfOneCamera, SilhouettesAreAsFarAwayWhereverPixelsAreNotSquare) {
  const auto ball = synthetic::make_ball({0, 0, 1}, 0.1);
  const auto surface = synthetic::make_union({ball, synthetic::make_wall({0, 0, 2}, {0, 0, -1})});
  for (const auto& [across, down] : {std::pair{2U, 2U}, {1U, 2U}, {2U, 1U}, {1U, 3U}, {3U, 1U}}) {
    const std::vector<Camera> cameras =
        with_larger_pixels({synthetic::default_camera()}, across, down);
    const RigBody rig(images_of(*surface, cameras));
    const double width = 1 / std::min(cameras[0].intrinsics.fx, cameras[0].intrinsics.fy);
    for (int k = 0; k < 360; ++k) {
      const double around = k * 0.0174532925199433, aside = 0.1 + width * (2 + k % 7 * 0.5);
      const Vec3 x{aside * std::cos(around), aside * std::sin(around), 0.99};
      const SurfaceSample seen = rig.surface().sample(x);
      ASSERT_TRUE(seen.known);
      EXPECT_NEAR(seen.distance, ball->distance(x), width) << k << ' ' << across << ' ' << down;
      EXPECT_GT(dot(seen.normal, ball->gradient(x)), 0.9) << k << ' ' << across << ' ' << down;
    }
  }
}

// A coarse camera sees no edge as well as a fine one, and must not move what that shows.
TEST(RigOfAnyScene, ACoarseCameraDoesNotShiftFineOnes) {
  const std::vector<Camera> fine = ring_of_cameras(2);
  std::vector<Camera> mixed = fine;
  mixed.push_back(testing::with_larger_pixels(ring_of_cameras(3).back(), 8, 8));
  const RigBody alone(images_of(*scene(), fine)), beside(images_of(*scene(), mixed));
  double error_alone = 0, error_beside = 0;
  int count = 0;
  for (const Vec3& x : places(10000, 0.17)) {
    const double truth = scene()->distance(x);
    if (std::fabs(truth) > 0.004) continue;
    const Vec3 normal = scene()->gradient(x);
    if (!is_seen(*scene(), fine, x - truth * normal, normal)) continue;
    const auto error = [&](const RigBody& rig) {
      const SurfaceSample seen = rig.surface().sample(inverse(rig.to_world()) * x);
      return std::min(std::fabs(seen.distance - truth), 0.01);
    };
    error_alone += error(alone), error_beside += error(beside), ++count;
  }
  EXPECT_GT(count, 100);
  EXPECT_LT(error_beside, error_alone + count * 1e-4);  // m; its pixels are 2 cm wide
}

// Depths without any order have no clear pixel: even then nothing depends on the unit.
TEST(RigOfAnyScene, PowersOfTwoChangeExponentsOnly) {
  const auto rig_of = [](double scale, bool is_clear) {
    std::vector<Camera> cameras = with_larger_pixels(ring_of_cameras(3), 8, 8);
    std::vector<DepthBody> images;
    for (Camera& camera : cameras) {
      DepthImage image = synthetic::render(*scene(), camera);
      int k = 0;
      for (float& depth : image.depth) {
        if (!is_clear) depth *= 1 + 0.3F * static_cast<float>(std::sin(12.9 * ++k));
        depth *= static_cast<float>(scale);
      }
      camera.to_world.translation = scale * camera.to_world.translation;
      images.emplace_back(make_cloud(image, camera, {}));
    }
    return RigBody(std::move(images));
  };
  for (const bool is_clear : {true, false}) {
    const RigBody rig = rig_of(1, is_clear);
    for (const double scale : {0x1p-10, 0x1p10}) {
      const RigBody scaled = rig_of(scale, is_clear);
      EXPECT_EQ(scaled.surface().most_agreement, rig.surface().most_agreement);
      EXPECT_EQ(scaled.surface().well_before, rig.surface().well_before);
      int known = 0;
      for (const Vec3& x : places(1000, 0.3)) {
        const SurfaceSample seen = rig.surface().sample(x + Vec3{0, 0, 0.9}),
                            there = scaled.surface().sample(scale * (x + Vec3{0, 0, 0.9}));
        ASSERT_EQ(seen.known, there.known);
        if (!seen.known) continue;
        ++known;
        EXPECT_EQ(scale * seen.distance, there.distance);
        EXPECT_EQ(seen.normal.x, there.normal.x);
      }
      EXPECT_GT(known, 500);
    }
  }
}

// A robot before the border of a table hides where the table ends: its own contour is no border.
TEST(Silhouettes, BesideWhatWasRemovedThereAreNone) {
  const Camera camera = testing::with_larger_pixels(synthetic::default_camera(), 8, 8);
  const auto silhouettes_with = [&](float between) {
    DepthImage image{camera.width, camera.height, {}};
    for (std::uint32_t k = 0; k < camera.width * camera.height; ++k) {
      const std::uint32_t u = k % camera.width;
      image.depth.push_back(u < 40 ? 1.0F : u < 43 ? between : 2.0F);
    }
    return ImageSilhouettes(DepthBody(make_cloud(image, camera, {})).surface()).pixels().size();
  };
  EXPECT_EQ(silhouettes_with(0), camera.height);  // a hole beside a border is what is beyond it
  EXPECT_EQ(silhouettes_with(kRemovedDepth), 0);
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
