// Readings of a camera's surface together, against one after the other: the same bits.
#include "libvpm/query/depth_readings.h"

#include <gtest/gtest.h>

#include <random>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/cell.h"
#include "libvpm/query/cell_samples.h"
#include "libvpm/query/prepared_cloud.h"
#include "libvpm/query/share_clusters.h"
#include "libvpm/synthetic/kinect_noise.h"
#include "tests/query/lattice_model.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

class Numbers {
 public:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  Vec3 place(double half) {
    return {between(-half, half), between(-half, half), between(-half, half)};
  }

 private:
  std::mt19937 random_{1};
};

// With creases, jumps, noise and holes.
Cloud rough_cloud(const char* scene) {
  Camera camera = synthetic::default_camera();
  camera.intrinsics = {130, 131, 79.5, 60};
  camera.width = 160, camera.height = 121;
  DepthImage image =
      synthetic::render_with_kinect_noise(*synthetic::make_scene(scene).surface, camera, 1);
  Numbers numbers;
  for (float& depth : image.depth) {
    if (numbers.between(0, 1) < 0.02) depth = 0;
    if (numbers.between(0, 1) < 0.02) depth *= 1.05F;
  }
  return make_cloud(image, camera, {.window = 3});
}

// About the surface, beside the image, behind the camera, and without end.
Vec3 any_place(Numbers& numbers) {
  const double kind = numbers.between(0, 1);
  if (kind < 0.01) return {0, 0, 0};
  if (kind < 0.02) return {0.1, HUGE_VAL, 1};
  if (kind < 0.03) return {0.1, 0.1, 1e-40};
  const double depth = kind < 0.1 ? numbers.between(-1, 1) : numbers.between(0.6, 1.6);
  return {depth * numbers.between(-0.7, 0.7), depth * numbers.between(-0.55, 0.55), depth};
}

void expect_equal(const Reading& a, const Reading& b) {
  EXPECT_EQ(a.known, b.known);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.foot, b.foot);
  EXPECT_EQ(a.point, b.point);
}

class DepthReadings : public ::testing::TestWithParam<const char*> {
 protected:
  // Some normals are lost, or cannot be right.
  DepthReadings() {
    for (Vec3f& normal : normals_) {
      const double kind = numbers_.between(0, 1);
      if (kind < 0.03) normal = kind < 0.01 ? Vec3f{} : Vec3f{1, 0, 0};
    }
    surface_.normals = normals_.data();
  }

  PreparedCloud cloud_{rough_cloud(GetParam())};
  DepthSurface surface_ = cloud_.depth_surface();
  std::vector<Vec3f> normals_{surface_.normals, surface_.normals + surface_.width* surface_.height};
  Numbers numbers_;
};

TEST_P(DepthReadings, OfFourPlacesAreThoseOfEach) {
  int known = 0;
  for (int k = 0; k < 20000; ++k) {
    Vec3 places[4];
    Reading together[4], one[4];
    for (Vec3& place : places) place = any_place(numbers_);
    read_four(surface_, places, together);
    ReadInTurn{}(surface_, places, one);
    for (int i = 0; i < 4; ++i) {
      expect_equal(together[i], one[i]);
      known += one[i].known ? 1 : 0;
    }
  }
  EXPECT_GT(known, 5000);
}

TEST_P(DepthReadings, OfSamplesAreThoseOfEachThatTheSurfaceReaches) {
  int reached = 0;
  for (int k = 0; k < 2000; ++k) {
    const Pose to_surface{testing::generic_rotation(), any_place(numbers_)};
    std::vector<CellSample> samples(static_cast<std::size_t>(numbers_.between(0, 40)));
    for (CellSample& sample : samples)
      sample = {narrow(numbers_.place(0.05)), static_cast<float>(numbers_.between(0, 0.02)), 1};
    std::vector<SampleReading> together(samples.size());
    together.resize(read_samples(surface_, to_surface, samples, together.data()));
    std::size_t found = 0;
    for (std::uint32_t s = 0; s < samples.size(); ++s) {
      const Vec3 x = to_surface * widen(samples[s].center);
      const Reading reading = surface_.read(x);
      if (!(reading.known && reading.distance < samples[s].radius)) continue;
      ASSERT_LT(found, together.size());
      EXPECT_EQ(together[found].sample, s);
      EXPECT_EQ(together[found].at.x, x);
      expect_equal(together[found].at.reading, reading);
      ++found;
    }
    EXPECT_EQ(found, together.size());
    reached += static_cast<int>(found);
  }
  EXPECT_GT(reached, 1000);
}

TEST_P(DepthReadings, FindTheNormalsThatEachFinds) {
  int turned = 0;
  for (int k = 0; k < 5000; ++k) {
    PlaceReading places[7];
    for (PlaceReading& place : places) {
      do {
        place.x = any_place(numbers_);
        place.reading = surface_.read(place.x);
      } while (!(place.reading.known && place.reading.distance < 0));
    }
    Vec3 normals[7];
    closest_normals(surface_, places, normals);
    for (int i = 0; i < 7; ++i) {
      const Vec3 one = surface_.closest_normal(places[i].x, places[i].reading);
      EXPECT_EQ(normals[i], one);
      turned += one != places[i].reading.normal ? 1 : 0;
    }
  }
  EXPECT_GT(turned, 5000);
}

TEST_P(DepthReadings, AddToACellWhatOneAfterTheOtherDoes) {
  const ToolModel tool = testing::lattice_cube(0.2, 4, 5);
  const Level& level = tool.levels[0];
  const std::vector<BlockMass> masses = block_masses(level);
  int cut = 0, pushed = 0;
  for (int k = 0; k < 300; ++k) {
    const Pose to_surface{testing::generic_rotation(), {0, 0, numbers_.between(0.8, 1.2)}};
    for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
      const CellMeasure measure(
          surface_, to_surface, tool.reach,
          CellView{level.blocks.data(), masses.data(), level.samples.data(), level.block_begin[i],
                   level.block_begin[i + 1], tool.spheres[i].center, level.share_reach[i]});
      const CellResult a = measure.run(SamplesInTurn{}), b = measure.run(SamplesTogether{});
      EXPECT_EQ(a.sum.volume.value, b.sum.volume.value);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(a.sum.force[axis].value, b.sum.force[axis].value);
        EXPECT_EQ(a.sum.torque[axis].value, b.sum.torque[axis].value);
        EXPECT_EQ(a.plane.normal[axis].value, b.plane.normal[axis].value);
        EXPECT_EQ(a.plane.foot[axis].value, b.plane.foot[axis].value);
      }
      EXPECT_EQ(a.plane.count, b.plane.count);
      EXPECT_EQ(a.is_far, b.is_far);
      cut += a.plane.count > 0 ? 1 : 0;
      pushed += a.plane.count == 0 && a.sum.volume.value > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(cut, 500);
  EXPECT_GT(pushed, 500);
}

INSTANTIATE_TEST_SUITE_P(Scenes, DepthReadings,
                         ::testing::Values("tilted-wall", "ball", "groove", "step", "plate"),
                         [](const auto& variant) { return test::test_name(variant.param); });

TEST(CrossedSamples, AddUpTogetherAsInTurn) {
  Numbers numbers;
  int cut = 0, whole = 0;
  for (int k = 0; k < 20000; ++k) {
    CrossingPlane plane;
    plane.normal = normalized_or_zero(numbers.place(1));
    plane.height = numbers.between(-0.12, 0.12);
    std::vector<CellSample> samples(static_cast<std::size_t>(numbers.between(0, 40)));
    for (CellSample& sample : samples)
      sample = {narrow(numbers.place(0.1)), static_cast<float>(numbers.between(0, 0.03)),
                numbers.between(0, 1)};
    const auto count = static_cast<std::uint32_t>(samples.size());
    const CrossedSums together = crossed_sums(plane, samples.data(), count),
                      in_turn = SamplesInTurn::crossed(plane, samples.data(), count);
    EXPECT_EQ(together.weight, in_turn.weight);
    EXPECT_EQ(together.moment, in_turn.moment);
    EXPECT_EQ(together.is_cut, in_turn.is_cut);
    cut += in_turn.is_cut ? 1 : 0;
    whole += !in_turn.is_cut && in_turn.weight > 0 ? 1 : 0;
  }
  EXPECT_GT(cut, 5000);
  EXPECT_GT(whole, 100);
}

}  // namespace
}  // namespace vpm
