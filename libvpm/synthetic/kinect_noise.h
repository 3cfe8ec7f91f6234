// Noise of a Kinect depth camera (Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for Improved
// 3D Reconstruction and Tracking", 3DIMPVT 2012).
#pragma once

#include <cstdint>

#include "libvpm/synthetic/render.h"

namespace vpm::synthetic {

// Returns the standard deviation of depth, m, at depth z (m) on a surface whose normal is `angle`
// radians off the optical axis. The term of the angle starts at 60 degrees, as the authors fitted
// it.
double axial_sigma(double z, double angle);

// Returns the standard deviation across the ray, pixels.
double lateral_sigma(double angle);

// Clamps angles, radians: both models diverge, and the authors' data end here.
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
