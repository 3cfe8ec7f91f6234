// A camera that is not where its pose tells is found by what the others see.

#include "libvpm/setup/cameras_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "tests/query/ring_of_cameras.h"

namespace vpm {
namespace {

using testing::images_of;
using testing::ring_of_cameras;

const synthetic::SurfacePtr& box_on_floor() {
  static const synthetic::SurfacePtr kScene = synthetic::make_union(
      {synthetic::make_block({0.24, 0.18, 0.2}, {}), synthetic::make_inverted_ball({}, 1.5)});
  return kScene;
}

std::vector<Camera> small_cameras(int count) {
  std::vector<Camera> cameras = ring_of_cameras(count);
  for (Camera& camera : cameras) camera = testing::with_larger_pixels(camera, 4, 4);
  return cameras;
}

// Returns what is said where the camera `wrong` is told to be elsewhere, or its depths are scaled.
std::optional<DoubtedCamera> said_of(int count, std::size_t wrong, double scale,
                                     const std::function<Pose(const Pose&)>& told) {
  std::vector<DepthBody> images;
  const std::vector<Camera> cameras = small_cameras(count);
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    DepthImage image = synthetic::render(*box_on_floor(), cameras[k]);
    Camera camera = cameras[k];
    if (k == wrong) {
      for (float& depth : image.depth) depth *= static_cast<float>(scale);
      camera.to_world = told(camera.to_world);
    }
    images.emplace_back(make_cloud(image, camera, {}));
  }
  return check_cameras(images);
}
Pose as_it_is(const Pose& pose) {
  return pose;
}
Pose calibrated_badly(const Pose& pose) {
  return {rotation_from_vector({0.005, -0.006, 0.004}) * pose.rotation,
          pose.translation + Vec3{0.003, -0.003, 0.003}};
}
Pose left_out(const Pose&) {
  return {};
}
Pose in_millimetres(const Pose& pose) {
  return {pose.rotation, 1000 * pose.translation};
}
Pose inverted(const Pose& pose) {
  return inverse(pose);
}

TEST(CamerasCheck, SaysNothingOfCamerasThatAgree) {
  for (const int count : {1, 2, 3, 4, 6}) {
    EXPECT_FALSE(said_of(count, 0, 1, as_it_is)) << count;
    EXPECT_FALSE(said_of(count, 0, 1, calibrated_badly)) << count;
  }
}

// Cameras that share nothing may be as they are told: that is a note, but for one without a pose.
TEST(CamerasCheck, SaysThatCamerasShareNothing) {
  const auto wall = [](double x) {
    Camera camera = small_cameras(1).front();
    camera.to_world = Pose{{}, {x, 0, 0}};
    const synthetic::SurfacePtr surface = synthetic::make_wall({0, 0, 1}, {0, 0, -1});
    return images_of(*surface, {camera}).front();
  };
  const auto said_of_walls = [&](double x, double other) {
    return check_cameras(std::vector<DepthBody>{wall(x), wall(other)});
  };
  EXPECT_FALSE(said_of_walls(5, 5.2));
  ASSERT_TRUE(said_of_walls(5, 15));
  EXPECT_FALSE(said_of_walls(5, 15)->remark.is_warning);
  ASSERT_TRUE(said_of_walls(10, 0));
  EXPECT_EQ(said_of_walls(10, 0)->camera, 1);
  EXPECT_TRUE(said_of_walls(10, 0)->remark.is_warning);
  EXPECT_TRUE(said_of_walls(0, 1000)->remark.is_warning);  // far apart
}

// Depths that are too small put what a camera shows near it, where no other one sees anything.
TEST(CamerasCheck, NamesACameraWhoseDepthsAreTooSmall) {
  for (const int count : {3, 4}) {
    const std::optional<DoubtedCamera> said = said_of(count, 1, 0.2, as_it_is);
    ASSERT_TRUE(said) << count;
    EXPECT_EQ(said->camera, 1) << count << said->remark.text;
  }
}

TEST(CamerasCheck, FindsTheOneThatIsElsewhere) {
  struct Wrong {
    double scale;
    Pose (*told)(const Pose&);
  };
  for (const Wrong& wrong :
       {Wrong{1000, as_it_is}, Wrong{5, as_it_is}, Wrong{2, as_it_is}, Wrong{1, in_millimetres}}) {
    for (const std::size_t camera : {0, 1, 2}) {
      const std::optional<DoubtedCamera> said = said_of(3, camera, wrong.scale, wrong.told);
      ASSERT_TRUE(said) << camera << ' ' << wrong.scale;
      EXPECT_EQ(said->camera, camera) << said->remark.text;
      EXPECT_TRUE(said->remark.is_warning);
    }
  }
}

// A wrong pose may also turn a camera to where nothing contradicts it; then nothing is said.
TEST(CamerasCheck, FindsAPoseThatMakesACameraSeeThroughWhatOthersShow) {
  for (const auto told : {left_out, inverted}) {
    const std::optional<DoubtedCamera> said = said_of(3, 0, 1, told);
    ASSERT_TRUE(said);
    EXPECT_TRUE(said->remark.is_warning);
  }
}

// Returns images of a plate that four cameras show from both sides, with poses that are wrong by so
// much, m, and noise or none.
std::vector<DepthBody> images_of_plate(double thickness, double wrong_by, bool has_noise) {
  const synthetic::SurfacePtr surface = synthetic::make_union(
      {synthetic::make_block({0.3, thickness, 0.25}, {rotation_from_vector({0.2, 0.1, 0.7}), {}}),
       synthetic::make_inverted_ball({}, 1.5)});
  std::vector<DepthBody> images;
  for (Camera camera : ring_of_cameras(4)) {
    const auto k = static_cast<double>(images.size());
    const DepthImage image =
        has_noise ? synthetic::render_with_kinect_noise(*surface, camera, images.size())
                  : synthetic::render(*surface, camera);
    camera.to_world.translation +=
        wrong_by * normalized_or_zero({std::sin(k), std::sin(3 * k + 1), std::cos(5 * k)});
    images.emplace_back(make_cloud(image, camera, {}));
  }
  return images;
}

TEST(ThicknessCheck, SaysThatThinThingsAreUncertainWhereCamerasDisagree) {
  EXPECT_FALSE(check_thickness(images_of_plate(0.004, 0, false)));
  EXPECT_FALSE(check_thickness(images_of_plate(0.004, 0, true)));
  EXPECT_FALSE(check_thickness(images_of_plate(0.06, 0.005, false)));
  std::vector<DepthBody> images = images_of_plate(0.004, 0.005, false);
  const std::optional<Remark> said = check_thickness(images);
  ASSERT_TRUE(said);
  EXPECT_TRUE(said->is_warning);
  std::swap(images[0], images[2]);
  images.push_back(images[1]);
  EXPECT_EQ(check_thickness(images)->text, said->text);
}

}  // namespace
}  // namespace vpm
