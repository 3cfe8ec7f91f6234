#include "tools/bench/real_frames.h"

#include <algorithm>

#include "libvpm/query/tool_query.h"
#include "tools/bench/errors.h"
#include "tools/bench/projective_count.h"
#include "tools/bench/recorded_images.h"
#include "tools/bench/silhouettes.h"

namespace vpm::bench {
namespace {

FrameResult run_frame(const std::string& name, const Cloud& cloud, const PackedSolid& tool,
                      std::uint32_t level, int poses, const Device& device) {
  const PreparedCloud prepared(cloud);
  ToolQuery solid(tool.model, {.level = level, .device = device, .shadows = Shadows::solid}),
      near(tool.model, {.level = level, .device = device}),
      paper(tool.model, {.measure = Measure::paper, .level = level, .device = device});
  FrameResult result;
  result.frame = name;
  const int tries = 20 * poses;
  for (int k = 0; k < tries && result.poses < poses; ++k) {
    const Pose pose = random_pose_before(cloud, static_cast<std::uint64_t>(k), tool.model.reach);
    const ProjectiveCount count = count_behind(tool.few_places(), tool.model.reach, pose,
                                               cloud.sensor->depth, cloud.sensor->camera);
    if (!(count.behind > 0 && count.behind < kShallow)) continue;
    ++result.poses;
    const auto volume = [&](ToolQuery& query) { return query.run(prepared, pose).volume_fraction; };
    const double volume_near = volume(near);
    result.near.add(std::abs(volume_near - count.behind));
    result.without_shadows.add(volume_error(volume_near, count.behind, {.inside = count.shadow}));
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

std::vector<FrameResult> run_real_frames(const std::string& folder, const PackedSolid& tool,
                                         std::uint32_t level, int poses, const Device& device) {
  std::vector<FrameResult> results;
  for (const RecordedImage& image : recorded_images(folder))
    results.push_back(run_frame(image.name, image.cloud, tool, level, poses, device));
  return results;
}

}  // namespace vpm::bench
