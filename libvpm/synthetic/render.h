// Renders what a depth camera sees of a surface, without noise or with that of a Kinect.
#pragma once

#include <cstdint>
#include <optional>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::synthetic {

// Returns a camera of 640 x 480 pixels with f = 525 px, the factory calibration of the Kinect
// class; principal point in the middle, at the world's origin looking along +z.
Camera default_camera();

// Returns the pose, camera to world, of a camera at `eye` whose optical axis leads through
// `target`, m; `up`, of any length but not along that axis, points up in its image.
Pose looking_at(Vec3 eye, Vec3 target, Vec3 up);

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

// Returns the standard deviation of a Kinect's depth, m, at depth z (m) on a surface whose normal
// is `angle` radians off the optical axis (Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for
// Improved 3D Reconstruction and Tracking", 3DIMPVT 2012). The term of the angle starts at 60
// degrees, as the authors fitted it.
double axial_sigma(double z, double angle);

// Returns the standard deviation of a Kinect across the ray, pixels (same source).
double lateral_sigma(double angle);

// Largest angle, radians, for which the two models are asked: beyond it both diverge, and their
// authors' data end here.
inline constexpr double kLargestAngle = 80 * 3.14159265358979323846 / 180;

// Stream of standard normal numbers that depends only on seed and counter. Exact sampling by
// comparing uniform numbers (von Neumann, Kahn) gives the same bits on every machine.
class NormalNumbers {
 public:
  NormalNumbers(std::uint64_t seed, std::uint64_t counter);
  double next();

 private:
  double uniform();      // [0, 1), 53 bits
  double exponential();  // mean 1
  std::uint64_t state_;
};

// Renders with this noise: each pixel looks slightly beside its centre and then errs along its ray.
// The same seed gives the same image for any thread count.
DepthImage render_with_kinect_noise(const Surface& surface, const Camera& camera,
                                    std::uint64_t seed);

}  // namespace vpm::synthetic
