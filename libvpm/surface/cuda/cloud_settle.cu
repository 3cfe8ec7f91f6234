#include <math_constants.h>

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/surface/cuda/cloud_settle.h"
#include "libvpm/surface/settled_pixel.h"

namespace vpm::cuda {
namespace {

constexpr int kMarginOfMarks = kSettledReach, kMargin = kMarginOfMarks + kSettledRadius;
using Frame = TileFrame<kMargin>;
using Window = WindowOfDepths<float>;

constexpr int kWidth = kTileWidth + 2 * kMargin, kHeight = kTileHeight + 2 * kMargin;
constexpr int kMarkedWidth = kTileWidth + 2 * kMarginOfMarks,
              kMarked = kMarkedWidth * (kTileHeight + 2 * kMarginOfMarks);
constexpr int kColumns = kTileWidth + 2 * kSettledRadius;
constexpr int kRanges = kTilePixels / 4 + kTilePixels / 16 + kTilePixels / 64 + 2;
// A thread for each pixel of the tile.
constexpr int kThreads = kTilePixels, kBlocks = 2, kMarkedPixels = kMarked / kThreads;
static_assert(kMarked % kThreads == 0);
static_assert(kMargin <= kTileHeight && kMargin <= kTileWidth, "the tiles around hold it");

struct SeenTile {
  float4 pixels[kWidth * kHeight];         // with the margin: normals and inverse depth
  Window columns[kColumns * kTileHeight];  // of the windows
};
struct SettledTile {
  float surface[kTilePixels];
  Vec3f normals[kTilePixels];
  InverseDepthRange ranges[kRanges];
};
// What is settled takes the place of what was seen.
union SharedTile {
  SeenTile seen;
  SettledTile settled;
};

// One tile of an image, by a block.
class SettleWork {
 public:
  __device__ SettleWork(const CloudRecipe& recipe, SharedTile& shared)
      : recipe_(recipe), tile_(recipe), shared_(shared) {}

  __device__ bool is_done() const { return tile_.is_made; }

  // A row by each warp. Zeros outside of the image.
  __device__ void load() const {
    constexpr int kWarps = kThreads / 32;
    const auto* const words = reinterpret_cast<const float*>(recipe_.seen);
    auto* const seen = reinterpret_cast<float*>(shared_.seen.pixels);
#pragma unroll
    for (int row = thread() / 32; row < kHeight; row += kWarps) {
      const int v = tile_.v0 + row - kMargin, u = tile_.u0 - kMargin;
      const bool is_row = v >= 0 && v < tile_.height;
      const std::ptrdiff_t first = std::ptrdiff_t{v} * tile_.width + u;
#pragma unroll
      for (int x = thread() % 32; x < kWidth; x += 32) {
        const bool is_inside = is_row && u + x >= 0 && u + x < tile_.width;
        seen[4 * (row * kWidth + x) + 3] = is_inside ? recipe_.room.measured[first + x] : 0.0F;
      }
#pragma unroll
      for (int w = thread() % 32; w < 3 * kWidth; w += 32) {
        const bool is_inside = is_row && 3 * u + w >= 0 && 3 * u + w < 3 * tile_.width;
        seen[4 * (row * kWidth + w / 3) + w % 3] = is_inside ? words[3 * first + w] : 0.0F;
      }
    }
  }

  __device__ void sum_columns() const {
    for (int k = thread(); k < kColumns * kTileHeight; k += kThreads) {
      const float4* const middle =
          shared_.seen.pixels + tile_.index(k % kColumns - kSettledRadius, k / kColumns);
      shared_.seen.columns[k] =
          column_of_depths<float>([&](int dv) { return middle[dv * kWidth].w; });
    }
  }

  // Meets before others see the marks.
  __device__ void mark() const {
    unsigned clear = 0;
    for_marked([&](int i, int x, int y) {
      const auto seen = [&](int du, int dv) { return seen_at(x + du, y + dv); };
      clear |= is_clear<float>(seen) ? 1U << i : 0U;
    });
    __syncthreads();
    for_marked([&](int i, int x, int y) {
      float& inverse = shared_.seen.pixels[tile_.index(x, y)].w;
      inverse = marked(inverse, (clear >> i & 1U) != 0);
    });
  }

  struct Pixel {
    float inverse;
    Vec3f normal;
  };
  __device__ Pixel settled(int x, int y) const {
    const auto seen = [&](int du, int dv) { return seen_at(x + du, y + dv); };
    const NormalSum<float> sum = settled_normal<float>(seen);
    const float scale = per_length(sum.x, sum.y, sum.z);
    return {settled_inverse_depth(seen(0, 0), window_at(x, y)),
            {sum.x * scale, sum.y * scale, sum.z * scale}};
  }
  __device__ Pixel as_measured(int x, int y) const {
    const SeenPixel<float> pixel = seen_at(x, y);
    return {pixel.inverse, {pixel.x, pixel.y, pixel.z}};
  }
  // Meets before the pixels take the place of what was seen.
  template <class Make>
  __device__ void make_pixel(const Make& make) const {
    const Pixel made = make(thread() % kTileWidth, thread() / kTileWidth);
    __syncthreads();
    shared_.settled.surface[thread()] = made.inverse;
    shared_.settled.normals[thread()] = made.normal;
  }

  __device__ void write_normals() const {
    write_rows(tile_, shared_.settled.normals, recipe_.room.pixel_normals);
  }

  // Levels 0 to kTileLevels, and this tile's part of what lies above. Meets after each.
  __device__ void write_tiles() const {
    if (const int x = thread() % kTileWidth, y = thread() / kTileWidth; tile_.holds(x, y)) {
      const float value = shared_.settled.surface[thread()];
      recipe_.room.tiles[0][tile_.pixel(x, y)] = {value, value};
    }
    InverseDepthRange* fine = nullptr;
    InverseDepthRange* coarse = shared_.settled.ranges;
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
  // Calls visit(i, x, y) for the thread's share of the pixels to be marked.
  template <class Visit>
  __device__ static void for_marked(const Visit& visit) {
#pragma unroll 1
    for (int i = 0; i < kMarkedPixels; ++i) {
      const int k = thread() + i * kThreads;
      visit(i, k % kMarkedWidth - kMarginOfMarks, k / kMarkedWidth - kMarginOfMarks);
    }
  }
  __device__ static int thread() {
    return static_cast<int>(threadIdx.x);
  }

  __device__ SeenPixel<float> seen_at(int x, int y) const {
    const float4 pixel = shared_.seen.pixels[tile_.index(x, y)];
    return {pixel.w, pixel.x, pixel.y, pixel.z};
  }
  __device__ const Window& column_at(int x, int y) const {
    return shared_.seen.columns[y * kColumns + x + kSettledRadius];
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
        const float value = shared_.settled.surface[cy * kTileWidth + cx];
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

__global__ void __launch_bounds__(kThreads, kBlocks)
    settle_cloud(const __grid_constant__ CloudRecipe recipe) {
  __shared__ alignas(SharedTile) unsigned char memory[sizeof(SharedTile)];
  SharedTile& shared = *reinterpret_cast<SharedTile*>(memory);
  const SettleWork work(recipe, shared);
  wait_for_last();
  if (work.is_done()) return;
  work.load();
  __syncthreads();
  if (recipe.points == PointReading::settled) {
    work.sum_columns();
    work.mark();
    __syncthreads();
    work.make_pixel([&](int x, int y) { return work.settled(x, y); });
  } else {
    work.make_pixel([&](int x, int y) { return work.as_measured(x, y); });
  }
  __syncthreads();
  work.write_normals();
  work.write_tiles();
}

}  // namespace

void settle_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream) {
  launch_over_tiles(recipe, settle_cloud, kThreads, 0, overlaps, stream, recipe);
}

}  // namespace vpm::cuda
