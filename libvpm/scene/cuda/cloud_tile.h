// Describes an image that becomes a cloud, and the tile of it that a block works on.
#pragma once

#include <vpm/camera.h>

#include "libvpm/cloud/covariance_fit.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/device/cuda/runtime.h"
#include "libvpm/scene/cuda/device_bodies.h"
#include "libvpm/scene/depth/denoised_image.h"

namespace vpm::cuda {

// Sets the size of a block's tile in pixels, the number of pyramid levels whose tiles lie whole in
// it, and the threads that make its points, then its surface.
struct CloudTile {
  static constexpr int kWidth = 32, kHeight = 16, kPixels = kWidth * kHeight, kLevels = 4;
  static constexpr int kPointThreads = 256, kSurfaceThreads = kPixels;
  static_assert(kHeight == 1 << kLevels && kWidth % kHeight == 0);
  static_assert(kPixels % kPointThreads == 0, "whole warps count what they find");

  __host__ __device__ static int tiles_per_row(const Camera& camera) {
    return (static_cast<int>(camera.width) - 1) / kWidth + 1;
  }
  __host__ __device__ static int tile_count(const Camera& camera) {
    return tiles_per_row(camera) * ((static_cast<int>(camera.height) - 1) / kHeight + 1);
  }
};

// Returns the number of blocks on a multiprocessor: `wanted`, if it has threads for them.
VPM_HD constexpr int blocks_at_once(int wanted, int threads) {
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ == 800 || __CUDA_ARCH__ == 900 || __CUDA_ARCH__ == 1000
  const int most = 2048 / threads;
#elif __CUDA_ARCH__ >= 860
  const int most = 1536 / threads;
#else
  const int most = 1024 / threads;
#endif
  return wanted < most ? wanted : most;
}

// Radius of the default window, which kernels know at compile time.
inline constexpr int kUsualRadius = NormalOptions{}.window / 2;

// Holds inputs, parameters and outputs of the preparation of one image.
struct CloudRecipe {
  float* depth = nullptr;    // m, by pixel; 0 if not usable
  float* inverse = nullptr;  // 1/m, by pixel
  Camera camera;
  Rotation to_camera;                // maps the cloud's axes to the camera's
  PixelScale<float> scale{};         // for whole windows
  PixelScale<double> exact_scale{};  // for gated windows
  int window = 0;
  EdgeGate edges;
  WindowShape whole;       // window that the image's border does not cut
  float4* seen = nullptr;  // normals in camera axes, rounded through world axes; inverse
                           // depth without holes
  Denoising points = Denoising::on;
  ImageRoom room;
};

// Places one of an image's tiles with a margin. `Radius` is the windows', or 0 if not constant.
template <int Radius>
class TileFrame {
 public:
  static constexpr int kRadius = Radius;

  int u0, v0, width, height;  // u0, v0: the tile's first pixel; width, height: the image's

  __device__ TileFrame(const CloudRecipe& recipe, int number)
      : u0(number % CloudTile::tiles_per_row(recipe.camera) * CloudTile::kWidth),
        v0(number / CloudTile::tiles_per_row(recipe.camera) * CloudTile::kHeight),
        width(static_cast<int>(recipe.camera.width)),
        height(static_cast<int>(recipe.camera.height)),
        radius_(recipe.window / 2) {}
  __host__ __device__ static constexpr int margin_of(int radius) {
    return radius > kFillPasses ? radius : kFillPasses;
  }
  __device__ int radius() const { return Radius > 0 ? Radius : radius_; }
  __device__ int margin() const { return margin_of(radius()); }
  __device__ int pitch() const { return CloudTile::kWidth + 2 * margin(); }
  __device__ int rows() const { return CloudTile::kHeight + 2 * margin(); }
  // Returns the number of window columns: the tile's and those beside it.
  __device__ int columns() const { return CloudTile::kWidth + 2 * radius(); }
  // Returns the index of the tile's pixel (x, y), from -margin on, in an array with the margin.
  __device__ int index(int x, int y) const { return (y + margin()) * pitch() + x + margin(); }
  __device__ std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(v0 + y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u0 + x);
  }

  // True if the image has this pixel of the tile.
  __device__ bool holds(int x, int y) const { return x < end_x() && y < end_y(); }
  __device__ bool is_in_image(int x, int y) const {
    return u0 + x >= 0 && v0 + y >= 0 && u0 + x < width && v0 + y < height;
  }
  // True if the image's border cuts windows.
  __device__ bool may_be_cut() const {
    return cuts_windows(u0, CloudTile::kWidth, width, radius()) ||
           cuts_windows(v0, CloudTile::kHeight, height, radius());
  }
  // Return the image's end, counted from the tile's first column and row.
  __device__ int end_x() const { return width - u0; }
  __device__ int end_y() const { return height - v0; }

 private:
  int radius_;
};

// Cuts a block's shared memory into arrays.
class SharedArrays {
 public:
  __device__ explicit SharedArrays(void* memory) : next_(static_cast<unsigned char*>(memory)) {}
  template <class T>
  __device__ T* take(int count) {
    T* const array = reinterpret_cast<T*>(next_);
    next_ += static_cast<std::size_t>(count) * sizeof(T);
    return array;
  }

 private:
  unsigned char* next_;
};

// Waits, in a kernel launched with LaunchKind::overlapping, for all work before it in the stream.
__device__ __forceinline__ void wait_for_last() {
#if __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}

// True if wait_for_last() works in a kernel, so that it may be launched to overlap. False for
// machine code made from older PTX.
template <class... Parameters>
bool waits_for_last(void (*kernel)(Parameters...)) {
  cudaFuncAttributes attributes;
  check(cudaFuncGetAttributes(&attributes, reinterpret_cast<const void*>(kernel)));
  return attributes.ptxVersion >= 90 && attributes.binaryVersion >= 90;
}

// Lets a kernel use this much shared memory per block. False if the device has less.
template <class... Parameters>
bool has_shared_memory(void (*kernel)(Parameters...), std::size_t bytes) {
  constexpr std::size_t kWithoutAsking = 48 * 1024;
  int most = 0;
  check(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, current_device()));
  if (bytes > static_cast<std::size_t>(most)) return false;
  if (bytes > kWithoutAsking)
    check(cudaFuncSetAttribute(reinterpret_cast<const void*>(kernel),
                               cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(bytes)));
  return true;
}

// Launches a block for each of the image's tiles. With `overlaps` it must wait_for_last().
template <class... Parameters, class... Arguments>
void launch_over_tiles(const Camera& camera, void (*kernel)(Parameters...), unsigned threads,
                       std::size_t shared, bool overlaps, cudaStream_t stream,
                       const Arguments&... arguments) {
  const auto tiles = static_cast<unsigned>(CloudTile::tile_count(camera));
  launch_kernel(kernel, {tiles, threads, shared},
                overlaps ? LaunchKind::overlapping : LaunchKind::independent, stream, arguments...);
}

}  // namespace vpm::cuda
