#include <math_constants.h>

#include "libvpm/scene/cuda/cloud_take.h"

namespace vpm::cuda {
namespace {

constexpr unsigned kThreads = 256;

// Returns four depths, m, from pixel `first` on.
__device__ float4 four_depths(const DepthSource& source, std::size_t first) {
  if (source.counts == nullptr) return *reinterpret_cast<const float4*>(source.metres + first);
  const uint2 words = *reinterpret_cast<const uint2*>(source.counts + first);
  const auto metres = [&](unsigned count) {
    return depth_in_metres(count & 0xffffU, source.counts_per_metre);
  };
  return {metres(words.x), metres(words.x >> 16), metres(words.y), metres(words.y >> 16)};
}

__device__ void put(float4 d, const CloudRecipe& recipe, std::size_t first) {
  d = {usable_depth(d.x), usable_depth(d.y), usable_depth(d.z), usable_depth(d.w)};
  *reinterpret_cast<float4*>(recipe.depth + first) = d;
  *reinterpret_cast<float4*>(recipe.inverse + first) = {
      inverse_of_usable(d.x), inverse_of_usable(d.y), inverse_of_usable(d.z),
      inverse_of_usable(d.w)};
}

// Sets the coarse tiles, which several blocks' pixels share, to the neutral range.
__device__ void clear_coarse_tiles(const CloudRoom& room, const Camera& camera, unsigned thread,
                                   unsigned threads) {
  for (int level = CloudTile::kLevels + 1; level < room.levels; ++level) {
    const std::size_t count =
        std::size_t{((camera.width - 1) >> level) + 1} * (((camera.height - 1) >> level) + 1);
    for (std::size_t k = thread; k < count; k += threads) room.tiles[level][k] = {CUDART_INF_F, 0};
  }
}

__global__ void __launch_bounds__(kThreads)
    take(const __grid_constant__ DepthSource source, const __grid_constant__ CloudRecipe recipe,
         unsigned groups, CloudCounters* counters) {
  const unsigned thread = blockIdx.x * kThreads + threadIdx.x;
  if (thread < groups) {
    const std::size_t first = std::size_t{thread} * kPixelsAtOnce;
    float4 depth[kPixelsAtOnce / 4];  // loads in flight before any is stored
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce / 4; ++k) depth[k] = four_depths(source, first + 4 * k);
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce / 4; ++k) put(depth[k], recipe, first + 4 * k);
  }
  clear_coarse_tiles(recipe.room, recipe.camera, thread, gridDim.x * kThreads);
  if (thread == 0) counters->points = counters->doubtful = 0;
}

}  // namespace

void take_image(const DepthSource& source, const CloudRecipe& recipe, CloudCounters* counters,
                cudaStream_t stream) {
  const unsigned pixels = recipe.camera.width * recipe.camera.height;
  const unsigned groups = (pixels - 1) / kPixelsAtOnce + 1;
  launch_kernel(take, {(groups - 1) / kThreads + 1, kThreads}, LaunchKind::independent, stream,
                source, recipe, groups, counters);
}

}  // namespace vpm::cuda
