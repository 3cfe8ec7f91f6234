// What the kernels of cloud_prepare.cu and cloud_settle.cu know of an image, and of the tile of it
// that a block works on.
#pragma once

#include "libvpm/cloud/depth_image.h"
#include "libvpm/cloud/normal_window.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/surface/cuda/cloud_room.h"
#include "libvpm/surface/hole_closing.h"
#include "libvpm/surface/point_reading.h"

namespace vpm::cuda {

inline constexpr int kTileWidth = 32, kTileHeight = 16, kTilePixels = kTileWidth * kTileHeight;
inline constexpr unsigned kTileThreads = 256;
// Blocks of a multiprocessor: so many, if it has threads for them.
VPM_HD constexpr int blocks_for_tiles(int wanted) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
  constexpr int kMost = 1024 / kTileThreads;
  return wanted < kMost ? wanted : kMost;
#else
  return wanted;
#endif
}
// Coarser levels whose tiles lie whole in one tile of the kernel.
inline constexpr int kTileLevels = 4;
static_assert(kTileHeight == 1 << kTileLevels && kTileWidth % kTileHeight == 0);

// Some of an image's tiles; those of u1 and v1 are no more among them.
struct TileRectangle {
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;

  __host__ __device__ int columns() const { return u1 - u0; }
  __host__ __device__ int count() const { return columns() * (v1 - v0); }
  __host__ __device__ bool holds(int u, int v) const {
    return u >= u0 && u < u1 && v >= v0 && v < v1;
  }
};

// An image and how its cloud is made.
struct CloudRecipe {
  const float* depth = nullptr;    // by pixel; 0 where normals and queries have no use for it
  const float* inverse = nullptr;  // of that
  Camera camera;
  Rotation to_camera;  // from the cloud's axes
  double per_fx = 0, per_fy = 0;
  int window = 0;
  EdgeGate edges;
  WholeWindow whole;
  Vec3f* seen = nullptr;  // normals of the pixels, camera axes, turned back from the world's
  PointReading points = PointReading::settled;
  CloudRoom room;
  TileRectangle wanted, made;  // a launch makes what is wanted and was not made before
};

// Where a block's tile lies, and its image with a margin. `Radius`: of the windows; 0 if it is
// known at run time only.
template <int Radius>
class TileFrame {
 public:
  int u0, v0, width, height;  // width, height: of the image
  bool is_made;               // before this launch

  __device__ explicit TileFrame(const CloudRecipe& recipe)
      : width(static_cast<int>(recipe.camera.width)),
        height(static_cast<int>(recipe.camera.height)),
        radius_(recipe.window / 2) {
    const auto per_row = static_cast<unsigned>(recipe.wanted.columns());
    const int u = recipe.wanted.u0 + static_cast<int>(blockIdx.x % per_row);
    const int v = recipe.wanted.v0 + static_cast<int>(blockIdx.x / per_row);
    is_made = recipe.made.holds(u, v);
    u0 = u * kTileWidth;
    v0 = v * kTileHeight;
  }
  __host__ __device__ static constexpr int margin_of(int radius) {
    return radius > kFillPasses ? radius : kFillPasses;
  }
  __device__ int radius() const { return Radius > 0 ? Radius : radius_; }
  __device__ int margin() const { return margin_of(radius()); }
  __device__ int pitch() const { return kTileWidth + 2 * margin(); }
  __device__ int rows() const { return kTileHeight + 2 * margin(); }
  // Columns of windows: the tile's, and those beside it.
  __device__ int columns() const { return kTileWidth + 2 * radius(); }
  // Of the tile's own pixel (x, y), from -margin on.
  __device__ int index(int x, int y) const { return (y + margin()) * pitch() + x + margin(); }
  __device__ bool holds(int x, int y) const { return u0 + x < width && v0 + y < height; }
  __device__ std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(v0 + y) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(u0 + x);
  }

 private:
  int radius_;
};

// The rows of a block's tile to their places in the image, word by word, so that a warp's words lie
// together.
template <int Radius>
__device__ __forceinline__ void write_rows(const TileFrame<Radius>& tile, const Vec3f* from,
                                           Vec3f* to) {
  const auto* const words = reinterpret_cast<const float*>(from);
  auto* const image = reinterpret_cast<float*>(to);
  constexpr int kRow = 3 * kTileWidth;
#pragma unroll 6
  for (int k = static_cast<int>(threadIdx.x); k < 3 * kTilePixels;
       k += static_cast<int>(blockDim.x)) {
    const int x = k % kRow, y = k / kRow;
    if (x < 3 * (tile.width - tile.u0) && tile.v0 + y < tile.height)
      image[3 * tile.pixel(0, y) + static_cast<std::size_t>(x)] = words[k];
  }
}

// A block's shared memory, cut into arrays.
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

// Of a kernel that was launched before what comes before it in the stream is done: until all of
// that is.
__device__ __forceinline__ void wait_for_last() {
#if __CUDA_ARCH__ >= 900
  cudaGridDependencySynchronize();
#endif
}

// A block for each tile that is wanted. `overlaps`: the kernel waits for the last one itself.
template <class... Parameters, class... Arguments>
void launch_over_tiles(const CloudRecipe& recipe, void (*kernel)(Parameters...), unsigned threads,
                       std::size_t shared, bool overlaps, cudaStream_t stream, const Arguments&... arguments) {
  cudaLaunchConfig_t launch{};
  launch.gridDim = static_cast<unsigned>(recipe.wanted.count());
  launch.blockDim = threads;
  launch.dynamicSmemBytes = shared;
  launch.stream = stream;
  cudaLaunchAttribute overlap;
  overlap.id = cudaLaunchAttributeProgrammaticStreamSerialization;
  overlap.val.programmaticStreamSerializationAllowed = 1;
  launch.attrs = &overlap;
  launch.numAttrs = overlaps ? 1 : 0;
  check(cudaLaunchKernelEx(&launch, kernel, arguments...));
}

}  // namespace vpm::cuda
