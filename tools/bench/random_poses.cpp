#include "tools/bench/random_poses.h"

#include <algorithm>
#include <cmath>

#include "libvpm/cloud/normals.h"
#include "libvpm/query/tool_query.h"
#include "tools/bench/errors.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/random_draws.h"
#include "tools/bench/sight.h"

namespace vpm::bench {
namespace {

constexpr double kAside = 0.03;  // m from the optical axis, since scenes change in the middle
constexpr int kPaperEvery = 8;
constexpr double kFieldOfView = 0.6;  // m at a depth of 1 m, wide enough for every pose

double counted(const PackedSolid& tool, const Pose& pose, const synthetic::Surface& surface) {
  std::size_t inside = 0;
  for (const Vec3& place : tool.few_places()) inside += surface.distance(pose * place) < 0;
  return static_cast<double>(inside) / static_cast<double>(tool.few_places().size());
}

}  // namespace

Pose random_pose(std::uint64_t seed, std::uint64_t k, double reach) {
  synthetic::NormalNumbers numbers(seed, k);
  const Rotation rotation = random_rotation(numbers);
  const double x = kAside * numbers.next(), y = kAside * numbers.next();
  const double z = 1 + 0.5 * reach * (numbers.next() - 0.5);
  return {rotation,
          {std::clamp(x, -2 * kAside, 2 * kAside), std::clamp(y, -2 * kAside, 2 * kAside), z}};
}

Camera camera_of_spacing(double spacing) {
  const double f = 1 / spacing, pixels = std::ceil(kFieldOfView * f);
  Camera camera = synthetic::default_camera();
  camera.width = camera.height = static_cast<std::uint32_t>(pixels);
  camera.intrinsics = {f, f, 0.5 * (pixels - 1), 0.5 * (pixels - 1)};
  return camera;
}

RandomPoses run_random_poses(const synthetic::Scene& scene,
                             const std::vector<const PackedSolid*>& tools, std::uint32_t level,
                             int poses, std::uint64_t seed, Shadows shadows, const Device& device) {
  const AnyBody cloud(
      make_cloud(synthetic::render(*scene.surface, scene.camera), scene.camera, NormalOptions{}));
  const std::vector<Sight> sights{Sight(*scene.surface, scene.camera)};
  RandomPoses found;
  std::uint64_t tried = 0;
  for (std::size_t t = 0; t < tools.size(); ++t) {
    const PackedSolid& tool = *tools[t];
    ToolQuery queries[2] = {
        ToolQuery(tool.model, {.level = level, .device = device, .shadows = shadows}),
        ToolQuery(tool.model, {.measure = Measure::paper, .level = level})};
    const int last = static_cast<int>(static_cast<std::size_t>(poses) * (t + 1) / tools.size());
    while (found.poses < last) {
      const Pose pose = random_pose(seed, tried++, tool.model.radius);
      const double truth = counted(tool, pose, *scene.surface);
      if (truth > kFullest) continue;
      ++found.poses;
      Unseen unseen;
      bool looked = false;
      for (const Measure measure : {Measure::refined, Measure::paper}) {
        if (measure == Measure::paper && found.poses % kPaperEvery != 0) continue;
        found.paper_poses += measure == Measure::paper;
        const auto m = static_cast<std::size_t>(measure);
        const double volume = queries[m].run(cloud, pose).volume_fraction;
        double error = volume_error(volume, truth, unseen);
        if (!(error <= kLeak / 2)) {  // large enough to ask what the camera can know
          if (!looked) unseen = unseen_parts(tool.few_places(), pose, *scene.surface, sights);
          looked = true;
          error = volume_error(volume, truth, unseen);
        }
        found.error[m].add(error);
        found.leaks[m] += !(error <= kLeak);
      }
    }
  }
  return found;
}

}  // namespace vpm::bench
