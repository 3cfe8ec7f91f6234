#include <math_constants.h>

#include "libvpm/scene/cuda/cloud_points.h"
#include "libvpm/scene/cuda/cloud_prepare.h"
#include "libvpm/scene/cuda/cloud_surface.h"

namespace vpm::cuda {
namespace {

constexpr unsigned kTakeThreads = 256;

// Returns four depths, m, from pixel `first` on.
__device__ float4 four_depths(const DepthSource& source, std::size_t first) {
  if (source.counts == nullptr) return *reinterpret_cast<const float4*>(source.metres + first);
  const uint2 words = *reinterpret_cast<const uint2*>(source.counts + first);
  const auto metres = [&](unsigned count) {
    return depth_in_metres(count & 0xffffU, source.counts_per_metre);
  };
  return {metres(words.x), metres(words.x >> 16), metres(words.y), metres(words.y >> 16)};
}

__device__ void store(float4 d, const CloudRecipe& recipe, std::size_t first) {
  *reinterpret_cast<float4*>(recipe.inverse + first) = {
      inverse_or_removed(d.x), inverse_or_removed(d.y), inverse_or_removed(d.z),
      inverse_or_removed(d.w)};
  *reinterpret_cast<float4*>(recipe.depth + first) = {usable_depth(d.x), usable_depth(d.y),
                                                      usable_depth(d.z), usable_depth(d.w)};
}

// Sets the coarse tiles, which several blocks' pixels share, to the neutral range.
__device__ void clear_coarse_tiles(const ImageRoom& room, const Camera& camera, unsigned thread,
                                   unsigned threads) {
  for (int level = CloudTile::kLevels + 1; level < room.levels; ++level) {
    const std::size_t count =
        std::size_t{((camera.width - 1) >> level) + 1} * (((camera.height - 1) >> level) + 1);
    for (std::size_t k = thread; k < count; k += threads) room.tiles[level][k] = {CUDART_INF_F, 0};
  }
}

__global__ void __launch_bounds__(kTakeThreads)
    take(const __grid_constant__ DepthSource source, const __grid_constant__ CloudRecipe recipe,
         unsigned groups, CloudCounters* counters) {
  const unsigned thread = blockIdx.x * kTakeThreads + threadIdx.x;
  if (thread < groups) {
    const std::size_t first = std::size_t{thread} * kPixelsAtOnce;
    float4 depth[kPixelsAtOnce / 4];  // loads in flight before any is stored
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce / 4; ++k) depth[k] = four_depths(source, first + 4 * k);
#pragma unroll
    for (unsigned k = 0; k < kPixelsAtOnce / 4; ++k) store(depth[k], recipe, first + 4 * k);
  }
  clear_coarse_tiles(recipe.room, recipe.camera, thread, gridDim.x * kTakeThreads);
  if (thread == 0) counters->points = counters->doubtful = 0;
}

template <class Normals>
__global__ void __launch_bounds__(CloudTile::kPointThreads,
                                  blocks_at_once(Normals::kMostBlocks, CloudTile::kPointThreads))
    prepare_cloud(const __grid_constant__ CloudRecipe recipe, CloudCounters* counters,
                  CloudAnswer* answer, unsigned sequence) {
  __shared__ unsigned gated, points, doubtful;
  const TileWork<Normals> work(recipe, static_cast<int>(blockIdx.x), dynamic_shared_memory());
  if (threadIdx.x == 0) gated = points = doubtful = 0;
  work.find_rays();
  wait_for_last();
  work.find_normals(gated);
  work.write_seen(points, doubtful);
  __syncthreads();
  if (threadIdx.x != 0) return;
  if (points > 0) atomicAdd(&counters->points, points);
  if (doubtful > 0) atomicAdd(&counters->doubtful, doubtful);
  __threadfence();
  if (atomicAdd(&counters->done, 1U) != gridDim.x - 1) return;
  __threadfence();
  const volatile CloudCounters& all = *counters;
  put(numbered(sequence, all.doubtful), answer->doubtful);
  put(numbered(sequence, all.points), answer->points);
  counters->done = 0;
}

using Kernel = void (*)(CloudRecipe, CloudCounters*, CloudAnswer*, unsigned);

struct Choice {
  Kernel kernel;
  std::size_t bytes;
};

template <class Normals>
Choice choice_of(int radius) {
  return {prepare_cloud<Normals>, TileArrays<Normals>::bytes(radius)};
}
template <template <class> class Normals>
Choice choose(int radius) {
  return radius == kUsualRadius ? choice_of<Normals<TileFrame<kUsualRadius>>>(radius)
                                : choice_of<Normals<TileFrame<0>>>(radius);
}

Choice choose(NormalMethod method, int radius) {
  return method == NormalMethod::pca ? choose<PcaNormals>(radius)
                                     : choose<InverseDepthNormals>(radius);
}

__global__ void __launch_bounds__(CloudTile::kSurfaceThreads, 2)
    denoise_cloud(const __grid_constant__ CloudRecipe recipe) {
  alignas(DenoiseShared) __shared__ unsigned char memory[sizeof(DenoiseShared)];
  const DenoiseWork work(recipe, static_cast<int>(blockIdx.x),
                         *reinterpret_cast<DenoiseShared*>(memory));
  wait_for_last();
  denoise_tile(work, recipe.points);
}

}  // namespace

void take_image(const DepthSource& source, const CloudRecipe& recipe, CloudCounters* counters,
                cudaStream_t stream) {
  const unsigned pixels = recipe.camera.width * recipe.camera.height;
  const unsigned groups = (pixels - 1) / kPixelsAtOnce + 1;
  launch_kernel(take, {(groups - 1) / kTakeThreads + 1, kTakeThreads}, LaunchKind::independent,
                stream, source, recipe, groups, counters);
}

Preparation preparation_of(const NormalOptions& options) {
  const Choice choice = choose(options.method, options.window / 2);
  if (!has_shared_memory(choice.kernel, choice.bytes)) return {};
  return {true, waits_for_last(choice.kernel)};
}

void prepare_on_device(const CloudRecipe& recipe, NormalMethod method,
                       const Preparation& preparation, CloudCounters* counters, CloudAnswer* answer,
                       unsigned sequence, cudaStream_t stream) {
  const Choice choice = choose(method, recipe.window / 2);
  launch_over_tiles(recipe.camera, choice.kernel, CloudTile::kPointThreads, choice.bytes,
                    preparation.overlaps, stream, recipe, counters, answer, sequence);
}

void denoise_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream) {
  launch_over_tiles(recipe.camera, denoise_cloud, CloudTile::kSurfaceThreads, 0, overlaps, stream,
                    recipe);
}

}  // namespace vpm::cuda
