#include "libvpm/scene/cuda/cloud_points.h"
#include "libvpm/scene/cuda/cloud_prepare.h"

namespace vpm::cuda {
namespace {

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
  find_normals(work, gated);
  work.place_points(points, doubtful);
  __syncthreads();
  work.write_points();
  if (threadIdx.x != 0) return;
  count(points, doubtful, *counters);
  __threadfence();
  if (atomicAdd(&counters->done, 1U) != gridDim.x - 1) return;
  __threadfence();
  answer_with(*counters, answer, sequence);
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

}  // namespace

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

}  // namespace vpm::cuda
