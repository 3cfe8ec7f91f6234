#include "libvpm/setup/checked_scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"

namespace vpm {
namespace {

constexpr std::size_t kMostPixels = 20000;  // chosen from an image

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Returns the distance of what neighbouring pixels see at the median depth.
double spacing_of(const CheckedScene& scene) {
  const Pose to_camera = inverse(scene.camera->to_world);
  std::vector<double> depths;
  for (const Vec3f& p : scene.positions)
    depths.push_back((to_camera * (scene.origin + widen(p))).z);
  const Intrinsics& k = scene.camera->intrinsics;
  return median_of(std::move(depths)) / std::max(k.fx, k.fy);
}

}  // namespace

CheckedScene checked_scene(Vec3 origin, std::vector<Vec3f> positions,
                           const std::optional<Camera>& camera) {
  CheckedScene scene{origin, std::move(positions), 0, camera};
  if (camera) scene.spacing = spacing_of(scene);
  return scene;
}

CheckedScene checked_scene(const Cloud& cloud) {
  if (cloud.sensor) return checked_scene(cloud.origin, cloud.positions, cloud.sensor->camera);
  CheckedScene scene = checked_scene(cloud.origin, cloud.positions, std::nullopt);
  // A disk's radius is about the spacing of points.
  scene.spacing = median_of({cloud.radii.begin(), cloud.radii.end()});
  return scene;
}

CheckedScene checked_scene(const CloudSensor& image) {
  const auto& [camera, depth] = image;
  std::vector<Vec3f> positions;
  const std::size_t every = depth.depth.size() / kMostPixels + 1;
  for (std::size_t at = 0; at < depth.depth.size(); at += every)
    if (is_measured(depth.depth[at]))
      positions.push_back(position_of_pixel(camera, static_cast<double>(at % depth.width),
                                            static_cast<double>(at / depth.width),
                                            depth.depth[at]));
  return checked_scene(camera.to_world.translation, std::move(positions), camera);
}

double size_of(const CheckedScene& scene) {
  if (scene.positions.empty()) return 0;
  Box box;
  for (const Vec3f& p : scene.positions) box.add(widen(p));
  double size = norm(box.size());
  if (!scene.camera) return size;
  const Vec3 eye = scene.camera->to_world.translation - scene.origin;
  for (const Vec3f& p : scene.positions) size = std::max(size, norm(widen(p) - eye));
  return size;
}

SceneSource source_of(const Cloud& cloud) {
  SceneSource source;
  const nlohmann::json& provenance = cloud.provenance.json();
  if (!provenance.is_object() || !provenance.contains("parameters")) return source;
  const nlohmann::json& told = provenance["parameters"];
  if (!told.is_object()) return source;
  if (told.contains("axes") && told["axes"].is_string())
    source.axes = axes_named(told["axes"].get<std::string>()).value_or(source.axes);
  if (cloud.sensor || !told.contains("camera-pose")) return source;
  try {
    source.points_to_world = pose_from_text(told["camera-pose"].dump());
  } catch (const Error&) {  // another program wrote it
  }
  return source;
}

}  // namespace vpm
