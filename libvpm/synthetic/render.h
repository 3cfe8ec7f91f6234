// Renders what a noise-free depth camera sees of a surface.
#pragma once

#include <optional>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::synthetic {

// Returns a camera of 640 x 480 pixels with f = 525 px, the factory calibration of the Kinect
// class; principal point in the middle, at the world's origin looking along +z.
Camera default_camera();

// Intersects rays of a camera with a surface. depth() returns the depth, m, at image position (u,
// v), pixels, where the ray first enters the obstacle. Surfaces are one-sided: a camera behind one
// looks through it, e.g. into an inverted ball from outside.
class RayCaster {
 public:
  RayCaster(const Surface& surface, const Camera& camera) : surface_(surface), camera_(camera) {}
  std::optional<double> depth(double u, double v);
  // Returns the world point.
  Vec3 point(double u, double v, double depth) const;

 private:
  const Surface& surface_;
  const Camera& camera_;
  std::vector<double> crossings_;
};

// Returns the exact depth at every pixel's centre, rounded to float; 0 where the ray meets nothing.
DepthImage render(const Surface& surface, const Camera& camera);

}  // namespace vpm::synthetic
