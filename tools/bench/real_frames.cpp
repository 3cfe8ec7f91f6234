#include "tools/bench/real_frames.h"

#include <algorithm>

#include "libvpm/query/query.h"
#include "tools/bench/errors.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/silhouettes.h"

namespace vpm::bench {
namespace {

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

FrameResult run_frame(const std::string& name, const Cloud& cloud, const PackedSolid& tool,
                      std::uint32_t level, int poses) {
  const PreparedCloud prepared(cloud);
  Query solid(tool.model, {.level = level, .shadows = Shadows::solid}),
      near(tool.model, {.level = level}),
      paper(tool.model, {.measure = Measure::paper, .level = level});
  FrameResult result;
  result.frame = name;
  const int tries = 20 * poses;
  for (int k = 0; k < tries && result.poses < poses; ++k) {
    const Pose pose = random_pose_before(cloud, static_cast<std::uint64_t>(k), tool.model.reach);
    const Count count = counted(tool, pose, *cloud.sensor);
    if (!(count.behind > 0 && count.behind < kShallow)) continue;
    ++result.poses;
    const auto volume = [&](Query& query) { return query.run(prepared, pose).volume_fraction; };
    const double volume_near = volume(near);
    result.near.add(std::abs(volume_near - count.behind));
    result.without_shadows.add(volume_error(volume_near, count.behind, {.inside = count.shadow}));
    result.solid.add(std::abs(volume(solid) - count.behind));
    result.paper.add(std::abs(volume(paper) - count.behind));
    for (const Query* query : {&near, &solid})
      result.counted_in_free_space +=
          counted_in_free_space(tool.model, query->level(), pose, cloud.sensor->depth,
                                cloud.sensor->camera, query->states());
  }
  return result;
}

}  // namespace

std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses) {
  std::vector<FrameResult> results;
  for (const RecordedImage& image : recorded_images(folder))
    results.push_back(run_frame(image.name, image.cloud, tool, level, poses));
  return results;
}

}  // namespace vpm::bench
