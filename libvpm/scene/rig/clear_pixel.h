// Tells which pixels of several cameras are worth comparing with each other.
#pragma once

#include <cstddef>
#include <cstdint>

#include "libvpm/cloud/camera.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// Readings of two cameras are of one surface where these hold of them.
inline constexpr double kSameSurface = 0.05;     // per depth: what is further apart is another one
inline constexpr double kAlikeNormals = 0.9;     // least cosine between both cameras' normals
inline constexpr double kFrontal = 0.3;          // least cosine of incidence
inline constexpr std::size_t kFewReadings = 60;  // fewer tell nothing of two cameras
inline constexpr double kDeviationOfMedian = 1.48;  // of magnitudes of normally distributed numbers

// True if the pixels around one show its smooth surface.
bool is_clear_pixel(const DepthSurface& image, std::int32_t u, std::int32_t v);

// Returns the step between pixels at which images are compared: that of about 6000.
std::int32_t step_of_comparison(const DepthSurface& image);

// Calls visit(u, v, place) for the clear ones of every `step`-th pixel of every `step`-th row, with
// the place that the pixel shows, in the camera's frame.
template <class Visit>
void for_clear_pixels(const DepthSurface& image, std::int32_t step, const Visit& visit) {
  for (std::int32_t v = step / 2; v < image.height; v += step) {
    for (std::int32_t u = step / 2; u < image.width; u += step)
      if (is_clear_pixel(image, u, v))
        visit(u, v, unproject(image.k, u, v, 1 / image.inverse_depth(u, v)));
  }
}

}  // namespace vpm
