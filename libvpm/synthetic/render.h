// What a depth camera without noise sees of a surface.
#pragma once

#include <optional>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::synthetic {

// 640 x 480 pixels, f = 525 px, principal point in the middle, at the world's origin looking along
// +z: the factory calibration of the Kinect class.
Camera default_camera();

// Depth along the optical axis at the image position (u, v), pixels: the first place at which the
// ray goes from free space into the obstacle. Surfaces have one side: a camera behind one looks
// through it, so that it can look into an inverted ball from outside.
class RayCaster {
 public:
  RayCaster(const Surface& surface, const Camera& camera) : surface_(surface), camera_(camera) {}
  std::optional<double> depth(double u, double v);
  Vec3 point(double u, double v, double depth) const;  // world

 private:
  const Surface& surface_;
  const Camera& camera_;
  std::vector<double> crossings_;
};

// Exact depth at every pixel's centre, rounded to float; 0 where the ray meets nothing.
DepthImage render(const Surface& surface, const Camera& camera);

}  // namespace vpm::synthetic
