#include "libvpm/scene/depth/denoised_image.h"

#include <algorithm>
#include <vector>

#include "libvpm/cloud/padded_image.h"
#include "libvpm/cloud/row_bands.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

struct ClosedPixel {
  int u, v;
  float value;
};

// Marks pixels of a tile that are holes but have a measured opposite pair beside them. `at`
// is the first pixel. Returns false if none is a hole.
VPM_VECTOR_CLONES
bool mark_candidates(const float* at, std::ptrdiff_t stride, std::uint8_t (&candidate)[kTile]) {
  int holes = 0;
  for (int i = 0; i < kTile; ++i) holes |= is_hole(at[i]);
  if (holes == 0) return false;
  const float *up = at - stride, *down = at + stride;
  for (int i = 0; i < kTile; ++i) {
    const auto is_pair = [](float a, float b) { return (a > 0) & (b > 0); };
    candidate[i] =
        is_hole(at[i]) & (is_pair(at[i - 1], at[i + 1]) | is_pair(up[i], down[i]) |
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

// Unites two rows of tiles to one of the next level; the last tile of an odd width has one column.
VPM_VECTOR_CLONES
void unite_rows(const InverseDepthRange* __restrict above,
                const InverseDepthRange* __restrict below, std::size_t width,
                InverseDepthRange* __restrict tiles) {
  for (std::size_t u = 0; u < width / 2; ++u) {
    tiles[u] =
        united(united(above[2 * u], above[2 * u + 1]), united(below[2 * u], below[2 * u + 1]));
  }
  if (width % 2 != 0) tiles[width / 2] = united(above[width - 1], below[width - 1]);
}

// Sums down each column of the windows of some pixels of a row.
class ColumnSums {
 public:
  // Enough pixels that what is stored for the first ones has left the CPU's store queue when it is
  // loaded across lanes, which CPUs do not forward.
  static constexpr int kPixels = 8 * kTile;

  // Sums from pixel `first` of row v to the row's last tile.
  [[gnu::always_inline]] ColumnSums(const PaddedImage& inverse, int first, int v) {
    const auto stride = static_cast<std::ptrdiff_t>(inverse.stride);
    const int columns = std::min(kColumns, inverse.width - first + kTile);
    for (int i = 0; i < columns; i += kLanes) {
      const float* middle = inverse.at(first + i - kDenoisedRadius, v);
      set(i, column_of_depths<Floats>([&](int dv) __attribute__((always_inline)) {
            return load<Floats>(middle + dv * stride);
          }));
    }
  }
  // Returns the windows of pixels first + i, first + i + 1, ...
  [[gnu::always_inline]] WindowOfDepths<Floats> windows_at(int i) const {
    return window_of_depths<Floats>([&](int du) __attribute__((always_inline)) {
      return at(i + kDenoisedRadius + du);
    });
  }

 private:
  static constexpr int kNumbers = 6;
  static constexpr int kColumns = kPixels + kLanes;  // whole lanes
  static_assert(2 * kDenoisedRadius <= kLanes);

  [[gnu::always_inline]] void set(int i, const WindowOfDepths<Floats>& column) {
    const Floats values[] = {column.sum,      column.squares,    column.all.low,
                             column.all.high, column.beside.low, column.beside.high};
    for (int k = 0; k < kNumbers; ++k) store(values[k], numbers_[k] + i);
  }
  [[gnu::always_inline]] WindowOfDepths<Floats> at(int i) const {
    const auto number = [&](int k) __attribute__((always_inline)) {
      return load<Floats>(numbers_[k] + i);
    };
    WindowOfDepths<Floats> column;
    column.sum = number(0), column.squares = number(1);
    column.all = {number(2), number(3)};
    column.beside = {number(4), number(5)};
    return column;
  }

  float numbers_[kNumbers][kColumns];
};

struct Tile {
  float inverse[kTile];
  VectorTile normals;  // not of unit length
};

// Reads the pixels of normals and inverse depths from (u, v) on.
class SeenFrom {
 public:
  [[gnu::always_inline]] SeenFrom(const SeenImage& seen, const PaddedImage& inverse, int u, int v)
      : stride_(static_cast<std::ptrdiff_t>(inverse.stride)),
        inverse_(inverse.at(u, v)),
        x_(seen.x.at(u, v)),
        y_(seen.y.at(u, v)),
        z_(seen.z.at(u, v)) {}

  // Returns the pixels at this offset.
  [[gnu::always_inline]] SeenPixel<Floats> operator()(int du, int dv) const {
    const std::ptrdiff_t at = dv * stride_ + du;
    return {load<Floats>(inverse_ + at), load<Floats>(x_ + at), load<Floats>(y_ + at),
            load<Floats>(z_ + at)};
  }

 private:
  std::ptrdiff_t stride_;
  const float *inverse_, *x_, *y_, *z_;
};

// Denoises pixel u of row v and those to its right; `columns` holds their windows from column i on.
[[gnu::always_inline]] inline void denoise_tile(const SeenImage& seen, int u, int v,
                                                const ColumnSums& columns, int i, Tile& tile) {
  for (int k = 0; k < kTile; k += kLanes) {
    const SeenFrom pixels(seen, seen.marked, u + k, v);
    const NormalSum<Floats> normal = denoised_normal<Floats>(pixels);
    store(denoised_inverse_depth(pixels(0, 0), columns.windows_at(i + k)), tile.inverse + k);
    store(normal.x, tile.normals.x + k);
    store(normal.y, tile.normals.y + k);
    store(normal.z, tile.normals.z + k);
  }
}

[[gnu::always_inline]] inline VectorTile unit_length(const VectorTile& sums) {
  VectorTile unit;
  for (int i = 0; i < kTile; ++i) {
    const float x = sums.x[i], y = sums.y[i], z = sums.z[i], scale = per_length(x, y, z);
    unit.x[i] = x * scale, unit.y[i] = y * scale, unit.z[i] = z * scale;
  }
  return unit;
}

VPM_VECTOR_CLONES
void mark_row(const SeenImage& seen, int v, float* marks) {
  for (int first = 0; first < seen.inverse.width; first += kTile) {
    float tile[kTile];
    for (int k = 0; k < kTile; k += kLanes) {
      const SeenFrom pixels(seen, seen.inverse, first + k, v);
      store(marked(pixels(0, 0).inverse, is_clear<Floats>(pixels)), tile + k);
    }
    std::copy_n(tile, std::min(kTile, seen.inverse.width - first), marks + first);
  }
}

VPM_VECTOR_CLONES
void denoise_row(const SeenImage& seen, int v, InverseDepthRange* depths, Vec3f* normals) {
  const int width = seen.inverse.width;
  for (int first = 0; first < width; first += ColumnSums::kPixels) {
    const ColumnSums columns(seen.inverse, first, v);
    for (int u = first; u < std::min(first + ColumnSums::kPixels, width); u += kTile) {
      const int count = std::min(kTile, width - u);
      Tile tile;
      denoise_tile(seen, u, v, columns, u - first, tile);
      for (int k = 0; k < count; ++k) depths[u + k] = {tile.inverse[k], tile.inverse[k]};
      unit_length(tile.normals).store(count, normals + u);
    }
  }
}

// Returns the inverse depth, 0 also where the pixel was removed: no reader of the surface asks why.
inline float without_mark(float inverse) {
  return inverse + 0.0F;
}

VPM_VECTOR_CLONES
void mark_removed(const float* depth, int width, float* inverse) {
  for (int u = 0; u < width; ++u) inverse[u] = is_removed(depth[u]) ? depth[u] : inverse[u];
}

VPM_VECTOR_CLONES
void take_row(const SeenImage& seen, int v, InverseDepthRange* depths, Vec3f* normals) {
  const float *inverse = seen.inverse.at(0, v), *x = seen.x.at(0, v), *y = seen.y.at(0, v),
              *z = seen.z.at(0, v);
  for (int u = 0; u < seen.inverse.width; ++u) {
    const float known = without_mark(inverse[u]);
    depths[u] = {known, known};
    normals[u] = {x[u], y[u], z[u]};
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

void SeenImage::resize(std::uint32_t width, std::uint32_t height) {
  static_assert(kDenoisedRadius <= kDenoisedReach, "the margin holds windows too");
  for (PaddedImage* image : {&inverse, &x, &y, &z, &marked})
    image->resize(width, height, kDenoisedReach);
}

void SeenImage::set_normal(int u, int v, Vec3f normal) {
  *x.at(u, v) = normal.x;
  *y.at(u, v) = normal.y;
  *z.at(u, v) = normal.z;
}

void SeenImage::take_removed(const DepthImage& depth, int begin, int end) {
  for (int v = begin; v < end; ++v)
    mark_removed(depth.depth.data() + static_cast<std::size_t>(v) * depth.width, inverse.width,
                 inverse.at(0, v));
}

void SeenImage::mark_rows(int begin, int end) {
  for (int v = begin; v < end; ++v) mark_row(*this, v, marked.at(0, v));
}

void DenoisedImage::resize(std::uint32_t new_width, std::uint32_t new_height) {
  width_ = static_cast<int>(new_width), height_ = static_cast<int>(new_height);
  normals_.resize(first_of_row(height_));
  measured_.resize(first_of_row(height_));
  std::size_t width = new_width, height = new_height, levels = 1;
  for (std::size_t side = std::max(width, height); side > 1; side = (side + 1) / 2) ++levels;
  tiles_.resize(levels);
  for (std::vector<InverseDepthRange>& level : tiles_) {
    level.resize(width * height);
    width = (width + 1) / 2, height = (height + 1) / 2;
  }
}

void DenoisedImage::read_rows(const SeenImage& seen, Denoising points, int begin, int end) {
  const auto read_row = points == Denoising::on ? denoise_row : take_row;
  for (int v = begin; v < end; ++v) {
    read_row(seen, v, tiles_[0].data() + first_of_row(v), normals_.data() + first_of_row(v));
    std::copy_n(seen.inverse.at(0, v), width_, measured_.data() + first_of_row(v));
  }
}

void DenoisedImage::unite() {
  auto width = static_cast<std::size_t>(width_), height = static_cast<std::size_t>(height_);
  for (std::size_t k = 1; k < tiles_.size(); ++k) {
    const InverseDepthRange* fine = tiles_[k - 1].data();
    const std::size_t half_width = (width + 1) / 2, half_height = (height + 1) / 2;
    for_bands(static_cast<int>(half_height), [&](int begin, int end) {
      for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
        const InverseDepthRange* above = fine + 2 * v * width;
        unite_rows(above, 2 * v + 1 < height ? above + width : above, width,
                   tiles_[k].data() + v * half_width);
      }
    });
    width = half_width, height = half_height;
  }
}

DepthSurface DenoisedImage::surface(const Intrinsics& k) const {
  DepthSurface surface;
  surface.k = k;
  surface.width = width_;
  surface.height = height_;
  surface.levels = std::min(static_cast<int>(tiles_.size()), DepthSurface::kMaxLevels);
  surface.normals = normals_.data();
  surface.measured = measured_.data();
  for (int level = 0; level < surface.levels; ++level)
    surface.tiles[level] = tiles_[static_cast<std::size_t>(level)].data();
  return surface;
}

}  // namespace vpm
