#include "libvpm/scene/rig/silhouettes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <utility>

#include "libvpm/cloud/depth_image.h"
#include "libvpm/cloud/row_bands.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Pixels to each side among which a hole takes the depth that is farthest.
constexpr int kFillReach = 3;
// exp(-k^2 / 8), k = 0 ... 6: weights of a blur of 2 pixels.
constexpr float kBlur[] = {1.0F,        0.88249690F, 0.60653066F, 0.32465247F,
                           0.13533528F, 0.04393693F, 0.01110900F};
constexpr int kBlurReach = static_cast<int>(std::size(kBlur)) - 1;

// Holds inverse depth, 1/m, of an image whose small holes are filled with what is farther; 0 where
// nothing is known.
struct FilledImage {
  int width = 0, height = 0;
  std::vector<float> values;

  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u);
  }
  // Returns a row, or the nearest one of the image.
  const float* row(int v) const { return values.data() + index(0, std::clamp(v, 0, height - 1)); }
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
        const bool is_hole = !(value > 0) && !is_removed(image.measured[v * image.width + u]);
        all.values[all.index(u, v)] = is_hole ? farthest_around(image, u, v) : value;
      }
    }
  });
  return all;
}

// Sets the direction in which the blurred inverse depth falls at a pixel, whose width is `aspect`
// times its height. What is not known is taken to be as near as the pixel, and turns nothing.
void set_way_out(const FilledImage& image, int u, int v, float aspect, SilhouettePixel& pixel) {
  const float own = image.at(u, v);
  float along_u = 0, along_v = 0;
  for (int y = -kBlurReach; y <= kBlurReach; ++y) {
    const float* const row = image.row(v + y);
    for (int x = -kBlurReach; x <= kBlurReach; ++x) {
      const float value = row[std::clamp(u + x, 0, image.width - 1)];
      const float weighted = kBlur[std::abs(x)] * kBlur[std::abs(y)] * (value > 0 ? value : own);
      along_u += static_cast<float>(x) * weighted;
      along_v += static_cast<float>(y) * weighted;
    }
  }
  along_v *= aspect;
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

// Marks the pixels of a row for which beyond() may be other than 0, and those at its ends.
VPM_VECTOR_CLONES
void mark_candidates(const float* above, const float* own, const float* below, int width,
                     std::uint8_t* marks) {
  constexpr auto kLess = static_cast<float>(1 - DepthSampler::kJump);
  for (int u = 1; u < width - 1; ++u) {
    const float inverse = own[u];
    const auto known = [inverse](float value) { return value > 0 ? value : inverse; };
    const float left = known(own[u - 1]), right = known(own[u + 1]), up = known(above[u]),
                down = known(below[u]);
    const float row = left < right ? left : right, column = up < down ? up : down;
    marks[u] = (row < column ? row : column) < inverse * kLess;
  }
  marks[0] = marks[width - 1] = 1;
}

// Returns the silhouette pixels of rows [begin, end), in order.
std::vector<SilhouettePixel> find_pixels(const DepthSampler& image, const FilledImage& all,
                                         int begin, int end) {
  const auto aspect = static_cast<float>(image.k.fy / image.k.fx);
  std::vector<SilhouettePixel> pixels;
  std::vector<std::uint8_t> marks(static_cast<std::size_t>(image.width));
  for (int v = begin; v < end; ++v) {
    mark_candidates(all.row(v - 1), all.row(v), all.row(v + 1), image.width, marks.data());
    for (int u = 0; u < image.width; ++u) {
      if (marks[static_cast<std::size_t>(u)] == 0) continue;
      const float inverse = image.tiles[0][v * image.width + u].high;
      if (!(inverse > 0)) continue;
      const float next = beyond(all, u, v, inverse);
      if (!(next > 0)) continue;
      SilhouettePixel pixel{
          static_cast<float>(u), static_cast<float>(v), 1 / inverse, 1 / next, 0, 0};
      set_way_out(all, u, v, aspect, pixel);
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

// Takes for each pixel of row v the row of the last silhouette pixel in its column, where that is
// within kSilhouetteReach and nearer than the one that it has.
VPM_VECTOR_CLONES
void take_last_rows(const std::uint32_t* numbers, int v, int width, int* last, int* rows) {
  constexpr int kFar = 2 * kSilhouetteReach;
  for (int u = 0; u < width; ++u) {
    last[u] = numbers[u] > 0 ? v : last[u];
    const int way = v < last[u] ? last[u] - v : v - last[u];
    const int known = v < rows[u] ? rows[u] - v : v - rows[u], other = rows[u] < 0 ? kFar : known;
    rows[u] = (last[u] >= 0) & (way <= kSilhouetteReach) & (way < other) ? last[u] : rows[u];
  }
}

// Returns for each pixel the row of the nearest silhouette pixel in its column within
// kSilhouetteReach, above before below; -1 where there is none. `numbers` holds for each pixel its
// number as a silhouette pixel, or 0.
std::vector<int> nearest_rows(const std::vector<std::uint32_t>& numbers, int width, int height) {
  const auto columns = static_cast<std::size_t>(width);
  std::vector<int> rows(numbers.size(), -1);
  std::vector<int> last(columns, -1);
  const auto take = [&](int v) {
    const std::size_t first = static_cast<std::size_t>(v) * columns;
    take_last_rows(numbers.data() + first, v, width, last.data(), rows.data() + first);
  };
  for (int v = 0; v < height; ++v) take(v);
  std::fill(last.begin(), last.end(), -1);
  for (int v = height - 1; v >= 0; --v) take(v);
  return rows;
}

// Offers what stands in a column, by its key, to the pixels [first, last] of a row.
VPM_VECTOR_CLONES
void offer_column(int column, int first, int last, std::int32_t rows, std::int32_t limit,
                  std::int32_t columns, std::int32_t none, std::int32_t* keys) {
  for (int u = first; u <= last; ++u) {
    const std::int32_t squared = (u - column) * (u - column) + rows;
    const std::int32_t offered = squared < limit ? squared * columns + column : none;
    keys[u] = offered < keys[u] ? offered : keys[u];
  }
}

// Finds for each pixel of a row the nearest silhouette pixel of the image. For that it is given the
// one of each column that is nearest to the row. Where several are equally near, the leftmost is
// taken.
class NearestInRow {
 public:
  // Takes the width of the image, and how many times as high as wide a pixel is.
  NearestInRow(int width, double height) : width_(width), keys_(static_cast<std::size_t>(width)) {
    for (std::size_t down = 0; down < squared_rows_.size(); ++down) {
      const double rows = static_cast<double>(down) * height;
      squared_rows_[down] =
          rows < kSilhouetteReach ? static_cast<std::int32_t>(std::lround(rows * rows)) : kSquared;
    }
  }

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
    const std::int32_t rows = squared_rows_[static_cast<std::size_t>(std::abs(down))];
    const int first = std::max(column - kSilhouetteReach, 0);
    const int last = std::min(column + kSilhouetteReach, width_ - 1);
    offer_column(column, first, last, rows, kSquared, kColumns, kNone, keys_.data());
  }

  int width_;
  // Square of a distance in rows, in widths of a pixel, and less than kSquared where it is read.
  std::array<std::int32_t, kSilhouetteReach + 1> squared_rows_;
  std::vector<std::int32_t> keys_;  // squared distance and column
};

}  // namespace

ImageSilhouettes::ImageSilhouettes(const DepthSampler& image) : holes_(image) {
  const FilledImage all = filled(image);
  std::vector<std::vector<SilhouettePixel>> of_bands(
      static_cast<std::size_t>(bands_of(image.height)));
  for_bands(image.height, [&](int begin, int end) {
    of_bands[static_cast<std::size_t>(begin / kRowsPerBand)] = find_pixels(image, all, begin, end);
  });
  for (const std::vector<SilhouettePixel>& band : of_bands)
    pixels_.insert(pixels_.end(), band.begin(), band.end());
  nearest_.assign(all.values.size(), 0);
  if (!pixels_.empty()) find_nearest(image);
  sum_tiles(image.width, image.height);
}

void ImageSilhouettes::find_nearest(const DepthSampler& image) {
  const auto columns = static_cast<std::size_t>(image.width);
  std::vector<std::uint32_t> numbers(nearest_.size(), 0);
  for (std::size_t k = 0; k < pixels_.size(); ++k) {
    const auto u = static_cast<std::size_t>(pixels_[k].u),
               v = static_cast<std::size_t>(pixels_[k].v);
    numbers[v * columns + u] = static_cast<std::uint32_t>(k + 1);
  }
  const std::vector<int> rows = nearest_rows(numbers, image.width, image.height);
  for_bands(image.height, [&](int begin, int end) {
    NearestInRow nearest(image.width, image.k.fx / image.k.fy);
    for (int v = begin; v < end; ++v) {
      const std::size_t first = static_cast<std::size_t>(v) * columns;
      nearest.run(rows.data() + first, v, [&](int u, int column) {
        const auto at = static_cast<std::size_t>(column);
        nearest_[first + static_cast<std::size_t>(u)] =
            numbers[static_cast<std::size_t>(rows[first + at]) * columns + at];
      });
    }
  });
}

void ImageSilhouettes::sum_tiles(int width, int height) {
  const auto tiles = [](int pixels) {
    return static_cast<std::size_t>((pixels - 1) >> Silhouettes::kTileShift) + 1;
  };
  const std::size_t columns = tiles(width) + 1, rows = tiles(height) + 1;
  columns_ = static_cast<std::int32_t>(columns);
  sums_.assign(columns * rows, 0);
  std::size_t pixel = 0;
  for (std::size_t v = 0; v < static_cast<std::size_t>(height); ++v) {
    std::uint32_t* const row = sums_.data() + ((v >> Silhouettes::kTileShift) + 1) * columns + 1;
    for (std::size_t u = 0; u < static_cast<std::size_t>(width); ++u)
      row[u >> Silhouettes::kTileShift] |= nearest_[pixel++] != 0 ? 1U : 0U;
  }
  for (std::size_t k = 0; k < holes_.numbers().size(); ++k) {
    const std::size_t v = k / static_cast<std::size_t>(width),
                      u = k % static_cast<std::size_t>(width);
    if (holes_.numbers()[k] != 0)
      sums_[((v >> Silhouettes::kTileShift) + 1) * columns + (u >> Silhouettes::kTileShift) + 1] =
          1;
  }
  for (std::size_t at = columns + 1; at < sums_.size(); ++at) {
    if (at % columns == 0) continue;
    sums_[at] += sums_[at - 1] + sums_[at - columns] - sums_[at - columns - 1];
  }
}

}  // namespace vpm
