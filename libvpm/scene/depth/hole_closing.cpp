#include "libvpm/scene/depth/hole_closing.h"

#include <algorithm>
#include <vector>

#include "libvpm/cloud/row_bands.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

struct ClosedPixel {
  int u, v;
  float value;
};

// Marks pixels of a tile that are not measured but have a measured opposite pair beside them. `at`
// is the first pixel. Returns false if all pixels are measured.
VPM_VECTOR_CLONES
bool mark_candidates(const float* at, std::ptrdiff_t stride, std::uint8_t (&candidate)[kTile]) {
  int holes = 0;
  for (int i = 0; i < kTile; ++i) holes |= at[i] <= 0;
  if (holes == 0) return false;
  const float *up = at - stride, *down = at + stride;
  for (int i = 0; i < kTile; ++i) {
    const auto is_pair = [](float a, float b) { return (a > 0) & (b > 0); };
    candidate[i] =
        (at[i] <= 0) & (is_pair(at[i - 1], at[i + 1]) | is_pair(up[i], down[i]) |
                        is_pair(up[i - 1], down[i + 1]) | is_pair(up[i + 1], down[i - 1]));
  }
  return true;
}

void find_closed(const PaddedImage& image, int begin, int end, std::vector<ClosedPixel>& closed) {
  std::uint8_t candidate[kTile];
  for (int v = begin; v < end; ++v) {
    for (int first = 0; first < image.width; first += kTile) {
      if (!mark_candidates(image.at(first, v), static_cast<std::ptrdiff_t>(image.stride),
                           candidate))
        continue;
      for (int u = first; u < std::min(first + kTile, image.width); ++u) {
        if (candidate[u - first] == 0) continue;
        const float value = between_neighbors([&](int x, int y) { return *image.at(x, y); },
                                              image.width, image.height, u, v);
        if (value > 0) closed.push_back({u, v, value});
      }
    }
  }
}

}  // namespace

void close_holes(PaddedImage& inverse) {
  std::vector<std::vector<ClosedPixel>> closed(static_cast<std::size_t>(bands_of(inverse.height)));
  for (int pass = 0; pass < kFillPasses; ++pass) {
    for_bands(inverse.height, [&](int begin, int end) {
      find_closed(inverse, begin, end, closed[static_cast<std::size_t>(begin / kRowsPerBand)]);
    });
    for (std::vector<ClosedPixel>& of_rows : closed) {
      for (const ClosedPixel& pixel : of_rows) *inverse.at(pixel.u, pixel.v) = pixel.value;
      of_rows.clear();
    }
  }
}

}  // namespace vpm
