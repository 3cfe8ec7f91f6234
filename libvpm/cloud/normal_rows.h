// The two estimators, row by row.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>

#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/padded_image.h"

namespace vpm {

// Normals of one row of pixels, camera axes; zero where there is none. Three arrays, since that is
// what loops over pixels are quick with.
struct NormalRow {
  std::size_t width;
  std::vector<float> x, y, z;  // zeros behind the last one fill a tile
  explicit NormalRow(std::size_t pixels)
      : width(pixels), x(pixels + kTile), y(pixels + kTile), z(pixels + kTile) {}
  // Takes `count` normals from pixel `first` on.
  void take(int first, const float* nx, const float* ny, const float* nz, int count) {
    std::copy(nx, nx + count, x.begin() + first);
    std::copy(ny, ny + count, y.begin() + first);
    std::copy(nz, nz + count, z.begin() + first);
  }
};

// What stands for inverse depth beyond the image: not a number, so that it is in no gate and beyond
// none, and its bits are the greatest unsigned integer and less than any that is signed and not
// negative, so that it is neither the least nor the greatest of others.
inline const float kBeyondImage = std::bit_cast<float>(0xffffffffU);

// What the estimators read: the frame with a margin of half a window.
struct NormalImages {
  PaddedImage inverse;
  PaddedImage depth;  // of pca only

  void resize(std::uint32_t width, std::uint32_t height, const NormalOptions& options);
  void take_rows(const DepthImage& image, const NormalOptions& options, int begin, int end);
};

// An estimator with its scratch: one for each thread. The images must outlive it.
class NormalRows {
 public:
  NormalRows() = default;
  virtual ~NormalRows() = default;
  NormalRows(const NormalRows&) = delete;
  NormalRows& operator=(const NormalRows&) = delete;
  // `row` is as wide as the image.
  virtual void estimate(int v, NormalRow& row) = 0;
};

std::unique_ptr<NormalRows> inverse_depth_rows(const NormalImages& images, const Intrinsics& k,
                                               const NormalOptions& options);
std::unique_ptr<NormalRows> pca_rows(const NormalImages& images, const Intrinsics& k,
                                     const NormalOptions& options);
// The one that the options name.
std::unique_ptr<NormalRows> normal_rows(const NormalImages& images, const Intrinsics& k,
                                        const NormalOptions& options);

}  // namespace vpm
