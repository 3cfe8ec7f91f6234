// Finds the silhouettes of a camera's image: pixels beside which it sees something farther. A body
// of several cameras reads them as surfaces, since the side of an object that one camera sees at a
// grazing angle, or not at all, begins there.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/scene/depth/depth_sampler.h"

namespace vpm {

// Describes a pixel at a silhouette, on the nearer side.
struct SilhouettePixel {
  float u = 0, v = 0;  // pixels
  float depth = 0;     // m, of this pixel
  float beyond = 0;    // m, of the farthest pixel beside it
  // Unit direction across the rays out of what is nearer, 0 where unknown: of as many pixels as are
  // wide in u, so that it is one in space where pixels are not square.
  float out_u = 0, out_v = 0;
};

// Holds plain pointers to the silhouettes of an image, for host or device.
struct Silhouettes {
  const SilhouettePixel* pixels = nullptr;
  // For each pixel of the image one more than the index of the nearest silhouette pixel; 0 where
  // none is within kSilhouetteReach.
  const std::uint32_t* nearest = nullptr;
};

// Greatest distance, in widths of a pixel and in rows, at which a silhouette is read.
inline constexpr int kSilhouetteReach = 24;

class ImageSilhouettes {
 public:
  ImageSilhouettes() = default;
  // Finds the silhouettes of an image. A hole within three pixels of a silhouette counts as what is
  // beyond it; what was removed tells nothing of what is there.
  explicit ImageSilhouettes(const DepthSampler& image);

  Silhouettes view() const { return {pixels_.data(), nearest_.data()}; }
  const std::vector<SilhouettePixel>& pixels() const { return pixels_; }
  const std::vector<std::uint32_t>& nearest() const { return nearest_; }

 private:
  std::vector<SilhouettePixel> pixels_;
  std::vector<std::uint32_t> nearest_;
};

}  // namespace vpm
