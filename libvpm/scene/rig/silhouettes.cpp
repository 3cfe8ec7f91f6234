#include "libvpm/scene/rig/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <memory>
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

// Holds inverse depth, 1/m, of some rows of an image whose small holes are filled with what is
// farther; 0 where nothing is known.
struct FilledRows {
  int width = 0, height = 0;  // of the image
  int first = 0;              // row of the image
  std::vector<float> values = {};

  // Returns row v, or the nearest one of the image.
  const float* row(int v) const {
    return values.data() + static_cast<std::size_t>(std::clamp(v, 0, height - 1) - first) *
                               static_cast<std::size_t>(width);
  }
  // Returns the value of a pixel, or of the nearest one of the image.
  float at(int u, int v) const { return row(v)[std::clamp(u, 0, width - 1)]; }
};

// Takes the least of positive inverse depths of a row, and of those that `least` holds.
VPM_VECTOR_CLONES
void take_less(const InverseDepthRange* row, int count, float* least) {
  for (int u = 0; u < count; ++u) {
    const float value = row[u].high;
    least[u] = (value > 0) & (value < least[u]) ? value : least[u];
  }
}

// Copies the inverse depths of a row. Returns false if all of them are known.
VPM_VECTOR_CLONES
bool copy_row(const InverseDepthRange* from, int count, float* to) {
  std::uint32_t unknown = 0;
  for (int u = 0; u < count; ++u) {
    to[u] = from[u].high;
    unknown |= !(from[u].high > 0);
  }
  return unknown != 0;
}

// Fills holes with the farthest depth of the pixels about them.
class HoleFill {
 public:
  explicit HoleFill(const DepthSampler& image)
      : image_(image), least_(static_cast<std::size_t>(image.width)) {}

  // Writes row v to `filled`.
  void take_row(int v, float* filled) {
    holes_.clear();
    if (!copy_row(row(v), image_.width, filled)) return;
    for (int u = 0; u < image_.width; ++u)
      if (!(filled[u] > 0) && !is_removed(image_.measured[v * image_.width + u]))
        holes_.push_back(u);
    if (holes_.empty()) return;
    find_least_of_columns(v);
    for (const int u : holes_) {
      const float least = *std::min_element(least_.begin() + std::max(u - kFillReach, 0),
                                            least_.begin() + end_about(u));
      filled[u] = least < HUGE_VALF ? least : 0;
    }
  }

 private:
  const InverseDepthRange* row(int v) const { return image_.tiles[0] + v * image_.width; }
  int end_about(int u) const { return std::min(u + kFillReach + 1, image_.width); }
  void find_least_of_columns(int v) {
    const int begin = std::max(holes_.front() - kFillReach, 0), end = end_about(holes_.back());
    std::fill(least_.begin() + begin, least_.begin() + end, HUGE_VALF);
    for (int y = std::max(v - kFillReach, 0); y <= std::min(v + kFillReach, image_.height - 1); ++y)
      take_less(row(y) + begin, end - begin, least_.data() + begin);
  }

  const DepthSampler& image_;
  std::vector<int> holes_;    // columns of the row
  std::vector<float> least_;  // by column, 1/m
};

// Returns rows [begin, end), and those beside them that a blur reads. A band of them stays in the
// cache, in memory that the allocator keeps.
FilledRows filled(const DepthSampler& image, int begin, int end) {
  const int first = std::max(begin - kBlurReach, 0),
            last = std::min(end + kBlurReach, image.height);
  FilledRows rows{image.width, image.height, first};
  const auto width = static_cast<std::size_t>(image.width);
  rows.values.resize(width * static_cast<std::size_t>(last - first));
  HoleFill fill(image);
  for (int v = first; v < last; ++v)
    fill.take_row(v, rows.values.data() + width * static_cast<std::size_t>(v - first));
  return rows;
}

// Sets the direction in which the blurred inverse depth falls at a pixel, whose width is `aspect`
// times its height. What is not known is taken to be as near as the pixel, and turns nothing.
void set_way_out(const FilledRows& image, int u, int v, float aspect, SilhouettePixel& pixel) {
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
float beyond(const FilledRows& image, int u, int v, float inverse) {
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
std::vector<SilhouettePixel> find_pixels(const DepthSampler& image, int begin, int end) {
  const FilledRows all = filled(image, begin, end);
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

// More rows than those within which a silhouette is read.
constexpr std::int8_t kFarRows = kSilhouetteReach + 1;

// Counts for each column the rows since its last silhouette pixel, up to kFarRows.
[[gnu::always_inline]] inline std::int8_t rows_since(std::uint8_t is_silhouette, std::int8_t last) {
  const auto next = static_cast<std::int8_t>(last < kFarRows ? last + 1 : kFarRows);
  return is_silhouette != 0 ? std::int8_t{0} : next;
}
VPM_VECTOR_CLONES
void take_above(const std::uint8_t* is_silhouette, int width, std::int8_t* since,
                std::int8_t* down) {
  for (int u = 0; u < width; ++u) {
    since[u] = rows_since(is_silhouette[u], since[u]);
    down[u] = static_cast<std::int8_t>(-since[u]);
  }
}
VPM_VECTOR_CLONES
void take_below(const std::uint8_t* is_silhouette, int width, std::int8_t* since,
                std::int8_t* down) {
  for (int u = 0; u < width; ++u) {
    since[u] = rows_since(is_silhouette[u], since[u]);
    down[u] = since[u] < -down[u] ? since[u] : down[u];
  }
}

// Returns for each pixel how many rows below it, or above where negative, the nearest silhouette
// pixel in its column is, above before below; -kFarRows where none is within kSilhouetteReach.
std::vector<std::int8_t> rows_down(const std::vector<std::uint8_t>& is_silhouette, int width,
                                   int height) {
  const auto columns = static_cast<std::size_t>(width);
  std::vector<std::int8_t> down(is_silhouette.size());
  std::vector<std::int8_t> since(columns, kFarRows);
  const auto first = [&](int v) { return static_cast<std::size_t>(v) * columns; };
  for (int v = 0; v < height; ++v)
    take_above(is_silhouette.data() + first(v), width, since.data(), down.data() + first(v));
  std::fill(since.begin(), since.end(), kFarRows);
  for (int v = height - 1; v >= 0; --v)
    take_below(is_silhouette.data() + first(v), width, since.data(), down.data() + first(v));
  return down;
}

// Offers what stands in a column, by its key, to the pixels [first, last] of a row.
VPM_VECTOR_CLONES
void offer_column(int column, int first, int last, std::int32_t rows, std::int32_t* keys) {
  for (int u = first; u <= last; ++u) {
    const std::int32_t offered = SilhouetteKeys::key(u - column, rows, column);
    keys[u] = offered < keys[u] ? offered : keys[u];
  }
}

// Finds for each pixel of a row the nearest silhouette pixel of the image. For that it is given the
// one of each column that is nearest to the row. Where several are equally near, the leftmost is
// taken.
class NearestInRow {
 public:
  // Takes the width of the image, and how many times as high as wide a pixel is.
  NearestInRow(int width, double height)
      : width_(width), rule_(height), keys_(static_cast<std::size_t>(width)) {}

  // Takes the row's rows_down(). Calls take(u, column) for each pixel that has one.
  template <class Take>
  void run(const std::int8_t* down, const Take& take) {
    std::fill(keys_.begin(), keys_.end(), SilhouetteKeys::kNone);
    bool any = false;
    for (int u = 0; u < width_; ++u) {
      if (down[u] == -kFarRows) continue;
      any = true;
      spread(u, down[u]);
    }
    for (int u = 0; any && u < width_; ++u) {
      const std::int32_t key = keys_[static_cast<std::size_t>(u)];
      if (key != SilhouetteKeys::kNone) take(u, SilhouetteKeys::column_of(key));
    }
  }

 private:
  // Offers the silhouette pixel of a column, `down` rows below, to the pixels of the row.
  void spread(int column, int down) {
    const std::int32_t rows = rule_.squared_rows[std::abs(down)];
    const int first = std::max(column - kSilhouetteReach, 0);
    const int last = std::min(column + kSilhouetteReach, width_ - 1);
    offer_column(column, first, last, rows, keys_.data());
  }

  int width_;
  SilhouetteKeys rule_;
  std::vector<std::int32_t> keys_;  // squared distance and column
};

// Sets the marks of tiles that have a number in a row of pixels to 1.
void mark_tiles(const std::uint32_t* numbers, int width, std::uint32_t* marks) {
  constexpr int kTile = 1 << Silhouettes::kTileShift;
  for (int first = 0; first < width; first += kTile, ++marks) {
    std::uint32_t any = 0;
    for (int u = first; u < std::min(first + kTile, width); ++u) any |= numbers[u];
    *marks |= any != 0 ? 1U : 0U;
  }
}

}  // namespace

SilhouetteKeys::SilhouetteKeys(double height) {
  for (int down = 0; down <= kSilhouetteReach; ++down) {
    const double rows = down * height;
    squared_rows[down] =
        rows < kSilhouetteReach ? static_cast<std::int32_t>(std::lround(rows * rows)) : kSquared;
  }
}

ImageSilhouettes::ImageSilhouettes(const DepthSampler& image) : holes_(image) {
  std::vector<std::vector<SilhouettePixel>> of_bands(
      static_cast<std::size_t>(bands_of(image.height)));
  for_bands(image.height, [&](int begin, int end) {
    of_bands[static_cast<std::size_t>(begin / kRowsPerBand)] = find_pixels(image, begin, end);
  });
  for (const std::vector<SilhouettePixel>& band : of_bands)
    pixels_.insert(pixels_.end(), band.begin(), band.end());
}

void ImageSilhouettes::spread(const DepthSampler& image) {
  nearest_.assign(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                  0);
  holes_.spread(image);
  if (!pixels_.empty()) find_nearest(image);
  sum_tiles(image.width, image.height);
}

void ImageSilhouettes::find_nearest(const DepthSampler& image) {
  const auto columns = static_cast<std::size_t>(image.width);
  std::vector<std::uint8_t> is_silhouette(nearest_.size(), 0);
  // Of silhouette pixels only: the others are not read.
  const auto numbers = std::make_unique_for_overwrite<std::uint32_t[]>(nearest_.size());
  for (std::size_t k = 0; k < pixels_.size(); ++k) {
    const std::size_t at =
        static_cast<std::size_t>(pixels_[k].v) * columns + static_cast<std::size_t>(pixels_[k].u);
    is_silhouette[at] = 1;
    numbers[at] = static_cast<std::uint32_t>(k + 1);
  }
  const std::vector<std::int8_t> down = rows_down(is_silhouette, image.width, image.height);
  for_bands(image.height, [&](int begin, int end) {
    NearestInRow nearest(image.width, image.k.fx / image.k.fy);
    for (int v = begin; v < end; ++v) {
      const std::size_t first = static_cast<std::size_t>(v) * columns;
      nearest.run(down.data() + first, [&](int u, int column) {
        const auto at = static_cast<std::size_t>(column);
        const auto row = static_cast<std::size_t>(v + down[first + at]);
        nearest_[first + static_cast<std::size_t>(u)] = numbers[row * columns + at];
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
  for (int v = 0; v < height; ++v) {
    const std::size_t first = static_cast<std::size_t>(v) * static_cast<std::size_t>(width);
    std::uint32_t* const row =
        sums_.data() + (static_cast<std::size_t>(v >> Silhouettes::kTileShift) + 1) * columns + 1;
    mark_tiles(nearest_.data() + first, width, row);
    if (!holes_.fits().empty()) mark_tiles(holes_.numbers().data() + first, width, row);
  }
  for (std::size_t at = columns + 1; at < sums_.size(); ++at) {
    if (at % columns == 0) continue;
    sums_[at] += sums_[at - 1] + sums_[at - columns] - sums_[at - columns - 1];
  }
}

}  // namespace vpm
