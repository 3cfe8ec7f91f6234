// The two estimators of normals, row by row.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>

#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/padded_image.h"

namespace vpm {

// Normals of one row of pixels in camera axes; zero where there is none. Three arrays, since loops
// over them vectorise.
struct NormalRow {
  std::size_t width;
  std::vector<float> x, y, z;  // padded with zeros to a whole tile
  explicit NormalRow(std::size_t pixels)
      : width(pixels), x(pixels + kTile), y(pixels + kTile), z(pixels + kTile) {}
  // Stores `count` normals from pixel `first` on.
  void take(int first, const float* nx, const float* ny, const float* nz, int count) {
    std::copy(nx, nx + count, x.begin() + first);
    std::copy(ny, ny + count, y.begin() + first);
    std::copy(nz, nz + count, z.begin() + first);
  }
};

// Stands for inverse depth beyond the image. As a float it is not a number, so no gate admits it
// and none finds it beyond. Its bits are the greatest unsigned and a negative signed integer, so it
// is neither the minimum nor the maximum in SmoothWindows::scan().
inline const float kBeyondImage = std::bit_cast<float>(0xffffffffU);

// Images that the estimators read, with a margin of half a window.
struct NormalImages {
  PaddedImage inverse;
  PaddedImage depth;  // filled for pca only

  void resize(std::uint32_t width, std::uint32_t height, const NormalOptions& options);
  void take_rows(const DepthImage& image, const NormalOptions& options, int begin, int end);
};

// Estimator with its scratch memory, one per thread. Keeps a reference to the images.
class NormalRows {
 public:
  NormalRows() = default;
  virtual ~NormalRows() = default;
  NormalRows(const NormalRows&) = delete;
  NormalRows& operator=(const NormalRows&) = delete;
  // Computes the normals of row v; `row` must be as wide as the image.
  virtual void estimate(int v, NormalRow& row) = 0;
};

std::unique_ptr<NormalRows> inverse_depth_rows(const NormalImages& images, const Intrinsics& k,
                                               const NormalOptions& options);
std::unique_ptr<NormalRows> pca_rows(const NormalImages& images, const Intrinsics& k,
                                     const NormalOptions& options);
// Returns the estimator of options.method.
std::unique_ptr<NormalRows> normal_rows(const NormalImages& images, const Intrinsics& k,
                                        const NormalOptions& options);

// Estimates the rows of a band, for one thread.
class NormalBand {
 public:
  NormalBand(const NormalImages& images, const Intrinsics& k, const NormalOptions& options)
      : rows_(normal_rows(images, k, options)),
        row_(static_cast<std::size_t>(images.inverse.width)) {}

  // Returns the normals of row v, until the next call.
  const NormalRow& estimate(int v) {
    rows_->estimate(v, row_);
    return row_;
  }

 private:
  std::unique_ptr<NormalRows> rows_;
  NormalRow row_;
};

}  // namespace vpm
