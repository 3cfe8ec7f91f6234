// Cameras around the world's origin, and what they see.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "libvpm/cloud/normals.h"
#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/synthetic/render.h"

namespace vpm::testing {

// Returns the pose, camera to world, of a camera that looks at the origin from a place.
inline Pose looking_at_origin(Vec3 from) {
  return synthetic::looking_at(from, {}, {0.1, 0.2, 1});
}

// Returns cameras about .9 m from the origin: four around it above and below, then one above, one
// below.
inline std::vector<Camera> ring_of_cameras(int count) {
  std::vector<Camera> cameras;
  for (int k = 0; k < count; ++k) {
    const double around = 1.57 * k + 0.3, height = k % 2 == 0 ? 0.6 : -0.4;
    const Vec3 from = k < 4 ? Vec3{0.7 * std::cos(around), 0.7 * std::sin(around), height}
                            : Vec3{0.1, 0.15, k % 2 == 0 ? 0.85 : -0.95};
    Camera camera = synthetic::default_camera();
    camera.to_world = looking_at_origin(from);
    cameras.push_back(camera);
  }
  return cameras;
}

// Returns a camera of the same view with fewer pixels, each as large as so many of its own.
inline Camera with_larger_pixels(Camera camera, std::uint32_t across, std::uint32_t down) {
  const auto larger = [](std::uint32_t by, std::uint32_t& size, double& f, double& c) {
    size /= by, f /= by, c = (c + 0.5) / by - 0.5;
  };
  larger(across, camera.width, camera.intrinsics.fx, camera.intrinsics.cx);
  larger(down, camera.height, camera.intrinsics.fy, camera.intrinsics.cy);
  return camera;
}

inline std::vector<DepthBody> images_of(const synthetic::Surface& surface,
                                        const std::vector<Camera>& cameras) {
  std::vector<DepthBody> images;
  for (const Camera& camera : cameras)
    images.emplace_back(make_cloud(synthetic::render(surface, camera), camera, {}));
  return images;
}

}  // namespace vpm::testing
