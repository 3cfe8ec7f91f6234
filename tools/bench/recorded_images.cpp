#include "tools/bench/recorded_images.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/query/tool_query.h"
#include "tools/bench/errors.h"
#include "tools/bench/random_draws.h"
#include "tools/bench/sight.h"
#include "tools/bench/silhouettes.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kImagePoseSeed = 1;

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

std::string path_of(const Frame& frame, const std::string& folder) {
  return folder + "/depth/" + frame.file;
}

FrameResult run_frame(const std::string& name, const Cloud& cloud, const PackedSolid& tool,
                      std::uint32_t level, int poses, const Device& device) {
  const AnyBody prepared(cloud);
  ToolQuery solid(tool.model, {.level = level, .device = device, .shadows = Shadows::solid}),
      near(tool.model, {.level = level, .device = device}),
      paper(tool.model, {.measure = Measure::paper, .level = level});
  FrameResult result;
  result.frame = name;
  const int tries = 20 * poses;
  for (int k = 0; k < tries && result.poses < poses; ++k) {
    const Pose pose = random_pose_before(cloud, static_cast<std::uint64_t>(k), tool.model.radius);
    const ProjectiveCount count = count_behind(tool.few_places(), tool.model.radius, pose,
                                               cloud.sensor->depth, cloud.sensor->camera);
    if (!(count.behind > 0 && count.behind < kShallow)) continue;
    ++result.poses;
    const auto volume = [&](ToolQuery& query) { return query.run(prepared, pose).volume_fraction; };
    const double volume_near = volume(near);
    result.near.add(std::abs(volume_near - count.behind));
    result.without_occluded.add(
        volume_error(volume_near, count.behind, {.inside = count.occluded}));
    result.solid.add(std::abs(volume(solid) - count.behind));
    result.paper.add(std::abs(volume(paper) - count.behind));
    for (const ToolQuery* query : {&near, &solid})
      result.counted_in_free_space +=
          counted_in_free_space(tool.model, query->level(), pose, cloud.sensor->depth,
                                cloud.sensor->camera, query->states());
  }
  return result;
}

}  // namespace

void require_recorded_images(const std::string& folder) {
  for (const Frame& frame : kFrames) {
    if (std::filesystem::exists(path_of(frame, folder))) return;
  }
  throw Error(ErrorKind::invalid_argument,
              "--data " + folder + ": its folder depth/ holds none of the " +
                  "recorded images that are known by name, like " + kFrames[0].file +
                  "; leave --data away to do without");
}

std::vector<RecordedImage> recorded_images(const std::string& folder) {
  std::vector<RecordedImage> images;
  for (const Frame& frame : kFrames) {
    const std::string path = path_of(frame, folder);
    if (!std::filesystem::exists(path)) continue;
    ImportOptions options;
    options.intrinsics = frame.intrinsics;
    options.depth.units_per_metre = frame.units_per_metre;
    try {
      images.push_back({frame.file, import_cloud(file::read_all(path), path, options).cloud});
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::unavailable) throw;
    }
  }
  return images;
}

Pose random_pose_before(const Cloud& cloud, std::uint64_t k, double reach) {
  synthetic::NormalNumbers numbers(kImagePoseSeed, k);
  const Rotation rotation = random_rotation(numbers);
  constexpr std::uint64_t kStride = 7919;  // a prime, which visits all of the image
  const std::size_t at = k * kStride % cloud.size();
  const double off = reach * (0.7 + 0.2 * numbers.next());
  return {rotation, cloud.origin + widen(cloud.positions[at]) + off * widen(cloud.normals[at])};
}

std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses, const Device& device) {
  std::vector<FrameResult> results;
  for (const RecordedImage& image : recorded_images(folder))
    results.push_back(run_frame(image.name, image.cloud, tool, level, poses, device));
  return results;
}

}  // namespace vpm::bench
