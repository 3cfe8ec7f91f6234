#include "libvpm/synthetic/render.h"

#include <algorithm>

#include "libvpm/core/parallel.h"

namespace vpm::synthetic {

Camera default_camera() {
  Camera camera;
  camera.intrinsics = {525, 525, 319.5, 239.5};
  camera.width = 640;
  camera.height = 480;
  return camera;
}

Vec3 RayCaster::point(double u, double v, double depth) const {
  return camera_.to_world * unproject(camera_.intrinsics, u, v, depth);
}

std::optional<double> RayCaster::depth(double u, double v) {
  const Vec3 origin = camera_.to_world.translation;
  const Vec3 direction = camera_.to_world.rotation * unproject(camera_.intrinsics, u, v, 1);
  crossings_.clear();
  surface_.crossings(origin, direction, crossings_);
  crossings_.push_back(0);
  std::sort(crossings_.begin(), crossings_.end());
  for (std::size_t k = 0; k < crossings_.size(); ++k) {
    const double t = crossings_[k];
    if (t <= 0) continue;
    // Tests the middle of the stretch before the crossing for free space.
    const Vec3 before = origin + (0.5 * (crossings_[k - 1] + t)) * direction;
    if (surface_.distance(before) > 0) return t;
  }
  return std::nullopt;
}

DepthImage render(const Surface& surface, const Camera& camera) {
  DepthImage image{camera.width, camera.height, {}};
  image.depth.resize(std::size_t{camera.width} * camera.height);
  parallel_for(camera.height, 8, [&](std::size_t begin, std::size_t end) {
    RayCaster rays(surface, camera);
    for (std::size_t v = begin; v < end; ++v) {
      for (std::size_t u = 0; u < camera.width; ++u) {
        image.depth[v * camera.width + u] = static_cast<float>(
            rays.depth(static_cast<double>(u), static_cast<double>(v)).value_or(0));
      }
    }
  });
  return image;
}

}  // namespace vpm::synthetic
