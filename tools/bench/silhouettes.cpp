#include "tools/bench/silhouettes.h"

#include <algorithm>
#include <random>

#include "libvpm/cloud/normals.h"
#include "libvpm/synthetic/scenes.h"
#include "tools/bench/errors.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/sight.h"

namespace vpm::bench {
namespace {

constexpr std::uint64_t kHoleSeed = 1;

struct Path {
  std::string name;
  synthetic::Scene scene;
  DepthImage depth;
  std::vector<bool> hole;  // pixels that the camera has not measured; empty if all are
  Vec3 from, to;
};

Path across_block(const std::string& name, Vec3 from, Vec3 to) {
  synthetic::Scene scene = synthetic::make_scene("block");
  DepthImage depth = synthetic::render(*scene.surface, scene.camera);
  return {name, std::move(scene), std::move(depth), {}, from, to};
}

void remove(DepthImage& depth, const std::vector<bool>& hole) {
  for (std::size_t i = 0; i < hole.size(); ++i)
    if (hole[i]) depth.depth[i] = 0;
}

// Returns a path over an image that lacks every seventh pixel on average. Holes between measured
// pixels are closed, so nothing is unknown.
Path over_missing_pixels(Vec3 from, Vec3 to) {
  synthetic::Scene scene = synthetic::make_scene("tilted-wall");
  DepthImage depth = synthetic::render(*scene.surface, scene.camera);
  std::mt19937_64 random(kHoleSeed);
  std::vector<bool> hole(depth.depth.size());
  for (std::size_t i = 0; i < hole.size(); ++i) hole[i] = random() % 7 == 0;
  remove(depth, hole);
  return {"missing pixels", std::move(scene), std::move(depth), {}, from, to};
}

// Returns a path over an image with holes of 3 to 12 pixels' radius, which hide about a tenth of
// it.
Path over_patches(Vec3 from, Vec3 to) {
  synthetic::Scene scene = synthetic::make_scene("tilted-wall");
  DepthImage depth = synthetic::render(*scene.surface, scene.camera);
  std::mt19937_64 random(kHoleSeed);
  std::vector<bool> hole(depth.depth.size());
  constexpr int kPatches = 150;
  const int width = static_cast<int>(depth.width), height = static_cast<int>(depth.height);
  for (int k = 0; k < kPatches; ++k) {
    const int u = static_cast<int>(random() % depth.width),
              v = static_cast<int>(random() % depth.height),
              r = 3 + static_cast<int>(random() % 10);
    for (int y = std::max(0, v - r); y <= std::min(height - 1, v + r); ++y)
      for (int x = std::max(0, u - r); x <= std::min(width - 1, u + r); ++x)
        if ((x - u) * (x - u) + (y - v) * (y - v) <= r * r)
          hole[depth.index(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))] = true;
  }
  remove(depth, hole);
  return {"patches", std::move(scene), std::move(depth), std::move(hole), from, to};
}

// Returns paths past a block of 0.2 m width, with its front at z = 1, its back at 1.2 and a wall at
// 1.5. Tools have a radius of about 0.1 m.
std::vector<Path> make_paths() {
  std::vector<Path> paths;
  paths.push_back(across_block("along the block's front", {-0.3, 0.01, 0.95}, {0.3, 0.01, 0.95}));
  paths.push_back(across_block("against the block's side", {0.3, 0.01, 1.03}, {0.05, 0.01, 1.03}));
  paths.push_back(across_block("behind the block", {-0.35, 0.01, 1.34}, {0.35, 0.01, 1.34}));
  paths.push_back(across_block("along the background", {-0.4, 0.01, 1.46}, {0.4, 0.01, 1.46}));
  paths.push_back(over_missing_pixels({-0.1, -0.05, 0.9}, {0.1, 0.05, 1.03}));
  paths.push_back(over_patches({-0.2, -0.1, 0.87}, {0.2, 0.1, 1.1}));
  return paths;
}

void follow_solid(const Path& path, const std::vector<Pose>& along, const AnyBody& cloud,
                  const PackedSolid& tool, std::uint32_t level, const Device& device,
                  SilhouetteResult& result) {
  const bool is_whole = std::ranges::find(path.depth.depth, 0.0F) == path.depth.depth.end();
  ToolQuery query(tool.model, {.level = level, .device = device, .shadows = Shadows::solid});
  double volume_before = 0, count_before = 0;
  for (std::size_t k = 0; k < along.size(); ++k) {
    const double volume = query.run(cloud, along[k]).volume_fraction;
    result.counted_in_free_space += counted_in_free_space(
        tool.model, query.level(), along[k], path.depth, path.scene.camera, query.states());
    if (!is_whole) continue;
    const double count =
        count_behind(tool.places, tool.model.radius, along[k], path.depth, path.scene.camera)
            .behind;
    const double beyond = std::abs(volume - volume_before) - std::abs(count - count_before);
    result.solid_worst = std::max(result.solid_worst, std::abs(volume - count));
    if (k > 0) result.solid_jump_worst = std::max(result.solid_jump_worst, beyond);
    volume_before = volume;
    count_before = count;
  }
}

SilhouetteResult follow(const Path& path, const PackedSolid& tool, std::uint32_t level, int poses,
                        const Device& device) {
  std::vector<Pose> along;
  for (int k = 0; k < poses; ++k) {
    const double s = static_cast<double>(k) / (poses - 1);
    along.push_back({turned(), (1 - s) * path.from + s * path.to});
  }
  const std::vector<Sight> sights{
      Sight(*path.scene.surface, path.scene.camera, path.hole.empty() ? nullptr : &path.hole)};
  std::vector<Unseen> unseen;
  unseen.reserve(along.size());
  for (const Pose& pose : along)
    unseen.push_back(unseen_parts(tool.places, pose, *path.scene.surface, sights));
  const auto truth = truth_along(tool.solid, along, *path.scene.surface);
  const AnyBody cloud(make_cloud(path.depth, path.scene.camera, NormalOptions{}));

  SilhouetteResult result{.path = path.name};
  for (const Measure measure : {Measure::refined, Measure::paper}) {
    ToolQuery query(tool.model,
                    {.measure = measure, .level = level, .device = device_for(measure, device)});
    std::vector<Result> measured;
    for (const Pose& pose : along) {
      measured.push_back(query.run(cloud, pose));
      if (measure == Measure::refined)
        result.counted_in_free_space += counted_in_free_space(
            tool.model, query.level(), pose, path.depth, path.scene.camera, query.states());
    }
    const Errors errors = compare(measured, truth, unseen, tool.solid);
    result.volume_worst[static_cast<std::size_t>(measure)] = errors.volume.worst();
    result.jump_worst[static_cast<std::size_t>(measure)] = errors.jump.worst();
  }
  follow_solid(path, along, cloud, tool, level, device, result);
  return result;
}

}  // namespace

int counted_in_free_space(const ToolModel& tool, const Level& level, const Pose& pose,
                          const DepthImage& depth, const Camera& camera,
                          std::span<const SphereState> states) {
  const Pose to_camera = relative_to(camera.to_world, pose);
  const Intrinsics& k = camera.intrinsics;
  int counted = 0;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    if (states[i] == SphereState::outside) continue;
    const Vec3 c = to_camera * tool.spheres[i].center;
    const double reach = level.cell_radius[i], nearest = c.z - reach, farthest = c.z + reach;
    if (!(nearest > 0)) continue;
    bool free = true;
    const double r = reach * std::max(k.fx, k.fy) / nearest * (1 + norm(c) / nearest) + 1;
    const double u = k.fx * c.x / c.z + k.cx, v = k.fy * c.y / c.z + k.cy;
    if (!(u - r >= 0 && v - r >= 0 && u + r <= depth.width - 1 && v + r <= depth.height - 1))
      continue;
    for (auto y = static_cast<std::uint32_t>(v - r); free && y <= v + r; ++y)
      for (auto x = static_cast<std::uint32_t>(u - r); free && x <= u + r; ++x)
        free = depth.depth[depth.index(x, y)] > farthest;
    counted += free;
  }
  return counted;
}

std::vector<SilhouetteResult> run_silhouettes(const PackedSolid& tool, std::uint32_t level,
                                              int poses, const Device& device) {
  std::vector<SilhouetteResult> results;
  for (const Path& path : make_paths()) results.push_back(follow(path, tool, level, poses, device));
  return results;
}

}  // namespace vpm::bench
