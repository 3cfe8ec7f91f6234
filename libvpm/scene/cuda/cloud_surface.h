// Denoises a tile of an image by a block, for cloud_denoise.cu.
#pragma once

#include <math_constants.h>

#include "libvpm/scene/cuda/cloud_tile.h"
#include "libvpm/scene/depth/denoised_pixel.h"

namespace vpm::cuda {

// Margins, in pixels, within which neighbours decide a pixel: those whose normals are averaged, and
// their windows.
inline constexpr int kMarginOfMarks = kDenoisedReach,
                     kDenoiseMargin = kMarginOfMarks + kDenoisedRadius;

// Sets the sizes of a block's arrays.
struct DenoiseSizes {
  using Frame = TileFrame<kDenoiseMargin>;
  static constexpr int kThreads = CloudTile::kSurfaceThreads;
  static constexpr int kWidth = CloudTile::kWidth + 2 * kDenoiseMargin,
                       kHeight = CloudTile::kHeight + 2 * kDenoiseMargin;
  static constexpr int kMarkedWidth = CloudTile::kWidth + 2 * kMarginOfMarks,
                       kMarked = kMarkedWidth * (CloudTile::kHeight + 2 * kMarginOfMarks);
  static constexpr int kColumns = CloudTile::kWidth + 2 * kDenoisedRadius;
  static constexpr int kRanges =
      CloudTile::kPixels / 4 + CloudTile::kPixels / 16 + CloudTile::kPixels / 64 + 2;
  static constexpr int kPixelsOfThread = CloudTile::kPixels / kThreads,
                       kMarkedOfThread = kMarked / kThreads;
  static_assert(CloudTile::kPixels % kThreads == 0 && kMarked % kThreads == 0);
};

struct SeenTile {
  float4 pixels[DenoiseSizes::kWidth *
                DenoiseSizes::kHeight];  // normals and inverse depth, with the margin
  WindowOfDepths<float> columns[DenoiseSizes::kColumns * CloudTile::kHeight];
};
struct DenoisedTile {
  float surface[CloudTile::kPixels];
  InverseDepthRange ranges[DenoiseSizes::kRanges];
};
// Lays out a block's shared memory: denoised pixels replace the measured ones.
union DenoiseShared {
  SeenTile seen;
  DenoisedTile denoised;
};

// Works on one tile of an image with one block.
class DenoiseWork {
  using Window = WindowOfDepths<float>;
  static constexpr int kThreads = DenoiseSizes::kThreads, kWidth = DenoiseSizes::kWidth,
                       kHeight = DenoiseSizes::kHeight, kColumns = DenoiseSizes::kColumns;

 public:
  __device__ DenoiseWork(const CloudRecipe& recipe, int number, DenoiseShared& shared)
      : recipe_(recipe), tile_(recipe, number), shared_(shared) {}

  // Loads the tile, with zeros outside the image. (Few loops in this file are unrolled: a block
  // runs its code once or twice, so code size decides.)
  __device__ void load() const {
    const float4* const image = recipe_.seen;
    constexpr int kPixels = kWidth * kHeight;
    constexpr int kAtOnce = 12;  // loads in flight before any is stored
#pragma unroll 1
    for (int begin = thread(); begin < kPixels; begin += kAtOnce * kThreads) {
      float4 seen[kAtOnce];
#pragma unroll
      for (int i = 0; i < kAtOnce; ++i) {
        const int k = begin + i * kThreads;
        const int x = k % kWidth - kDenoiseMargin, y = k / kWidth - kDenoiseMargin;
        const bool is_there = k < kPixels && tile_.is_in_image(x, y);
        seen[i] = is_there ? image[tile_.pixel(x, y)] : float4{0, 0, 0, 0};
      }
#pragma unroll
      for (int i = 0; i < kAtOnce; ++i) {
        const int k = begin + i * kThreads;
        if (k < kPixels) shared_.seen.pixels[k] = seen[i];
      }
    }
  }

  __device__ void sum_columns() const {
#pragma unroll 1
    for (int k = thread(); k < kColumns * CloudTile::kHeight; k += kThreads) {
      const float4* const middle =
          shared_.seen.pixels + tile_.index(k % kColumns - kDenoisedRadius, k / kColumns);
      shared_.seen.columns[k] =
          column_of_depths<float>([&](int dv) { return middle[dv * kWidth].w; });
    }
  }

  // Marks the pixels; synchronises before marks become visible.
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
  __device__ Pixel denoised(int x, int y) const {
    const auto seen = [&](int du, int dv) { return seen_at(x + du, y + dv); };
    const NormalSum<float> sum = denoised_normal<float>(seen);
    const float scale = per_length(sum.x, sum.y, sum.z);
    return {denoised_inverse_depth(seen(0, 0), window_at(x, y)),
            {sum.x * scale, sum.y * scale, sum.z * scale}};
  }
  __device__ Pixel as_measured(int x, int y) const {
    const SeenPixel<float> pixel = seen_at(x, y);
    return {pixel.inverse, {pixel.x, pixel.y, pixel.z}};
  }
  // Makes the pixels by make(x, y); synchronises before they replace the measured ones.
  template <class Make>
  __device__ void make_pixels(const Make& make) const {
    constexpr int kPixels = DenoiseSizes::kPixelsOfThread;
    Vec3f* const normals = recipe_.room.normals;
    InverseDepthRange* const pixels = recipe_.room.tiles[0];
    float surface[kPixels];
#pragma unroll
    for (int i = 0; i < kPixels; ++i) {
      const int k = thread() + i * kThreads, x = k % CloudTile::kWidth, y = k / CloudTile::kWidth;
      const Pixel made = make(x, y);
      surface[i] = made.inverse;
      if (!tile_.holds(x, y)) continue;
      normals[tile_.pixel(x, y)] = made.normal;
      pixels[tile_.pixel(x, y)] = {made.inverse, made.inverse};
    }
    __syncthreads();
#pragma unroll
    for (int i = 0; i < kPixels; ++i)
      shared_.denoised.surface[thread() + i * kThreads] = surface[i];
  }

  // Writes levels 1 to CloudTile::kLevels and adds this tile to higher levels. Synchronises per
  // level.
  __device__ void write_tiles() const {
    InverseDepthRange* fine = nullptr;
    InverseDepthRange* coarse = shared_.denoised.ranges;
#pragma unroll 1
    for (int level = 1; level <= CloudTile::kLevels; ++level) {
      const int count = (CloudTile::kWidth >> level) * (CloudTile::kHeight >> level);
      if (thread() < count) coarse[thread()] = write_tile(level, fine);
      fine = coarse;
      coarse += count;
      __syncthreads();
    }
    // Inverse depths are not negative, so integer order is their order.
    const int level = CloudTile::kLevels + 1 + thread();
    if (level >= recipe_.room.levels) return;
    InverseDepthRange range = fine[0];
    for (int k = 1; k < CloudTile::kWidth / CloudTile::kHeight; ++k) range = united(range, fine[k]);
    auto* const above = reinterpret_cast<int*>(tile_at(level, tile_.u0, tile_.v0));
    atomicMin(above, __float_as_int(range.low));
    atomicMax(above + 1, __float_as_int(range.high));
  }

 private:
  // Calls visit(i, x, y) for this thread's pixels among those to be marked.
  template <class Visit>
  __device__ static void for_marked(const Visit& visit) {
#pragma unroll 2
    for (int i = 0; i < DenoiseSizes::kMarkedOfThread; ++i) {
      const int k = thread() + i * kThreads;
      visit(i, k % DenoiseSizes::kMarkedWidth - kMarginOfMarks,
            k / DenoiseSizes::kMarkedWidth - kMarginOfMarks);
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
    return shared_.seen.columns[y * kColumns + x + kDenoisedRadius];
  }
  __device__ Window window_at(int x, int y) const {
    return window_of_depths<float>([&](int du) { return column_at(x + du, y); });
  }

  // Returns the pyramid's tile at a level that holds a pixel of the image.
  __device__ InverseDepthRange* tile_at(int level, int u, int v) const {
    const int per_row = ((tile_.width - 1) >> level) + 1;
    return recipe_.room.tiles[level] + static_cast<std::size_t>(v >> level) * per_row +
           (u >> level);
  }
  // Writes and returns one tile of a level. Pixels outside the image add nothing.
  __device__ InverseDepthRange write_tile(int level, const InverseDepthRange* fine) const {
    const int per_row = CloudTile::kWidth >> level, x = thread() % per_row, y = thread() / per_row;
    InverseDepthRange range{CUDART_INF_F, 0};
#pragma unroll
    for (int child = 0; child < 4; ++child) {
      const int cx = 2 * x + child % 2, cy = 2 * y + child / 2;
      if (fine != nullptr) {
        range = united(range, fine[cy * 2 * per_row + cx]);
      } else if (tile_.holds(cx, cy)) {
        const float value = shared_.denoised.surface[cy * CloudTile::kWidth + cx];
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
  DenoiseSizes::Frame tile_;
  DenoiseShared& shared_;
};

// Denoises the tile; call it from all threads of a block.
__device__ inline void denoise_tile(const DenoiseWork& work, Denoising points) {
  work.load();
  __syncthreads();
  if (points == Denoising::on) {
    work.sum_columns();
    work.mark();
    __syncthreads();
    work.make_pixels([&](int x, int y) { return work.denoised(x, y); });
  } else {
    work.make_pixels([&](int x, int y) { return work.as_measured(x, y); });
  }
  __syncthreads();
  work.write_tiles();
}

}  // namespace vpm::cuda
