// Finds the silhouettes of a camera's image: pixels beside which it sees something farther. A body
// of several cameras reads them as surfaces, since the side of an object that one camera sees at a
// grazing angle, or not at all, begins there.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "libvpm/scene/depth/depth_sampler.h"
#include "libvpm/scene/rig/hole_fits.h"

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
  static constexpr int kTileShift = 3;  // tiles of 8 by 8 pixels

  const SilhouettePixel* pixels = nullptr;
  // For each pixel of the image one more than the index of the nearest silhouette pixel; 0 where
  // none is within kSilhouetteReach.
  const std::uint32_t* nearest = nullptr;
  // Summed-area table of tiles: at (u, v), u the faster, the number of tiles left of u and above v
  // that have a pixel with a nearest silhouette, or with the fit of a hole.
  const std::uint32_t* sums = nullptr;
  std::int32_t columns = 0;  // of the table
  HoleFits holes;

  // Returns false if `nearest` names a silhouette at no pixel of a rectangle, and no hole with a
  // fit is there. It may be true without either, as tiles are asked, not pixels.
  VPM_HD bool may_be_near(const PixelRectangle& p) const {
    const std::int32_t u0 = p.u0 >> kTileShift, u1 = (p.u1 >> kTileShift) + 1;
    const std::int32_t above = (p.v0 >> kTileShift) * columns,
                       below = ((p.v1 >> kTileShift) + 1) * columns;
    return sums[below + u1] + sums[above + u0] != sums[below + u0] + sums[above + u1];
  }
};

// Greatest distance, in widths of a pixel and in rows, at which a silhouette is read.
inline constexpr int kSilhouetteReach = 24;

// Orders silhouette pixels by their distance from a pixel of the image: the nearest has the least
// key. Of a column only the one counts that is fewest rows away, above before below.
struct SilhouetteKeys {
  static constexpr std::int32_t kSquared = kSilhouetteReach * kSilhouetteReach;
  static constexpr std::int32_t kColumns = 1 << 17;  // more than an image has
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();
  static_assert(kColumns > static_cast<std::int64_t>(DepthSampler::kMostPixelsASide) &&
                kSquared < kNone / kColumns);

  // By rows, the square of their distance in widths of a pixel; kSquared for those that are not
  // read.
  std::int32_t squared_rows[kSilhouetteReach + 1];

  // Takes how many times as high as wide a pixel is.
  explicit SilhouetteKeys(double height);
  // Returns the key of one that is in a column, `across` columns away; kNone beyond the reach.
  VPM_HD static constexpr std::int32_t key(std::int32_t across, std::int32_t squared_rows,
                                           std::int32_t column) {
    const std::int32_t squared = across * across + squared_rows;
    return squared < kSquared ? squared * kColumns + column : kNone;
  }
  VPM_HD static constexpr std::int32_t column_of(std::int32_t key) { return key % kColumns; }
};

class ImageSilhouettes {
 public:
  ImageSilhouettes() = default;
  // Finds the silhouettes of an image, and fits its holes. A hole within three pixels of a
  // silhouette counts as what is beyond it; what was removed tells nothing of what is there.
  explicit ImageSilhouettes(const DepthSampler& image);
  // Finds the nearest silhouette of each pixel, for view(). A device does so itself
  // (cuda/rig_silhouettes.h).
  void spread(const DepthSampler& image);

  Silhouettes view() const {
    return {pixels_.data(), nearest_.data(), sums_.data(), columns_, holes_.view()};
  }
  const std::vector<SilhouettePixel>& pixels() const { return pixels_; }
  const ImageHoles& holes() const { return holes_; }

 private:
  void find_nearest(const DepthSampler& image);
  void sum_tiles(int width, int height);

  std::vector<SilhouettePixel> pixels_;
  std::vector<std::uint32_t> nearest_;
  std::vector<std::uint32_t> sums_;
  std::int32_t columns_ = 0;
  ImageHoles holes_;
};

}  // namespace vpm
