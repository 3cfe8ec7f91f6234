#include "tools/bench/view.h"

#include "libvpm/cloud/normals.h"
#include "libvpm/synthetic/render.h"

namespace vpm::bench {
namespace {

// Returns a camera at `eye` that looks at the middle of the scenes.
Camera camera_at(Vec3 eye) {
  Camera camera = synthetic::default_camera();
  camera.to_world = synthetic::looking_at(eye, {0, 0, 1}, {0, -1, 0});
  return camera;
}

std::vector<Camera> cameras_of(const synthetic::Scene& scene, CloudKind kind) {
  std::vector<Camera> cameras{scene.camera};
  if (kind == CloudKind::points && scene.name == "step")
    cameras.push_back(camera_at({0.6, 0, 0.25}));
  if (kind == CloudKind::points && scene.name == "plate") cameras.push_back(camera_at({0, 0, 2}));
  return cameras;
}

// Adds the points of a cloud to another, whose origin stays; what belongs to a sensor is left out.
void append(const Cloud& part, Cloud& whole) {
  const Vec3 offset = part.origin - whole.origin;
  for (const Vec3f& place : part.positions)
    whole.positions.push_back(narrow(widen(place) + offset));
  whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
  whole.radii.insert(whole.radii.end(), part.radii.begin(), part.radii.end());
}

}  // namespace

std::string to_text(CloudKind kind) {
  return kind == CloudKind::camera ? "camera" : "points";
}
std::string to_text(Noise noise) {
  return noise == Noise::none ? "none" : "kinect";
}

View make_view(const synthetic::Scene& scene, CloudKind kind, Noise noise,
               std::uint64_t noise_seed) {
  const std::vector<Camera> cameras = cameras_of(scene, kind);
  Cloud points;
  for (std::size_t k = 0; k < cameras.size(); ++k) {
    const DepthImage depth = noise == Noise::none ? synthetic::render(*scene.surface, cameras[k])
                                                  : synthetic::render_with_kinect_noise(
                                                        *scene.surface, cameras[k], noise_seed + k);
    const Cloud seen = make_cloud(depth, cameras[k], NormalOptions{});
    if (kind == CloudKind::camera) return {cameras, AnyBody(seen)};
    append(seen, points);
  }
  return {cameras, AnyBody(points)};
}

}  // namespace vpm::bench
