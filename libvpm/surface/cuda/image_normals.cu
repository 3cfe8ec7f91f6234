#include "libvpm/surface/cuda/gated_window.h"
#include "libvpm/surface/cuda/image_around.h"
#include "libvpm/surface/cuda/image_normals.h"
#include "libvpm/surface/cuda/smooth_tile.h"

namespace vpm::cuda {
namespace {

constexpr int kSmoothBlocks = 5;  // of a multiprocessor: all that a usual image has, at once

template <class Smooth>
__global__ void __launch_bounds__(Smooth::kThreads, blocks_at_once(kSmoothBlocks, Smooth::kThreads))
    find_smooth(const __grid_constant__ CloudRecipe recipe, const GatedList gated, Vec3f* normals) {
  extern __shared__ double2 shared_memory[];
  const SmoothTile<Smooth> tile(recipe, shared_memory);
  let_next_begin();
  tile.find_rays();
  wait_for_last();
  tile.load();
  __syncthreads();
  tile.sum_columns();
  __syncthreads();
  tile.find_smooth(gated, normals);
}

// The normal of a window from its planes, the second of which is fitted to what lies near the
// first.
template <NormalMethod kMethod, class Window>
__device__ Vec3f gated_normal(const CloudRecipe& recipe, const Window& window, std::uint32_t pixel,
                              const WindowPlane& first, const WindowPlane& plane) {
  const Intrinsics& k = recipe.camera.intrinsics;
  const auto u = static_cast<int>(pixel % recipe.camera.width),
             v = static_cast<int>(pixel / recipe.camera.width);
  if constexpr (kMethod == NormalMethod::inverse_depth) {
    return normal_of_window(plane, static_cast<float>(k.fx), static_cast<float>(k.fy),
                            static_cast<float>(k.cx - u), static_cast<float>(k.cy - v));
  } else {
    if (!plane.found) return {};
    const Moments m = window.moments(first, ImageAround(recipe, recipe.depth, pixel));
    return normal_of_moments(m, quotient(1, m.n), recipe.per_fx, recipe.per_fy,
                             quotient(u - k.cx, k.fx), quotient(v - k.cy, k.fy));
  }
}

constexpr unsigned kGatedThreads = 128, kGatedBlocks = 5;  // blocks of a multiprocessor

// All blocks have read how many there are when the last one comes here: it makes that 0.
__device__ __forceinline__ unsigned take_count(const GatedList& gated) {
  const unsigned count = *static_cast<const volatile unsigned*>(gated.count);
  __syncthreads();
  if (threadIdx.x == 0 && atomicAdd(gated.done, 1U) == gridDim.x - 1)
    *gated.count = *gated.done = 0;
  return count;
}

// Two lanes take a window. Where there are more windows than pairs, they take two, one after the
// other, and each finds the planes and the normal of one.
template <NormalMethod kMethod, int Radius>
__global__ void __launch_bounds__(kGatedThreads, blocks_at_once(kGatedBlocks, kGatedThreads))
    fit_gated(const __grid_constant__ CloudRecipe recipe, const GatedList gated, Vec3f* normals) {
  constexpr unsigned kPairs = 32 / 2;  // of a warp
  const unsigned warp = threadIdx.x / 32 * gridDim.x + blockIdx.x;
  const unsigned pairs = gridDim.x * kGatedThreads / 2, lane = threadIdx.x % 2;
  let_next_begin();
  wait_for_last();
  const unsigned count = take_count(gated), at_once = count > pairs ? 2 : 1;
  for (unsigned begin = warp * kPairs * at_once; begin < count; begin += pairs * at_once) {
    const unsigned of_pair = begin + threadIdx.x % 32 / 2 * at_once;
    const auto pixel = [&](unsigned i) {
      return gated.pixels[of_pair + i < count ? of_pair + i : count - 1];
    };
    const auto window = [&](unsigned i) {
      return GatedWindow<ImageAround, Radius>(ImageAround(recipe, recipe.inverse, pixel(i)),
                                              recipe.window / 2, recipe.edges);
    };
    WindowPlane first, plane;
#pragma unroll 1
    for (int choice = 0; choice < 2; ++choice) {
      PlaneSums sums;
      first = plane;
#pragma unroll 1
      for (unsigned i = 0; i < at_once; ++i) {
        const auto of_lane = [&](float value) {
          return __shfl_sync(~0U, value, static_cast<int>(i), 2);
        };
        const WindowPlane near{true, of_lane(first.a), of_lane(first.b), of_lane(first.c)};
        const PlaneSums of_window = window(i).choose_by_two(near, choice == 0);
        if (lane == i) sums = of_window;
      }
      plane = plane_of_sums(sums);
      plane.found = plane.found && (choice == 0 || first.found);
    }
    if (lane < at_once && of_pair + lane < count)
      normals[pixel(lane)] = gated_normal<kMethod>(recipe, window(lane), pixel(lane), first, plane);
  }
}

struct Kernels {
  void (*smooth)(CloudRecipe, GatedList, Vec3f*);
  void (*gated)(CloudRecipe, GatedList, Vec3f*);
  unsigned threads;
  std::size_t bytes;
};

template <class Smooth, NormalMethod kMethod>
Kernels kernels_of(int radius) {
  return {find_smooth<Smooth>, fit_gated<kMethod, Smooth::kRadius>, Smooth::kThreads,
          SmoothTile<Smooth>::bytes(radius)};
}

Kernels choose(NormalMethod method, int radius) {
  constexpr NormalMethod kInverseDepth = NormalMethod::inverse_depth, kPca = NormalMethod::pca;
  if (method == kPca)
    return radius == kUsualRadius ? kernels_of<SmoothPca<2, kUsualRadius>, kPca>(radius)
                                  : kernels_of<SmoothPca<1, 0>, kPca>(radius);
  return radius == kUsualRadius
             ? kernels_of<SmoothInverseDepth<2, kUsualRadius>, kInverseDepth>(radius)
             : kernels_of<SmoothInverseDepth<1, 0>, kInverseDepth>(radius);
}

}  // namespace

NormalsPlan plan_normals(const NormalOptions& options) {
  const Kernels kernels = choose(options.method, options.window / 2);
  if (!has_shared_memory(kernels.smooth, kernels.bytes)) return {};
  int multiprocessors = 0;
  check(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, current_device()));
  return {true, waits_for_last(kernels.smooth),
          kGatedBlocks * static_cast<unsigned>(multiprocessors)};
}

void estimate_on_device(const CloudRecipe& recipe, NormalMethod method, const NormalsPlan& plan,
                        const GatedList& gated, Vec3f* normals, cudaStream_t stream) {
  const Kernels kernels = choose(method, recipe.window / 2);
  const auto tiles = [](std::uint32_t pixels, unsigned of_tile) {
    return (pixels + of_tile - 1) / of_tile;
  };
  const dim3 grid(tiles(recipe.camera.width, SmoothShape::kWidth),
                  tiles(recipe.camera.height, SmoothShape::kHeight));
  launch_kernel(kernels.smooth, grid, kernels.threads, kernels.bytes, plan.overlaps, stream, recipe,
                gated, normals);
  launch_kernel(kernels.gated, plan.gated_blocks, kGatedThreads, 0, plan.overlaps, stream, recipe,
                gated, normals);
}

}  // namespace vpm::cuda
