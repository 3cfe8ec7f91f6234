#include "libvpm/scene/cuda/cloud_settle.h"
#include "libvpm/scene/cuda/cloud_surface.h"

namespace vpm::cuda {
namespace {

constexpr int kThreads = CloudTile::kSurfaceThreads, kBlocks = 2;

__global__ void __launch_bounds__(kThreads, kBlocks)
    settle_cloud(const __grid_constant__ CloudRecipe recipe) {
  alignas(SettleShared) __shared__ unsigned char memory[sizeof(SettleShared)];
  const SettleWork work(recipe, static_cast<int>(blockIdx.x),
                        *reinterpret_cast<SettleShared*>(memory));
  wait_for_last();
  settle_tile(work, recipe.points);
}

}  // namespace

void settle_on_device(const CloudRecipe& recipe, bool overlaps, cudaStream_t stream) {
  launch_over_tiles(recipe.camera, settle_cloud, kThreads, 0, overlaps, stream, recipe);
}

}  // namespace vpm::cuda
