// Scenes whose normals are known.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/synthetic/render.h"

namespace vpm {

struct NormalScene {
  Camera camera;
  DepthImage depth;          // without noise
  std::vector<Vec3> truth;   // camera coordinates; zero where the ray meets nothing
  std::vector<bool> inside;  // the pixel's 7x7 window lies whole on one smooth surface
};

// A tilted wall, balls and a turned block before it, all about 1 m away, as a Kinect sees them.
synthetic::SurfacePtr room();
NormalScene see(const synthetic::SurfacePtr& surface);

// Exact depth image of the plane normal . x = -distance in a small camera.
DepthImage plane_image(const Camera& camera, Vec3 normal, double distance);

double angle_between(Vec3f a, Vec3 b);  // radians

// Mean angular error in degrees over the pixels that have a normal and where `use` holds.
double mean_error(const NormalScene& scene, const std::vector<Vec3f>& normals,
                  const std::vector<bool>& use);

inline bool exists(Vec3f n) {
  return n.x != 0 || n.y != 0 || n.z != 0;
}

}  // namespace vpm
