// Continues the surfaces around small holes of a camera's image across them. A body of several
// cameras asks for it where another camera has something before a place, which this one may have
// seen free but for the hole. README.md has the reasons.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/scene/depth/depth_sampler.h"

namespace vpm {

// A paraboloid of inverse depth, 1/m: a + b x + c y + d x^2 + e x y + f y^2 at x pixels right of
// (u, v) and y below.
struct HoleFit {
  float u = 0, v = 0;
  float a = 0, b = 0, c = 0, d = 0, e = 0, f = 0;
};

// Holds plain pointers to the fits of an image, for host or device.
struct HoleFits {
  const HoleFit* fits = nullptr;
  // For each pixel one more than the index of the fit that goes on there; 0 where a surface was
  // measured, or none can be told. Null where there are no fits.
  const std::uint32_t* numbers = nullptr;
};

class ImageHoles {
 public:
  ImageHoles() = default;
  // Fits holes of an image whose rim is one smooth surface, or two, one before the other; then the
  // border between them goes straight across. Leaves out holes at the border of the image or beside
  // what was removed, and those wider or higher than 48 pixels.
  explicit ImageHoles(const DepthSampler& image);

  HoleFits view() const { return {fits_.data(), fits_.empty() ? nullptr : numbers_.data()}; }
  const std::vector<HoleFit>& fits() const { return fits_; }
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }

 private:
  std::vector<HoleFit> fits_;
  std::vector<std::uint32_t> numbers_;  // empty if there are no fits
};

}  // namespace vpm
