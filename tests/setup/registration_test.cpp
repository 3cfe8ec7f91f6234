// Cameras whose poses are wrong by little are moved until their images agree.

#include "libvpm/setup/registration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/error.h"
#include "tests/query/ring_of_cameras.h"

namespace vpm {
namespace {

// Returns boxes on a floor of which four cameras above see three faces each.
synthetic::SurfacePtr boxes_on_floor() {
  const auto box = [](Vec3 at, double turn) {
    return synthetic::make_block({0.3, 0.25, 0.2}, {rotation_from_vector({0, 0, turn}), at});
  };
  return synthetic::make_union({box({}, 0.785), box({0.4, 0.1, 0}, 0.3), box({-0.3, -0.4, 0}, 1.2),
                                synthetic::make_wall({0, 0, -0.11}, {0, 0, 1})});
}

std::vector<Camera> cameras_above(int count) {
  std::vector<Camera> cameras;
  for (int k = 0; k < count; ++k) {
    Camera camera = testing::with_larger_pixels(synthetic::default_camera(), 2, 2);
    camera.to_world = testing::looking_at_origin(
        {0.8 * std::cos(0.8 * k), 0.8 * std::sin(0.8 * k), 0.7 + 0.05 * k});
    cameras.push_back(camera);
  }
  return cameras;
}

// Returns the pose after it was moved by so much, m and rad, another way for each k.
Pose moved(const Pose& pose, double k, double by, double turned) {
  const auto direction = [](double n) {
    return normalized_or_zero({std::sin(3.1 * n + 1), std::sin(5.3 * n + 2), std::sin(7.7 * n)});
  };
  return {rotation_from_vector(turned * direction(k + 9)) * pose.rotation,
          pose.translation + by * direction(k)};
}

struct WrongRig {
  std::vector<Camera> cameras;    // where they are
  std::vector<DepthBody> images;  // that tell another pose
};
WrongRig wrong_rig(const synthetic::Surface& surface, int count, double by, double turned) {
  WrongRig rig{cameras_above(count), {}};
  for (const Camera& camera : rig.cameras) {
    Camera told = camera;
    told.to_world = moved(told.to_world, static_cast<double>(rig.images.size()), by, turned);
    rig.images.emplace_back(make_cloud(synthetic::render(surface, camera), told, {}));
  }
  return rig;
}

std::vector<Pose> told_poses(const WrongRig& rig) {
  std::vector<Pose> poses;
  for (const DepthBody& image : rig.images) poses.push_back(image.to_world());
  return poses;
}

// Returns by how much cameras at these poses are wrong against each other: m, at places they see.
double most_wrong(const WrongRig& rig, const std::vector<Pose>& told) {
  double most = 0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    for (const Vec3 at : {Vec3{0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, {0, 0, 0.3}}) {
      const auto seen = [&](std::size_t k) {
        return told[k] * (inverse(rig.cameras[k].to_world) * at);
      };
      most = std::max(most, norm(seen(i) - seen(0)));
    }
  }
  return most;
}

TEST(Registration, FindsWhereCamerasAre) {
  for (const auto& [by, turned] : {std::pair{0.001, 0.0017}, {0.005, 0.0087}}) {
    const WrongRig rig = wrong_rig(*boxes_on_floor(), 4, by, turned);
    const Registration found = register_images(rig.images);
    EXPECT_LT(most_wrong(rig, found.to_world), 0.15 * most_wrong(rig, told_poses(rig)));
    EXPECT_LT(found.after, 0.05 * found.before);
    EXPECT_EQ(found.motions, 18U);
    EXPECT_EQ(found.observable, 18U);
    Vec3 mean;
    for (std::size_t k = 0; k < 4; ++k)
      mean += found.to_world[k].translation - rig.images[k].to_world().translation;
    EXPECT_LT(norm(mean) / 4, 0.1 * by);
  }
}

TEST(Registration, LeavesCamerasThatAreRight) {
  const WrongRig rig = wrong_rig(*boxes_on_floor(), 3, 0, 0);
  EXPECT_LT(most_wrong(rig, register_images(rig.images).to_world), 1e-5);
}

// Two planes of cameras that slide on a plane look alike.
TEST(Registration, LeavesWhatAPlaneDoesNotTell) {
  const WrongRig rig = wrong_rig(*synthetic::make_wall({}, {0, 0, 1}), 2, 0.005, 0.0087);
  const Registration found = register_images(rig.images);
  EXPECT_EQ(found.motions, 6U);
  EXPECT_EQ(found.observable, 3U);
  EXPECT_LT(found.after, 0.01 * found.before);
  for (std::size_t k = 0; k < 2; ++k) {
    const Pose &now = found.to_world[k], &told = rig.images[k].to_world();
    EXPECT_LT(std::fabs(rotation_vector(now.rotation * transpose(told.rotation)).z), 1e-3);
  }
}

TEST(Registration, OrderAndOneTwiceChangeNoBit) {
  const std::vector<DepthBody> images = wrong_rig(*boxes_on_floor(), 3, 0.005, 0.0087).images;
  const auto found = register_images(images).to_world;
  const auto other = register_images(std::vector{images[2], images[0], images[1], images[2]});
  EXPECT_EQ(other.motions, 12U);
  const std::size_t places[] = {2, 0, 1, 2};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(other.to_world[k].translation, found[places[k]].translation);
    EXPECT_EQ(other.to_world[k].rotation.row0, found[places[k]].rotation.row0);
    EXPECT_EQ(other.to_world[k].rotation.row1, found[places[k]].rotation.row1);
  }
}

TEST(Registration, RefusesCamerasThatShareNothing) {
  WrongRig rig = wrong_rig(*boxes_on_floor(), 2, 0, 0);
  EXPECT_THROW(register_images({rig.images.data(), 1}), Error);
  Camera away = rig.cameras[1];
  away.to_world.translation += Vec3{0, 0, 3};
  rig.images[1] =
      DepthBody(make_cloud(synthetic::render(*boxes_on_floor(), rig.cameras[1]), away, {}));
  EXPECT_THROW(register_images(rig.images), Error);
}

}  // namespace
}  // namespace vpm
