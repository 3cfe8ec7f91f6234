// The noise of a Kinect depth camera: Nguyen, Izadi, Lovell, "Modeling Kinect Sensor Noise for
// Improved 3D Reconstruction and Tracking" (3DIMPVT 2012).
#pragma once

#include <cstdint>

#include "libvpm/synthetic/render.h"

namespace vpm::synthetic {

// Standard deviation of the depth, m, at depth z (m) on a surface whose normal is `angle` (radians)
// off the optical axis; the angle's term counts from 60 degrees on, as the authors fitted it.
double axial_sigma(double z, double angle);

// Standard deviation across the ray, pixels.
double lateral_sigma(double angle);

// Angles beyond this one, where both models go to infinity, count as this one: the authors' data
// end here.
inline constexpr double kLargestAngle = 80 * 3.14159265358979323846 / 180;

// A stream of standard normal numbers that depends on nothing but the seed and the counter: exact
// sampling by comparisons of uniform numbers (von Neumann, Kahn), so the bits are the same on every
// machine.
class NormalNumbers {
 public:
  NormalNumbers(std::uint64_t seed, std::uint64_t counter);
  double next();

 private:
  double uniform();      // [0, 1), 53 bits
  double exponential();  // mean 1
  std::uint64_t state_;
};

// What the camera sees with this noise: each pixel looks a little beside its centre and then errs
// along its ray. The same seed gives the same image for any thread count.
DepthImage render_with_kinect_noise(const Surface& surface, const Camera& camera,
                                    std::uint64_t seed);

}  // namespace vpm::synthetic
