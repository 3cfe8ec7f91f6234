// Recorded frames of a kitchen as cameras of one scene, against a count of a tool's places by the
// pixels of all of them.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "libvpm/query/tool_query.h"
#include "libvpm/recording/frame_feed.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kNoise = 0.02;  // per depth: a camera surely knows on which side a place is
constexpr double kEdge = 0.2;    // m, of the tool, a cube

std::vector<Cloud> frames_of(const std::string& folder) {
  const Recording recording = read_recording(folder, {});
  ImportOptions options;
  options.intrinsics = recording.intrinsics->intrinsics;
  std::vector<Cloud> clouds;
  for (const RecordedFrame& frame : recording.frames) {
    ImportedScan scan = read_frame(frame, options);
    clouds.push_back(make_cloud(scan.image->depth, scan.image->camera, {}));
  }
  return clouds;
}

// Fractions of the places in the tool.
struct Count {
  double free = 0;      // that a camera surely sees free
  double behind = 0;    // that none does, and that are behind the surface by no more than the tool
  double occluded = 0;  // further behind what all cameras see that see something
};

// Returns by how much a place is behind what a camera sees there, m; nothing where it sees nothing.
std::optional<double> depth_behind(const CloudSensor& image, const Vec3& world) {
  const Intrinsics& k = image.camera.intrinsics;
  const Vec3 at = inverse(image.camera.to_world) * world;
  const double u = std::round(k.fx * at.x / at.z + k.cx), v = std::round(k.fy * at.y / at.z + k.cy);
  if (!(at.z > 0 && u >= 0 && v >= 0 && u < image.depth.width && v < image.depth.height))
    return std::nullopt;
  const float seen =
      image.depth
          .depth[image.depth.index(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))];
  return is_measured(seen) ? std::optional(at.z - seen) : std::nullopt;
}

Count count_places(const std::vector<Cloud>& clouds, const Pose& pose, double reach) {
  Count count;
  const std::vector<Vec3> places = testing::places_in_cube(kEdge, 14);
  for (const Vec3& place : places) {
    const Vec3 at = pose * place;
    double sum = 0, least = HUGE_VAL;
    int near = 0;
    for (const Cloud& cloud : clouds) {
      const std::optional<double> behind = depth_behind(*cloud.sensor, at);
      if (!behind) continue;
      const double noise = kNoise * norm(at - cloud.sensor->camera.to_world.translation);
      least = std::min(least, *behind <= -noise ? -HUGE_VAL : *behind);
      if (std::fabs(*behind) < noise) sum += *behind, ++near;
    }
    if (least == HUGE_VAL) continue;
    count.free += least == -HUGE_VAL;
    const bool is_behind = least > -HUGE_VAL && (near == 0 || sum > 0);
    count.occluded += is_behind && least > reach;
    count.behind += is_behind && least <= reach;
  }
  const auto all = static_cast<double>(places.size());
  return {count.free / all, count.behind / all, count.occluded / all};
}

TEST(SharedRecording, OfTheRedKitchenIsOneSceneOfFifteenCameras) {
  const std::string folder = VPM_SOURCE_DIR "/../shared/data/depth/redkitchen_seq";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data here";
  const std::vector<Cloud> clouds = frames_of(folder);
  ASSERT_EQ(clouds.size(), 15U);
  std::vector<DepthBody> images;
  for (const Cloud& cloud : clouds) images.emplace_back(cloud);
  const AnyBody scene = body_of_cameras(images);
  const ToolModel tool = testing::lattice_cube(kEdge, 6, 3);
  ToolQuery query(tool, {});
  double sum = 0, worst = 0, most = 0;
  int poses = 0;
  const Cloud& middle = clouds[7];
  for (std::size_t k = 0; k < 200 && poses < 20; ++k) {
    const std::size_t at = k * 7919 % middle.size();
    const double off = tool.radius * (0.5 + 0.4 * std::sin(5.0 * static_cast<double>(k)));
    const Pose pose{testing::generic_rotation(),
                    middle.origin + widen(middle.positions[at]) + off * widen(middle.normals[at])};
    const Count count = count_places(clouds, pose, tool.radius);
    if (!(count.behind > 0)) continue;
    ++poses;
    const double volume = query.run(scene, pose).volume_fraction;
    EXPECT_LT(volume, 1 - count.free + 0.02) << k;
    const double error =
        std::max({0.0, count.behind - volume, volume - count.behind - count.occluded});
    sum += error;
    worst = std::max(worst, error);
    most = std::max(most, volume);
  }
  EXPECT_EQ(poses, 20);
  EXPECT_GT(most, 0.1);
  EXPECT_LT(sum / poses, 0.015);
  EXPECT_LT(worst, 0.05);
}

}  // namespace
}  // namespace vpm
