#include <math_constants.h>

#include "libvpm/surface/cuda/cloud_take.h"

namespace vpm::cuda {
namespace {

// The coarse tiles begin with what adds nothing.
__device__ void clear_tiles(const CloudRoom& room, const Camera& camera, std::size_t first,
                            std::size_t step) {
  for (int level = kTileLevels + 1; level < room.levels; ++level) {
    const std::size_t count =
        std::size_t{((camera.width - 1) >> level) + 1} * (((camera.height - 1) >> level) + 1);
    for (std::size_t k = first; k < count; k += step) room.tiles[level][k] = {CUDART_INF_F, 0};
  }
}

// Which pixels are brought: those of `wanted`, row by row, that `taken` does not hold.
struct ImagePart {
  PixelRectangle wanted, taken;

  // Groups of pixels that have some in a row; they go on from row to row, so some of them have
  // pixels in two.
  __host__ __device__ unsigned groups_per_row() const {
    return static_cast<unsigned>(wanted.u1 - wanted.u0) / kPixelsAtOnce + 2;
  }
  __host__ __device__ unsigned rows() const {
    return static_cast<unsigned>(wanted.v1 - wanted.v0 + 1);
  }
  __device__ bool has_taken(std::int64_t u, std::int64_t v) const {
    return v >= taken.v0 && v <= taken.v1 && u >= taken.u0 && u + kPixelsAtOnce - 1 <= taken.u1;
  }
};

__device__ void put(float* values, const float (&group)[kPixelsAtOnce]) {
  auto* const four = reinterpret_cast<float4*>(values);
  four[0] = {group[0], group[1], group[2], group[3]};
  four[1] = {group[4], group[5], group[6], group[7]};
}

__device__ void take_group(const DepthSource& source, std::size_t first, float* depth,
                           float* inverse) {
  float z[kPixelsAtOnce], s[kPixelsAtOnce];
  if (source.counts != nullptr) {
    const uint4 words = *reinterpret_cast<const uint4*>(source.counts + first);
    const unsigned pairs[] = {words.x, words.y, words.z, words.w};
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce; ++k) {
      const unsigned count = (k % 2 == 0 ? pairs[k / 2] : pairs[k / 2] >> 16) & 0xffffU;
      z[k] = usable_depth(depth_in_metres(count, source.counts_per_metre));
    }
  } else {
    const auto* const four = reinterpret_cast<const float4*>(source.metres + first);
    const float4 a = four[0], b = four[1];
    const float metres[] = {a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w};
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce; ++k) z[k] = usable_depth(metres[k]);
  }
#pragma unroll
  for (unsigned k = 0; k < kPixelsAtOnce; ++k) s[k] = inverse_of_usable(z[k]);
  put(depth + first, z);
  put(inverse + first, s);
}

__global__ void __launch_bounds__(kTileThreads)
    take(const __grid_constant__ DepthSource source, float* depth, float* inverse,
         const __grid_constant__ ImagePart part, const __grid_constant__ Camera camera,
         const __grid_constant__ CloudRoom room, CloudCounters* counters, bool is_first) {
  const unsigned thread = blockIdx.x * kTileThreads + threadIdx.x;
  const unsigned row = thread / part.groups_per_row(), in_row = thread % part.groups_per_row();
  if (row < part.rows()) {
    const std::int64_t v = part.wanted.v0 + row, begin = v * camera.width;
    const std::int64_t first = ((begin + part.wanted.u0) / kPixelsAtOnce + in_row) * kPixelsAtOnce;
    if (first <= begin + part.wanted.u1 && !part.has_taken(first - begin, v))
      take_group(source, static_cast<std::size_t>(first), depth, inverse);
  }
  if (!is_first) return;
  clear_tiles(room, camera, thread, std::size_t{gridDim.x} * kTileThreads);
  if (thread == 0) counters->points = counters->doubtful = 0;
}

}  // namespace

void take_image(const DepthSource& source, float* depth, float* inverse, const CloudRecipe& recipe,
                const PixelRectangle& wanted, const PixelRectangle& made, CloudCounters* counters,
                cudaStream_t stream) {
  const auto with_margin = [&](const PixelRectangle& pixels) {
    return widened(pixels, TileFrame<0>::margin_of(recipe.window / 2), 1, 1,
                   static_cast<std::int32_t>(recipe.camera.width),
                   static_cast<std::int32_t>(recipe.camera.height));
  };
  const ImagePart part{with_margin(wanted), with_margin(made)};
  const unsigned threads = part.rows() * part.groups_per_row();
  take<<<(threads + kTileThreads - 1) / kTileThreads, kTileThreads, 0, stream>>>(
      source, depth, inverse, part, recipe.camera, recipe.room, counters, is_empty(made));
  check(cudaGetLastError());
}

}  // namespace vpm::cuda
