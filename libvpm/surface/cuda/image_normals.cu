#include "libvpm/surface/cuda/image_normals.h"
#include "libvpm/surface/cuda/rough_tile.h"

namespace vpm::cuda {
namespace {

template <class Smooth, NormalMethod kMethod>
__global__ void __launch_bounds__(Smooth::kThreads,
                                  blocks_at_once(Smooth::kBlocks, Smooth::kThreads))
    find_normals(const __grid_constant__ CloudRecipe recipe, Vec3f* normals) {
  extern __shared__ double2 shared_memory[];
  __shared__ RoughPixels rough;
  __shared__ RoughCounts counts;
  const SmoothTile<Smooth> tile(recipe, shared_memory);
  let_next_begin();
  if (threadIdx.x == 0) rough.count = counts.with_edge = counts.without = 0;
  tile.find_rays();
  wait_for_last();
  tile.load();
  __syncthreads();
  tile.sum_columns();
  __syncthreads();
  tile.find_smooth(rough, normals);
  __syncthreads();
  if (rough.count == 0) return;
  RoughFits& fits = *tile.columns().template take<RoughFits>(1);
  RoughTile<Smooth, kMethod>(recipe, tile, counts, fits, normals).find(rough);
}

struct Choice {
  void (*kernel)(CloudRecipe, Vec3f*);
  unsigned threads;
  std::size_t bytes;
};

template <class Smooth, NormalMethod kMethod>
Choice choice_of(int radius) {
  return {find_normals<Smooth, kMethod>, Smooth::kThreads, SmoothTile<Smooth>::bytes(radius)};
}

Choice choose(NormalMethod method, int radius) {
  constexpr NormalMethod kInverseDepth = NormalMethod::inverse_depth, kPca = NormalMethod::pca;
  if (method == kPca)
    return radius == kUsualRadius ? choice_of<SmoothPca<2, kUsualRadius>, kPca>(radius)
                                  : choice_of<SmoothPca<1, 0>, kPca>(radius);
  return radius == kUsualRadius
             ? choice_of<SmoothInverseDepth<2, kUsualRadius>, kInverseDepth>(radius)
             : choice_of<SmoothInverseDepth<1, 0>, kInverseDepth>(radius);
}

}  // namespace

NormalsPlan plan_normals(const NormalOptions& options) {
  const Choice choice = choose(options.method, options.window / 2);
  if (!has_shared_memory(choice.kernel, choice.bytes)) return {};
  return {true, waits_for_last(choice.kernel)};
}

void estimate_on_device(const CloudRecipe& recipe, NormalMethod method, const NormalsPlan& plan,
                        Vec3f* normals, cudaStream_t stream) {
  const Choice choice = choose(method, recipe.window / 2);
  const auto tiles = [](std::uint32_t pixels, unsigned of_tile) {
    return (pixels + of_tile - 1) / of_tile;
  };
  const dim3 grid(tiles(recipe.camera.width, SmoothShape::kWidth),
                  tiles(recipe.camera.height, SmoothShape::kHeight));
  launch_kernel(choice.kernel, grid, choice.threads, choice.bytes, plan.overlaps, stream, recipe,
                normals);
}

}  // namespace vpm::cuda
