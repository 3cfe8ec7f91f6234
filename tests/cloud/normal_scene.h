// Scenes with known normals.
#pragma once

#include "libvpm/cloud/normals.h"
#include "libvpm/synthetic/render.h"

namespace vpm {

struct NormalScene {
  Camera camera;
  DepthImage depth;          // without noise
  std::vector<Vec3> truth;   // camera coordinates; zero where the ray meets nothing
  std::vector<bool> inside;  // true if the pixel's 7x7 window lies on one smooth surface
};

// Returns a tilted wall with balls and a turned block in front of it, all about 1 m away, as a
// Kinect sees them.
synthetic::SurfacePtr room();
NormalScene see(const synthetic::SurfacePtr& surface);

// Returns the exact depth image of the plane normal . x = -distance in a small camera.
DepthImage plane_image(const Camera& camera, Vec3 normal, double distance);

double angle_between(Vec3f a, Vec3 b);  // radians

// Returns the mean angular error in degrees over the pixels that have a normal and satisfy `use`.
double mean_error(const NormalScene& scene, const std::vector<Vec3f>& normals,
                  const std::vector<bool>& use);

inline bool exists(Vec3f n) {
  return n.x != 0 || n.y != 0 || n.z != 0;
}

}  // namespace vpm
