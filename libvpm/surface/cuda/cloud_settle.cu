#include "libvpm/surface/cuda/cloud_settle.h"
#include "libvpm/surface/cuda/cloud_surface.h"

namespace vpm::cuda {
namespace {

using Shape = LargeTile;
constexpr int kThreads = Shape::kSurfaceThreads, kBlocks = 2;

__global__ void __launch_bounds__(kThreads, kBlocks)
    settle_cloud(const __grid_constant__ CloudRecipe recipe,
                 const __grid_constant__ StepPixels pixels) {
  using Work = SettleWork<Shape>;
  __shared__ alignas(Work::Shared) unsigned char memory[sizeof(Work::Shared)];
  const Work work(recipe, pixels, static_cast<int>(blockIdx.x),
                  *reinterpret_cast<Work::Shared*>(memory));
  wait_for_last();
  if (!work.is_done()) settle_tile(work, recipe.points);
}

}  // namespace

void settle_on_device(const CloudRecipe& recipe, const StepPixels& pixels, bool overlaps,
                      cudaStream_t stream) {
  launch_over_tiles(pixels, settle_cloud, kThreads, 0, overlaps, stream, recipe, pixels);
}

}  // namespace vpm::cuda
