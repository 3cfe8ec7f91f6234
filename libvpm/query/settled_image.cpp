#include "libvpm/query/settled_image.h"

#include <algorithm>
#include <functional>

#include "libvpm/cloud/vector_tile.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

constexpr std::size_t kRowsPerTask = 32;

// Windows of a row, as sums down each of their columns.
struct ColumnSums {
  static constexpr int kNumbers = 6;
  std::vector<float> numbers[kNumbers];  // of column u at u + kSettledRadius

  explicit ColumnSums(std::size_t stride) {
    for (std::vector<float>& of_columns : numbers) of_columns.resize(stride + kTile);
  }
  [[gnu::always_inline]] void set(int i, const WindowOfDepths<Floats>& column) {
    const Floats values[] = {column.sum,      column.squares,    column.all.low,
                             column.all.high, column.beside.low, column.beside.high};
    for (int k = 0; k < kNumbers; ++k) store(values[k], numbers[k].data() + i);
  }
  [[gnu::always_inline]] WindowOfDepths<Floats> at(int i) const {
    const auto number = [&](int k) __attribute__((always_inline)) {
      return load<Floats>(numbers[k].data() + i);
    };
    WindowOfDepths<Floats> column;
    column.sum = number(0), column.squares = number(1);
    column.all = {number(2), number(3)};
    column.beside = {number(4), number(5)};
    return column;
  }
};

[[gnu::always_inline]] inline void sum_columns(const PaddedImage& inverse, int v,
                                               ColumnSums& columns) {
  const auto stride = static_cast<std::ptrdiff_t>(inverse.stride);
  for (int i = 0; i < inverse.width + 2 * kSettledRadius; i += kLanes) {
    const float* middle = inverse.at(i - kSettledRadius, v);
    WindowOfDepths<Floats> column(load<Floats>(middle));
    for (int d = 1; d <= kSettledRadius; ++d)
      column.add_rows(load<Floats>(middle + d * stride), load<Floats>(middle - d * stride), d);
    columns.set(i, column);
  }
}

// The windows about pixels u, u + 1, ...
[[gnu::always_inline]] inline WindowOfDepths<Floats> windows_at(const ColumnSums& columns, int u) {
  const int middle = u + kSettledRadius;
  WindowOfDepths<Floats> window = columns.at(middle);
  for (int d = 1; d <= kSettledRadius; ++d)
    window.add_columns(columns.at(middle + d), columns.at(middle - d), d);
  return window;
}

struct Tile {
  float inverse[kTile];
  VectorTile normals;  // before they are made of unit length
};

[[gnu::always_inline]] inline void settle_tile(const PaddedImage& inverse, const NormalImage& seen,
                                               const ColumnSums& columns, int first, int v,
                                               Tile& tile) {
  const auto at = [&](int u, int row) __attribute__((always_inline)) {
    return SeenPixel<Floats>{load<Floats>(inverse.at(u, row)), load<Floats>(seen.x.at(u, row)),
                             load<Floats>(seen.y.at(u, row)), load<Floats>(seen.z.at(u, row))};
  };
  for (int i = 0; i < kTile; i += kLanes) {
    const int u = first + i;
    if (u >= inverse.width) break;
    SettledPixel<Floats> pixel(at(u, v));
    for (int dv = -kSettledAcross; dv <= kSettledAcross; dv += kSettledAcross) {
      for (int du = -kSettledAcross; du <= kSettledAcross; du += kSettledAcross) {
        if (du != 0 || dv != 0) pixel.add(at(u + du, v + dv));
      }
    }
    store(pixel.inverse_depth(windows_at(columns, u)), tile.inverse + i);
    store(pixel.x(), tile.normals.x + i);
    store(pixel.y(), tile.normals.y + i);
    store(pixel.z(), tile.normals.z + i);
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
void settle_row(const PaddedImage& inverse, const NormalImage& seen, int v, ColumnSums& columns,
                float* settled, Vec3f* normals) {
  sum_columns(inverse, v, columns);
  for (int first = 0; first < inverse.width; first += kTile) {
    const int count = std::min(kTile, inverse.width - first);
    Tile tile{};  // zeros beyond the last pixel
    settle_tile(inverse, seen, columns, first, v, tile);
    std::copy(tile.inverse, tile.inverse + count, settled + first);
    unit_length(tile.normals).store(count, normals + first);
  }
}

void for_rows(int height, const std::function<void(int begin, int end)>& body) {
  parallel_for(static_cast<std::size_t>(height), kRowsPerTask,
               [&](std::size_t begin, std::size_t end) {
                 body(static_cast<int>(begin), static_cast<int>(end));
               });
}

std::size_t first_of_row(const PaddedImage& image, int v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(image.width);
}

}  // namespace

void NormalImage::resize(std::uint32_t width, std::uint32_t height) {
  for (PaddedImage* image : {&x, &y, &z}) image->resize(width, height, kSettledAcross);
}

void NormalImage::set(int u, int v, Vec3f normal) {
  *x.at(u, v) = normal.x;
  *y.at(u, v) = normal.y;
  *z.at(u, v) = normal.z;
}

void settle(const PaddedImage& inverse, const NormalImage& seen, PaddedImage& settled,
            std::vector<Vec3f>& normals) {
  const auto width = static_cast<std::uint32_t>(inverse.width),
             height = static_cast<std::uint32_t>(inverse.height);
  settled.resize(width, height, 0);
  normals.resize(std::size_t{width} * height);
  for_rows(inverse.height, [&](int begin, int end) {
    ColumnSums columns(inverse.stride);
    for (int v = begin; v < end; ++v)
      settle_row(inverse, seen, v, columns, settled.at(0, v),
                 normals.data() + first_of_row(inverse, v));
  });
}

void take_normals(const NormalImage& seen, std::vector<Vec3f>& normals) {
  const PaddedImage& image = seen.x;
  normals.resize(first_of_row(image, image.height));
  for_rows(image.height, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      Vec3f* const row = normals.data() + first_of_row(image, v);
      for (int u = 0; u < image.width; ++u)
        row[u] = {*seen.x.at(u, v), *seen.y.at(u, v), *seen.z.at(u, v)};
    }
  });
}

void take_pixels(const PaddedImage& image, std::vector<float>& pixels) {
  pixels.resize(first_of_row(image, image.height));
  for_rows(image.height, [&](int begin, int end) {
    for (int v = begin; v < end; ++v)
      std::copy_n(image.at(0, v), image.width, pixels.data() + first_of_row(image, v));
  });
}

}  // namespace vpm
