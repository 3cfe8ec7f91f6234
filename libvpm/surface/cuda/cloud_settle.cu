#include <math_constants.h>

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/surface/cuda/cloud_settle.h"
#include "libvpm/surface/settled_pixel.h"

namespace vpm::cuda {
namespace {

using Frame = TileFrame<kSettledAcross>;
using Window = WindowOfDepths<float>;

constexpr int kWidth = kTileWidth + 2 * kSettledAcross, kHeight = kTileHeight + 2 * kSettledAcross;
constexpr int kColumns = kTileWidth + 2 * kSettledRadius;
constexpr int kRanges = kTilePixels / 4 + kTilePixels / 16 + kTilePixels / 64 + 2;
static_assert(kSettledRadius <= kSettledAcross);

struct SharedTile {
  float inverse[kWidth * kHeight];         // with the margin
  float4 seen[kWidth * kHeight];           // normals and, again, inverse depth: read together
  Window columns[kColumns * kTileHeight];  // of the windows
  float surface[kTilePixels];
  Vec3f normals[kTilePixels];
  InverseDepthRange ranges[kRanges];
};

// One tile of an image, by a block.
class SettleWork {
 public:
  __device__ SettleWork(const CloudRecipe& recipe, SharedTile& shared)
      : recipe_(recipe), tile_(recipe), shared_(shared) {}

  __device__ bool is_done() const { return tile_.is_made; }

  // A row by each warp. Zeros outside of the image.
  __device__ void load() const {
    constexpr int kWarps = kTileThreads / 32;
    const auto* const words = reinterpret_cast<const float*>(recipe_.seen);
    auto* const seen = reinterpret_cast<float*>(shared_.seen);
#pragma unroll
    for (int row = thread() / 32; row < kHeight; row += kWarps) {
      const int v = tile_.v0 + row - kSettledAcross, u = tile_.u0 - kSettledAcross;
      const bool is_row = v >= 0 && v < tile_.height;
      const std::ptrdiff_t first = std::ptrdiff_t{v} * tile_.width + u;
#pragma unroll
      for (int x = thread() % 32; x < kWidth; x += 32) {
        const bool is_inside = is_row && u + x >= 0 && u + x < tile_.width;
        const float inverse = is_inside ? recipe_.room.measured[first + x] : 0.0F;
        shared_.inverse[row * kWidth + x] = inverse;
        seen[4 * (row * kWidth + x) + 3] = inverse;
      }
#pragma unroll
      for (int w = thread() % 32; w < 3 * kWidth; w += 32) {
        const bool is_inside = is_row && 3 * u + w >= 0 && 3 * u + w < 3 * tile_.width;
        seen[4 * (row * kWidth + w / 3) + w % 3] = is_inside ? words[3 * first + w] : 0.0F;
      }
    }
  }

  __device__ void sum_columns() const {
    for (int k = thread(); k < kColumns * kTileHeight; k += kTileThreads) {
      const float* const middle =
          shared_.inverse + tile_.index(k % kColumns - kSettledRadius, k / kColumns);
      shared_.columns[k] = column_of_depths<float>([&](int dv) { return middle[dv * kWidth]; });
    }
  }

  __device__ void settle() const {
    for (int k = thread(); k < kTilePixels; k += kTileThreads) {
      const int x = k % kTileWidth, y = k / kTileWidth;
      const auto pixel =
          settled_pixel<float>([&](int du, int dv) { return seen_at(x + du, y + dv); });
      const float scale = per_length(pixel.x(), pixel.y(), pixel.z());
      shared_.surface[k] = pixel.inverse_depth(window_at(x, y));
      shared_.normals[k] = {pixel.x() * scale, pixel.y() * scale, pixel.z() * scale};
    }
  }
  __device__ void take_as_measured() const {
    for (int k = thread(); k < kTilePixels; k += kTileThreads) {
      const SeenPixel<float> pixel = seen_at(k % kTileWidth, k / kTileWidth);
      shared_.surface[k] = pixel.inverse;
      shared_.normals[k] = {pixel.x, pixel.y, pixel.z};
    }
  }

  __device__ void write_normals() const {
    write_rows(tile_, shared_.normals, recipe_.room.pixel_normals);
  }

  // Levels 0 to kTileLevels, and this tile's part of what lies above. Meets after each.
  __device__ void write_tiles() const {
    for (int k = thread(); k < kTilePixels; k += kTileThreads) {
      const int x = k % kTileWidth, y = k / kTileWidth;
      const float value = shared_.surface[k];
      if (tile_.holds(x, y)) recipe_.room.tiles[0][tile_.pixel(x, y)] = {value, value};
    }
    InverseDepthRange* fine = nullptr;
    InverseDepthRange* coarse = shared_.ranges;
    for (int level = 1; level <= kTileLevels; ++level) {
      const int count = (kTileWidth >> level) * (kTileHeight >> level);
      if (thread() < count) coarse[thread()] = write_tile(level, fine);
      fine = coarse;
      coarse += count;
      __syncthreads();
    }
    // Inverse depths are not negative, so they are in the order of their bits.
    const int level = kTileLevels + 1 + thread();
    if (level >= recipe_.room.levels) return;
    const InverseDepthRange range = united(fine[0], fine[1]);
    auto* const above = reinterpret_cast<int*>(tile_at(level, tile_.u0, tile_.v0));
    atomicMin(above, __float_as_int(range.low));
    atomicMax(above + 1, __float_as_int(range.high));
  }

 private:
  __device__ static int thread() {
    return static_cast<int>(threadIdx.x);
  }

  __device__ SeenPixel<float> seen_at(int x, int y) const {
    const float4 pixel = shared_.seen[tile_.index(x, y)];
    return {pixel.w, pixel.x, pixel.y, pixel.z};
  }
  __device__ const Window& column_at(int x, int y) const {
    return shared_.columns[y * kColumns + x + kSettledRadius];
  }
  __device__ Window window_at(int x, int y) const {
    return window_of_depths<float>([&](int du) { return column_at(x + du, y); });
  }

  // The tile of a level of the whole image that holds a pixel.
  __device__ InverseDepthRange* tile_at(int level, int u, int v) const {
    const int per_row = ((tile_.width - 1) >> level) + 1;
    return recipe_.room.tiles[level] + static_cast<std::size_t>(v >> level) * per_row +
           (u >> level);
  }
  // What lies outside of the image adds nothing.
  __device__ InverseDepthRange write_tile(int level, const InverseDepthRange* fine) const {
    const int per_row = kTileWidth >> level, x = thread() % per_row, y = thread() / per_row;
    InverseDepthRange range{CUDART_INF_F, 0};
#pragma unroll
    for (int child = 0; child < 4; ++child) {
      const int cx = 2 * x + child % 2, cy = 2 * y + child / 2;
      if (fine != nullptr) {
        range = united(range, fine[cy * 2 * per_row + cx]);
      } else if (tile_.holds(cx, cy)) {
        const float value = shared_.surface[cy * kTileWidth + cx];
        range = united(range, {value, value});
      }
    }
    const int u = (tile_.u0 >> level) + x, v = (tile_.v0 >> level) + y;
    if (level < recipe_.room.levels && u <= (tile_.width - 1) >> level &&
        v <= (tile_.height - 1) >> level)
      *tile_at(level, u << level, v << level) = range;
    return range;
  }

  const CloudRecipe& recipe_;
  Frame tile_;
  SharedTile& shared_;
};

__global__ void __launch_bounds__(kTileThreads)
    settle_cloud(const __grid_constant__ CloudRecipe recipe) {
  __shared__ SharedTile shared;
  const SettleWork work(recipe, shared);
  wait_for_last();
  if (work.is_done()) return;
  work.load();
  __syncthreads();
  if (recipe.points == PointReading::settled) {
    work.sum_columns();
    __syncthreads();
    work.settle();
  } else {
    work.take_as_measured();
  }
  __syncthreads();
  work.write_normals();
  work.write_tiles();
}

}  // namespace

void settle_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream) {
  launch_over_tiles(recipe, settle_cloud, 0, overlaps, stream, recipe);
}

}  // namespace vpm::cuda
