// Closes holes between pixels that see one surface, up to two pixels from the rim.
#pragma once

#include "libvpm/cloud/padded_image.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// Sets the passes, each of which closes pixels next to the last, so holes of twice that width
// close.
inline constexpr int kFillPasses = 2;

// Returns the mean inverse depth of opposite neighbours that see one surface, which is exact on a
// plane; 0 where there are none. `image(u, v)` is the inverse depth, 0 where unknown.
template <class Image>
VPM_HD float between_neighbors(const Image& image, int width, int height, int u, int v) {
  double sum = 0;
  int pairs = 0;
  const auto add_pair = [&](int du, int dv) {
    const int above = dv < 0 ? v + dv : v - dv, below = dv < 0 ? v - dv : v + dv;
    if (u - du < 0 || u + du >= width || above < 0 || below >= height) return;
    const double a = image(u - du, v - dv), b = image(u + du, v + dv);
    if (!(a > 0 && b > 0) || std::fabs(a - b) > DepthSurface::kJump * (a < b ? b : a)) return;
    sum += a + b;
    ++pairs;
  };
  add_pair(1, 0);
  add_pair(0, 1);
  add_pair(1, 1);
  add_pair(1, -1);
  return pairs > 0 ? static_cast<float>(sum / (2 * pairs)) : 0.0F;
}

// Closes the holes of a whole image of inverse depth with a margin.
void close_holes(PaddedImage& inverse);

}  // namespace vpm
