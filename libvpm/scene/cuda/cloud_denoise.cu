#include "libvpm/scene/cuda/cloud_denoise.h"
#include "libvpm/scene/cuda/cloud_surface.h"

namespace vpm::cuda {
namespace {

constexpr int kThreads = CloudTile::kSurfaceThreads, kBlocks = 2;

__global__ void __launch_bounds__(kThreads, kBlocks)
    denoise_cloud(const __grid_constant__ CloudRecipe recipe) {
  alignas(DenoiseShared) __shared__ unsigned char memory[sizeof(DenoiseShared)];
  const DenoiseWork work(recipe, static_cast<int>(blockIdx.x),
                         *reinterpret_cast<DenoiseShared*>(memory));
  wait_for_last();
  denoise_tile(work, recipe.points);
}

}  // namespace

void denoise_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream) {
  launch_over_tiles(recipe.camera, denoise_cloud, kThreads, 0, overlaps, stream, recipe);
}

}  // namespace vpm::cuda
