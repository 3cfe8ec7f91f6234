#include "tests/cloud/normal_scene.h"

#include <cmath>
#include <numbers>

namespace vpm {
namespace {

constexpr int kHalfWindow = 3;
// Limits within which neighbours belong to one surface: relative depth, and the cosine between
// normals (37 degrees).
constexpr double kSameDepth = 0.03, kSameNormal = 0.8;

bool on_one_surface(const NormalScene& s, int u, int v) {
  const int width = static_cast<int>(s.camera.width), height = static_cast<int>(s.camera.height);
  if (u < kHalfWindow || v < kHalfWindow || u >= width - kHalfWindow || v >= height - kHalfWindow)
    return false;
  const auto index = [width](int x, int y) { return static_cast<std::size_t>(y * width + x); };
  const std::size_t centre = index(u, v);
  for (int y = v - kHalfWindow; y <= v + kHalfWindow; ++y) {
    for (int x = u - kHalfWindow; x <= u + kHalfWindow; ++x) {
      const float z = s.depth.depth[centre], other = s.depth.depth[index(x, y)];
      if (!is_measured(other) || std::abs(z - other) > kSameDepth * z ||
          dot(s.truth[centre], s.truth[index(x, y)]) < kSameNormal)
        return false;
    }
  }
  return true;
}

}  // namespace

synthetic::SurfacePtr room() {
  using namespace synthetic;
  const Rotation turned = rotation_from_quaternion({0.2, 0.35, 0.1, 0.90967026}, nullptr);
  return make_union({make_wall({0, 0, 1.3}, {0.25, -0.2, -1}), make_ball({-0.25, -0.1, 0.9}, 0.2),
                     make_ball({0.05, 0.25, 0.8}, 0.1),
                     make_block({0.25, 0.3, 0.2}, Pose{turned, {0.3, 0.05, 0.95}})});
}

NormalScene see(const synthetic::SurfacePtr& surface) {
  NormalScene s;
  s.camera = synthetic::default_camera();
  s.depth = synthetic::render(*surface, s.camera);
  const synthetic::RayCaster rays(*surface, s.camera);
  s.truth.resize(s.depth.depth.size());
  s.inside.resize(s.depth.depth.size());
  for (std::size_t i = 0; i < s.truth.size(); ++i) {
    if (!is_measured(s.depth.depth[i])) continue;
    const double u = static_cast<double>(i % s.camera.width);
    const double v = static_cast<double>(i / s.camera.width);
    s.truth[i] = surface->gradient(rays.point(u, v, s.depth.depth[i]));
  }
  for (std::size_t i = 0; i < s.truth.size(); ++i) {
    s.inside[i] = on_one_surface(s, static_cast<int>(i % s.camera.width),
                                 static_cast<int>(i / s.camera.width));
  }
  return s;
}

DepthImage plane_image(const Camera& camera, Vec3 normal, double distance) {
  DepthImage image{camera.width, camera.height, {}};
  for (std::uint32_t v = 0; v < camera.height; ++v) {
    for (std::uint32_t u = 0; u < camera.width; ++u) {
      const Vec3 ray = unproject(camera.intrinsics, u, v, 1);
      const double z = -distance / dot(normal, ray);
      image.depth.push_back(z > 0 ? static_cast<float>(z) : 0.0F);
    }
  }
  return image;
}

double angle_between(Vec3f a, Vec3 b) {
  return std::atan2(norm(cross(widen(a), b)), dot(widen(a), b));
}

double mean_error(const NormalScene& scene, const std::vector<Vec3f>& normals,
                  const std::vector<bool>& use) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (!use[i] || !exists(normals[i]) || scene.truth[i] == Vec3{}) continue;
    sum += angle_between(normals[i], scene.truth[i]) * 180 / std::numbers::pi;
    count += 1;
  }
  return sum / count;
}

}  // namespace vpm
