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
  float nearer = 0;  // by which the surface may be nearer
  float a = 0, b = 0, c = 0, d = 0, e = 0, f = 0;
};

// What a fit tells at a place of the image, or fits at four: inverse depth, 1/m, and how it changes
// per pixel.
template <class Real>
struct FitAt {
  Real inverse_depth, per_u, per_v;
};
// Evaluates the fit of a hole at column u and row v of the image, pixels. get(&HoleFit::a), and so
// for its other numbers, returns that number of one fit, or those of four fits in a vector.
template <class Real, class Get>
[[gnu::always_inline]] VPM_HD inline FitAt<Real> evaluate(const Get& get, const Real& u,
                                                          const Real& v) {
  const Real x = u - get(&HoleFit::u), y = v - get(&HoleFit::v);
  const Real b = get(&HoleFit::b), c = get(&HoleFit::c), d = get(&HoleFit::d), e = get(&HoleFit::e),
             f = get(&HoleFit::f);
  return {get(&HoleFit::a) + (b + d * x + e * y) * x + (c + f * y) * y, b + 2 * d * x + e * y,
          c + e * x + 2 * f * y};
}

// Holds plain pointers to the fits of an image, for host or device.
struct HoleFits {
  const HoleFit* fits = nullptr;
  // For each pixel one more than the index of the fit that goes on there; 0 where a surface was
  // measured, or none can be told. Null where there are no fits.
  const std::uint32_t* numbers = nullptr;
  // Bounds the inverse depth of fits in tiles of 8 by 8 pixels from above, 1/m; 0 where there are
  // none.
  const float* greatest = nullptr;
  std::int32_t columns = 0;  // of these tiles

  static constexpr int kTileShift = 3;
  static constexpr std::int32_t tiles(std::int32_t pixels) {
    return ((pixels - 1) >> kTileShift) + 1;
  }

  // True if a place no deeper than `depth`, m, may be behind a fit in a rectangle of pixels.
  VPM_HD bool may_be_behind(const PixelRectangle& p, double depth) const {
    for (std::int32_t v = p.v0 >> kTileShift; v <= p.v1 >> kTileShift; ++v) {
      for (std::int32_t u = p.u0 >> kTileShift; u <= p.u1 >> kTileShift; ++u)
        if (depth * greatest[v * columns + u] >= 1) return true;
    }
    return false;
  }
};

struct NumberedPixel {
  std::uint32_t pixel = 0, number = 0;
};

class ImageHoles {
 public:
  ImageHoles() = default;
  // Fits the smooth surfaces in the rims of holes, or in the rims of their halves where they are
  // wide. The border between two that meet at two places goes straight across; else each goes on
  // where it is nearest. Leaves out holes at the border of the image or beside what was removed,
  // and those of which a pixel is more than 24 away from all that was measured.
  explicit ImageHoles(const DepthSampler& image);
  // Writes numbered() into an image, for view(). A device does so itself (cuda/rig_silhouettes.h).
  void spread(const DepthSampler& image);

  HoleFits view() const {
    return {fits_.data(), fits_.empty() ? nullptr : numbers_.data(), greatest_.data(), columns_};
  }
  const std::vector<HoleFit>& fits() const { return fits_; }
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }
  // Returns the pixels that have a number, and it.
  const std::vector<NumberedPixel>& numbered() const { return numbered_; }
  const std::vector<float>& greatest() const { return greatest_; }

 private:
  std::vector<HoleFit> fits_;
  std::vector<std::uint32_t> numbers_;  // empty if there are no fits, and before spread()
  std::vector<NumberedPixel> numbered_;
  std::vector<float> greatest_;  // empty without fits, too
  std::int32_t columns_ = 0;
};

}  // namespace vpm
