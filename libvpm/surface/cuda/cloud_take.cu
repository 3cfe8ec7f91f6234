#include "libvpm/surface/cuda/cloud_take.h"

namespace vpm::cuda {
namespace {

constexpr unsigned kThreads = 256;
using Work = TakeWork<kMostPixelsAtOnce, false>;

__global__ void __launch_bounds__(kThreads)
    take(const __grid_constant__ DepthSource source, const __grid_constant__ TakenDepths taken,
         const __grid_constant__ StepPixels pixels, const __grid_constant__ Camera camera,
         const __grid_constant__ CloudRoom room, bool clears_tiles, CloudCounters* counters) {
  const unsigned thread = blockIdx.x * kThreads + threadIdx.x;
  const Work work(source, taken, pixels, camera.width);
  if (thread < work.groups()) work.take(thread);
  if (clears_tiles) clear_coarse_tiles(room, camera, thread, gridDim.x * kThreads);
  if (is_empty(pixels.made) && thread == 0) counters->points = counters->doubtful = 0;
}

}  // namespace

void take_image(const DepthSource& source, const TakenDepths& taken, const CloudRecipe& recipe,
                const StepPixels& pixels, bool clears_tiles, CloudCounters* counters,
                cudaStream_t stream) {
  const Work work(source, taken, pixels, recipe.camera.width);
  take<<<(work.groups() + kThreads - 1) / kThreads, kThreads, 0, stream>>>(
      source, taken, pixels, recipe.camera, recipe.room, clears_tiles, counters);
  check(cudaGetLastError());
}

}  // namespace vpm::cuda
