#include "tools/bench/real_frames.h"

#include <algorithm>
#include <filesystem>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/query/query.h"
#include "libvpm/synthetic/kinect_noise.h"
#include "tools/bench/errors.h"
#include "tools/bench/silhouettes.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kPoseSeed = 1;

struct Frame {
  const char* file;
  Intrinsics intrinsics;
  double units_per_metre;
};
constexpr Frame kFrames[] = {
    {"redkitchen_seq/frame-000460.depth.png", {585, 585, 320, 240}, 1000},
    {"redkitchen_seq/frame-000467.depth.png", {585, 585, 320, 240}, 1000},
    {"redkitchen_seq/frame-000474.depth.png", {585, 585, 320, 240}, 1000},
    {"tum_desk_depth.png", {525, 525, 319.5, 239.5}, 5000},
    {"kinect_capture0001.pcd", {525, 525, 319.5, 239.5}, 1},
    {"d435_000000080-opaque-depth-img.exr", {921, 921, 642, 359}, 1},
};

// Parts of the tool.
struct Count {
  double behind = 0;  // the depth of the nearest pixel
  double shadow = 0;  // of those: further than the tool's reach behind it
};

Count counted(const PackedSolid& tool, const Pose& pose, const CloudSensor& sensor) {
  const Pose to_camera = relative_to(sensor.camera.to_world, pose);
  const Intrinsics& k = sensor.camera.intrinsics;
  std::size_t behind = 0, shadow = 0;
  for (const Vec3& place : tool.few_places()) {
    const Vec3 x = to_camera * place;
    if (!(x.z > 0)) continue;
    const double u = std::floor(k.fx * x.x / x.z + k.cx + 0.5),
                 v = std::floor(k.fy * x.y / x.z + k.cy + 0.5);
    if (!(u >= 0 && v >= 0 && u < sensor.depth.width && v < sensor.depth.height)) continue;
    const double depth = sensor.depth.depth[sensor.depth.index(static_cast<std::uint32_t>(u),
                                                               static_cast<std::uint32_t>(v))];
    behind += depth > 0 && x.z > depth;
    shadow += depth > 0 && x.z > depth + tool.model.reach;
  }
  const auto all = static_cast<double>(tool.few_places().size());
  return {static_cast<double>(behind) / all, static_cast<double>(shadow) / all};
}

// On the near side of a random point, up to the tool's reach off.
Pose random_pose(const Cloud& cloud, std::uint64_t k, double reach) {
  synthetic::NormalNumbers numbers(kPoseSeed, k);
  const Quaternion q{numbers.next(), numbers.next(), numbers.next(), numbers.next()};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  constexpr std::uint64_t kStride = 7919;  // a prime: all over the image
  const std::size_t at = k * kStride % cloud.size();
  const double off = reach * (0.7 + 0.2 * numbers.next());
  return {rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length}),
          cloud.origin + widen(cloud.positions[at]) + off * widen(cloud.normals[at])};
}

FrameResult run_frame(const std::string& name, const Cloud& cloud, const PackedSolid& tool,
                      std::uint32_t level, int poses) {
  const PreparedCloud prepared(cloud);
  Query queries[2] = {Query(tool.model, {.measure = Measure::refined, .level = level}),
                      Query(tool.model, {.measure = Measure::paper, .level = level})};
  FrameResult result;
  result.frame = name;
  const int tries = 20 * poses;
  for (int k = 0; k < tries && result.poses < poses; ++k) {
    const Pose pose = random_pose(cloud, static_cast<std::uint64_t>(k), tool.model.reach);
    const Count count = counted(tool, pose, *cloud.sensor);
    if (!(count.behind > 0 && count.behind < kShallow)) continue;
    ++result.poses;
    double volume[2];
    for (const Measure measure : {Measure::refined, Measure::paper}) {
      const auto m = static_cast<std::size_t>(measure);
      volume[m] = queries[m].run(prepared, pose).volume_fraction;
      result.difference[m].add(std::abs(volume[m] - count.behind));
    }
    result.beyond += std::abs(volume[0] - count.behind) > kFrameBound;
    const double known = volume_error(volume[0], count.behind, {.inside = count.shadow});
    result.without_shadows.add(known);
    result.beyond_without_shadows += known > kFrameBound;
    result.counted_in_free_space +=
        counted_in_free_space(tool.model, queries[0].level(), pose, cloud.sensor->depth,
                              cloud.sensor->camera, queries[0].states());
  }
  return result;
}

}  // namespace

std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses) {
  std::vector<FrameResult> results;
  for (const Frame& frame : kFrames) {
    const std::string path = folder + "/depth/" + frame.file;
    if (!std::filesystem::exists(path)) continue;
    ImportOptions options;
    options.intrinsics = frame.intrinsics;
    options.units_per_metre = frame.units_per_metre;
    try {
      const ImportedCloud imported = import_cloud(file::read_all(path), path, options);
      results.push_back(run_frame(frame.file, imported.cloud, tool, level, poses));
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::unavailable) throw;
    }
  }
  return results;
}

}  // namespace vpm::bench
