#include "libvpm/scene/rig/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

#include "libvpm/cloud/row_bands.h"

namespace vpm {
namespace {

// Pixels to each side among which a hole takes the depth that is farthest.
constexpr int kFillReach = 3;
// exp(-k^2 / 8), k = 0 ... 6: weights of a blur of 2 pixels.
constexpr float kBlur[] = {1.0F,        0.88249690F, 0.60653066F, 0.32465247F,
                           0.13533528F, 0.04393693F, 0.01110900F};
constexpr int kBlurReach = static_cast<int>(std::size(kBlur)) - 1;

// Holds inverse depth, 1/m, of an image whose small holes are filled with what is farther.
struct FilledImage {
  int width = 0, height = 0;
  std::vector<float> values;

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }
  // Returns the value of a pixel, or of the nearest one of the image.
  float at(int u, int v) const {
    return values[index(std::clamp(u, 0, width - 1), std::clamp(v, 0, height - 1))];
  }
};

float farthest_around(const DepthSampler& image, int u, int v) {
  float least = HUGE_VALF;
  for (int y = std::max(v - kFillReach, 0); y <= std::min(v + kFillReach, image.height - 1); ++y) {
    for (int x = std::max(u - kFillReach, 0); x <= std::min(u + kFillReach, image.width - 1); ++x) {
      const float value = image.tiles[0][y * image.width + x].high;
      if (value > 0 && value < least) least = value;
    }
  }
  return least < HUGE_VALF ? least : 0;
}

FilledImage filled(const DepthSampler& image) {
  FilledImage all{image.width, image.height, {}};
  all.values.resize(all.index(0, image.height));
  for_bands(image.height, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const float value = image.tiles[0][v * image.width + u].high;
        all.values[all.index(u, v)] = value > 0 ? value : farthest_around(image, u, v);
      }
    }
  });
  return all;
}

// Sets the direction in which the blurred inverse depth falls at a pixel.
void set_way_out(const FilledImage& image, int u, int v, SilhouettePixel& pixel) {
  float along_u = 0, along_v = 0;
  for (int y = -kBlurReach; y <= kBlurReach; ++y) {
    for (int x = -kBlurReach; x <= kBlurReach; ++x) {
      const float weighted = kBlur[std::abs(x)] * kBlur[std::abs(y)] * image.at(u + x, v + y);
      along_u += static_cast<float>(x) * weighted;
      along_v += static_cast<float>(y) * weighted;
    }
  }
  const float length = std::sqrt(along_u * along_u + along_v * along_v);
  if (!(length > 0)) return;
  pixel.out_u = -along_u / length;
  pixel.out_v = -along_v / length;
}

// Returns the least inverse depth of the four pixels beside one that are farther by more than
// kJump; 0 if there are none.
float beyond(const FilledImage& image, int u, int v, float inverse) {
  float least = inverse;
  for (const auto& [x, y] : {std::pair{u + 1, v}, {u - 1, v}, {u, v + 1}, {u, v - 1}}) {
    const float value = image.at(x, y);
    if (value > 0 && value < least) least = value;
  }
  return least < inverse * static_cast<float>(1 - DepthSampler::kJump) ? least : 0;
}

// Returns the silhouette pixels of rows [begin, end), in order.
std::vector<SilhouettePixel> find_pixels(const DepthSampler& image, const FilledImage& all,
                                         int begin, int end) {
  std::vector<SilhouettePixel> pixels;
  for (int v = begin; v < end; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const float inverse = image.tiles[0][v * image.width + u].high;
      if (!(inverse > 0)) continue;
      const float next = beyond(all, u, v, inverse);
      if (!(next > 0)) continue;
      SilhouettePixel pixel{
          static_cast<float>(u), static_cast<float>(v), 1 / inverse, 1 / next, 0, 0};
      set_way_out(all, u, v, pixel);
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

// Returns for each pixel the row of the nearest silhouette pixel in its column within
// kSilhouetteReach, above before below; -1 where there is none. `numbers` holds for each pixel its
// number as a silhouette pixel, or 0.
std::vector<int> nearest_rows(const std::vector<std::uint32_t>& numbers, int width, int height) {
  const auto columns = static_cast<std::size_t>(width);
  std::vector<int> rows(numbers.size(), -1);
  std::vector<int> last(columns, -1);
  const auto take = [&](int v, const auto& is_nearer) {
    const std::size_t first = static_cast<std::size_t>(v) * columns;
    for (std::size_t u = 0; u < columns; ++u) {
      if (numbers[first + u] > 0) last[u] = v;
      const bool is_near = last[u] >= 0 && std::abs(v - last[u]) <= kSilhouetteReach;
      if (is_near && is_nearer(rows[first + u], last[u])) rows[first + u] = last[u];
    }
  };
  for (int v = 0; v < height; ++v) take(v, [](int, int) { return true; });
  std::fill(last.begin(), last.end(), -1);
  for (int v = height - 1; v >= 0; --v)
    take(v, [&](int above, int below) { return above < 0 || below - v < v - above; });
  return rows;
}

// Finds for each pixel of a row the silhouette pixel that is nearest, given the nearest ones of all
// columns. Where several are equally near, the leftmost is taken.
class NearestInRow {
 public:
  explicit NearestInRow(int width) : width_(width), keys_(static_cast<std::size_t>(width)) {}

  // Takes the row's nearest_rows(). Calls take(u, column) for each pixel that has one.
  template <class Take>
  void run(const int* rows, int v, const Take& take) {
    std::fill(keys_.begin(), keys_.end(), kNone);
    bool any = false;
    for (int u = 0; u < width_; ++u) {
      if (rows[u] < 0) continue;
      any = true;
      spread(u, rows[u] - v);
    }
    for (int u = 0; any && u < width_; ++u) {
      const std::int32_t key = keys_[static_cast<std::size_t>(u)];
      if (key != kNone) take(u, key % kColumns);
    }
  }

 private:
  static constexpr std::int32_t kColumns = 1 << 17;  // more than an image has
  static constexpr std::int32_t kNone = std::numeric_limits<std::int32_t>::max();
  static constexpr std::int32_t kSquared = kSilhouetteReach * kSilhouetteReach;
  static_assert(kColumns > static_cast<std::int64_t>(DepthSampler::kMostPixelsASide) &&
                kSquared < kNone / kColumns);

  // Offers the silhouette pixel of a column, `down` rows below, to the pixels of the row.
  void spread(int column, int down) {
    const int first = std::max(column - kSilhouetteReach, 0);
    const int last = std::min(column + kSilhouetteReach, width_ - 1);
    for (int u = first; u <= last; ++u) {
      const int squared = (u - column) * (u - column) + down * down;
      std::int32_t& key = keys_[static_cast<std::size_t>(u)];
      const std::int32_t offered = squared < kSquared ? squared * kColumns + column : kNone;
      key = offered < key ? offered : key;
    }
  }

  int width_;
  std::vector<std::int32_t> keys_;  // squared distance and column
};

}  // namespace

ImageSilhouettes::ImageSilhouettes(const DepthSampler& image) {
  const FilledImage all = filled(image);
  std::vector<std::vector<SilhouettePixel>> of_bands(
      static_cast<std::size_t>(bands_of(image.height)));
  for_bands(image.height, [&](int begin, int end) {
    of_bands[static_cast<std::size_t>(begin / kRowsPerBand)] = find_pixels(image, all, begin, end);
  });
  std::vector<std::uint32_t> numbers(all.values.size(), 0);
  for (const std::vector<SilhouettePixel>& band : of_bands) {
    for (const SilhouettePixel& pixel : band) {
      pixels_.push_back(pixel);
      numbers[all.index(static_cast<int>(pixel.u), static_cast<int>(pixel.v))] =
          static_cast<std::uint32_t>(pixels_.size());
    }
  }
  nearest_.assign(all.values.size(), 0);
  if (pixels_.empty()) return;
  const std::vector<int> rows = nearest_rows(numbers, image.width, image.height);
  for_bands(image.height, [&](int begin, int end) {
    NearestInRow nearest(image.width);
    for (int v = begin; v < end; ++v) {
      const std::size_t first = all.index(0, v);
      nearest.run(rows.data() + first, v, [&](int u, int column) {
        const int row = rows[first + static_cast<std::size_t>(column)];
        nearest_[first + static_cast<std::size_t>(u)] = numbers[all.index(column, row)];
      });
    }
  });
}

}  // namespace vpm
