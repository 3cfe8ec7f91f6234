#include <math_constants.h>

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/surface/cuda/cloud_normals.h"
#include "libvpm/surface/cuda/cloud_prepare.h"

namespace vpm::cuda {
namespace {

// Arrays of a block.
template <class Normals, int Radius>
struct TileArrays {
  using Column = typename Normals::Column;
  Column* columns;  // of the windows; then the positions
  double *ray_x, *ray_y;
  float *inverse, *depth;  // with the margin
  float* closed;           // after the first pass, with a margin of 1
  Vec3f* normals;          // camera axes
  Vec3f* world_normals;
  std::uint16_t* gated;  // pixels whose windows are not smooth

  static constexpr int kClosedWidth = kTileWidth + 2, kClosedHeight = kTileHeight + 2;
  static_assert(sizeof(Column) * kTileWidth >= sizeof(Vec3f) * kTileWidth);

  __device__ TileArrays(const TileFrame<Radius>& tile, SharedArrays arrays)
      : columns(arrays.take<Column>(kTileHeight * tile.columns())),
        ray_x(arrays.take<double>(kTileWidth)),
        ray_y(arrays.take<double>(kTileHeight)),
        inverse(arrays.take<float>(tile.rows() * tile.pitch())),
        depth(arrays.take<float>(Normals::kNeedsDepth ? tile.rows() * tile.pitch() : 0)),
        closed(arrays.take<float>(kClosedWidth * kClosedHeight)),
        normals(arrays.take<Vec3f>(kTilePixels)),
        world_normals(arrays.take<Vec3f>(kTilePixels)),
        gated(arrays.take<std::uint16_t>(kTilePixels)) {}

  static std::size_t bytes(int radius) {
    const int margin = TileFrame<Radius>::margin_of(radius);
    const int image = (kTileHeight + 2 * margin) * (kTileWidth + 2 * margin);
    const auto size = [](std::size_t of_one, int count) {
      return of_one * static_cast<std::size_t>(count);
    };
    return size(sizeof(Column), kTileHeight * (kTileWidth + 2 * radius)) +
           size(sizeof(double), kTileWidth + kTileHeight) +
           size(sizeof(float),
                (Normals::kNeedsDepth ? 2 : 1) * image + kClosedWidth * kClosedHeight) +
           size(2 * sizeof(Vec3f) + sizeof(std::uint16_t), kTilePixels);
  }
};

// One tile of an image, by a block.
template <class Normals, int Radius>
class TileWork {
 public:
  __device__ __forceinline__ TileWork(const CloudRecipe& recipe, void* shared)
      : recipe_(recipe),
        tile_(recipe),
        arrays_(tile_, SharedArrays(shared)),
        normals_(recipe, {tile_, arrays_.inverse, arrays_.depth, arrays_.ray_x, arrays_.ray_y}) {}

  __device__ __forceinline__ bool is_done() const { return tile_.is_made; }
  // Does not need the image.
  __device__ __forceinline__ void find_rays() const {
    const Intrinsics& k = recipe_.camera.intrinsics;
    const int i = thread();
    if (i < kTileWidth) arrays_.ray_x[i] = (tile_.u0 + i - k.cx) / k.fx;
    if (i < kTileHeight) arrays_.ray_y[i] = (tile_.v0 + i - k.cy) / k.fy;
  }

  // Whether pixels of the image in the tile or its margin are unknown.
  __device__ __forceinline__ bool load() const {
    bool unknown = false;
    const int count = tile_.rows() * tile_.pitch();
#pragma unroll 4
    for (int k = thread(); k < count; k += kTileThreads) {
      const int x = k % tile_.pitch() - tile_.margin(), y = k / tile_.pitch() - tile_.margin();
      const bool is_inside = tile_.u0 + x >= 0 && tile_.v0 + y >= 0 && tile_.holds(x, y);
      const float inverse = is_inside ? recipe_.inverse[tile_.pixel(x, y)] : 0.0F;
      arrays_.inverse[k] = inverse;
      if constexpr (Normals::kNeedsDepth)
        arrays_.depth[k] = is_inside ? recipe_.depth[tile_.pixel(x, y)] : 0.0F;
      unknown |= is_inside && !(inverse > 0);
    }
    return unknown;
  }

  __device__ __forceinline__ void sum_columns() const {
    for (int k = thread(); k < kTileHeight * tile_.columns(); k += kTileThreads)
      arrays_.columns[k] =
          normals_.sum_column(k % tile_.columns() - tile_.radius(), k / tile_.columns());
  }

  // The first pass of closing holes, of the tile and the pixels beside it.
  __device__ __forceinline__ void close_once() const {
    const auto image = [&](int u, int v) {
      return arrays_.inverse[tile_.index(u - tile_.u0, v - tile_.v0)];
    };
    for (int k = thread(); k < kClosedWidth * Arrays::kClosedHeight; k += kTileThreads) {
      const int x = k % kClosedWidth - 1, y = k / kClosedWidth - 1;
      const int u = tile_.u0 + x, v = tile_.v0 + y;
      const float value = arrays_.inverse[tile_.index(x, y)];
      const bool is_hole = !(value > 0) && u >= 0 && v >= 0 && tile_.holds(x, y);
      arrays_.closed[k] =
          is_hole ? between_neighbors(image, tile_.width, tile_.height, u, v) : value;
    }
  }

  // Normals of smooth windows; the others are listed. The surface without holes.
  __device__ __forceinline__ void find_normals(bool has_holes, unsigned& gated) const {
    for (int k = thread(); k < kTilePixels; k += kTileThreads) {
      const int x = k % kTileWidth, y = k / kTileWidth;
      const float inverse = arrays_.inverse[tile_.index(x, y)];
      Vec3f normal;
      if (inverse > 0 &&
          !normals_.smooth_normal(arrays_.columns + y * tile_.columns() + x + tile_.radius(), x, y,
                                  normal))
        arrays_.gated[atomicAdd(&gated, 1U)] = static_cast<std::uint16_t>(k);
      arrays_.normals[k] = normal;
      if (tile_.holds(x, y))
        recipe_.room.measured[tile_.pixel(x, y)] = has_holes ? closed_twice(x, y) : inverse;
    }
  }
  __device__ __forceinline__ void find_gated_normals(unsigned count) const {
    for (unsigned k = threadIdx.x; k < count; k += kTileThreads) {
      const int pixel = arrays_.gated[k];
      arrays_.normals[pixel] = normals_.gated_normal(pixel % kTileWidth, pixel / kTileWidth);
    }
  }

  // The points, but in shared memory. Adds them up.
  __device__ __forceinline__ void place_points(unsigned& points, unsigned& doubtful) const {
    for (int k = thread(); k < kTilePixels; k += kTileThreads) {
      const int x = k % kTileWidth, y = k / kTileWidth;
      const Vec3f normal = arrays_.normals[k];
      const bool is_point = normal.x != 0 || normal.y != 0 || normal.z != 0;
      if (recipe_.room.estimated != nullptr && tile_.holds(x, y))
        recipe_.room.estimated[tile_.pixel(x, y)] = normal;
      Vec3f position{CUDART_NAN_F, CUDART_NAN_F, CUDART_NAN_F}, in_world{}, turned_back{};
      if (is_point) {
        const Rotation& to_world = recipe_.camera.to_world.rotation;
        const double depth = recipe_.depth[tile_.pixel(x, y)];
        position = narrow(to_world * point_on_ray(arrays_.ray_x[x], arrays_.ray_y[y], depth));
        in_world = narrow(to_world * widen(normal));
        turned_back = narrow(recipe_.to_camera * widen(in_world));
      }
      positions()[k] = position;
      arrays_.world_normals[k] = in_world;
      arrays_.normals[k] = turned_back;
      add_up(is_point, points);
      add_up(is_point && is_doubtful(normal), doubtful);
    }
  }
  __device__ __forceinline__ void write_points() const {
    write_rows(tile_, positions(), recipe_.room.positions);
    write_rows(tile_, arrays_.world_normals, recipe_.room.normals);
    write_rows(tile_, arrays_.normals, recipe_.seen);
  }

 private:
  using Arrays = TileArrays<Normals, Radius>;
  static constexpr int kClosedWidth = Arrays::kClosedWidth;

  __device__ __forceinline__ static int thread() {
    return static_cast<int>(threadIdx.x);
  }

  __device__ __forceinline__ float closed_twice(int x, int y) const {
    const auto image = [&](int u, int v) {
      return arrays_.closed[(v - tile_.v0 + 1) * kClosedWidth + u - tile_.u0 + 1];
    };
    const int u = tile_.u0 + x, v = tile_.v0 + y;
    const float value = image(u, v);
    return value > 0 || !tile_.holds(x, y)
               ? value
               : between_neighbors(image, tile_.width, tile_.height, u, v);
  }

  // Normals are at most this far off unit length (squared), or a PreparedCloud might refuse them.
  __device__ __forceinline__ static bool is_doubtful(Vec3f n) {
    constexpr float kSquaredTolerance = 1e-3F;
    return !(std::fabs(n.x * n.x + n.y * n.y + n.z * n.z - 1) <= kSquaredTolerance);
  }

  // By whole warps.
  __device__ __forceinline__ static void add_up(bool is_one, unsigned& count) {
    const unsigned ones = __ballot_sync(~0U, is_one);
    if (ones != 0 && threadIdx.x % 32 == 0) atomicAdd(&count, static_cast<unsigned>(__popc(ones)));
  }

  __device__ __forceinline__ Vec3f* positions() const {
    return reinterpret_cast<Vec3f*>(arrays_.columns);
  }

  const CloudRecipe& recipe_;
  TileFrame<Radius> tile_;
  Arrays arrays_;
  Normals normals_;
};

// By all threads of a block. `gated`: 0.
template <class Normals, int Radius>
__device__ __forceinline__ void make_tile(const TileWork<Normals, Radius>& work, unsigned& gated,
                                          unsigned& points, unsigned& doubtful) {
  const bool has_holes = __syncthreads_or(work.load()) != 0;
  work.sum_columns();
  if (has_holes) work.close_once();
  __syncthreads();
  work.find_normals(has_holes, gated);
  __syncthreads();
  work.find_gated_normals(gated);
  __syncthreads();
  work.place_points(points, doubtful);
  __syncthreads();
  work.write_points();
}

template <class Normals, int Radius>
__global__ void __launch_bounds__(kTileThreads, blocks_for_tiles(Normals::kMostBlocks))
    prepare_cloud(const __grid_constant__ CloudRecipe recipe, CloudCounters* counters,
                  CloudAnswer* answer, unsigned sequence) {
  extern __shared__ double2 shared_memory[];
  __shared__ unsigned gated, points, doubtful;
  const TileWork<Normals, Radius> work(recipe, shared_memory);
  if (threadIdx.x == 0) gated = points = doubtful = 0;
  work.find_rays();
  wait_for_last();
  if (!work.is_done()) make_tile(work, gated, points, doubtful);
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

template <template <int> class Normals>
Choice choose(int radius) {
  constexpr int kUsual = 3;  // of the default window
  if (radius == kUsual)
    return {prepare_cloud<Normals<kUsual>, kUsual>,
            TileArrays<Normals<kUsual>, kUsual>::bytes(radius)};
  return {prepare_cloud<Normals<0>, 0>, TileArrays<Normals<0>, 0>::bytes(radius)};
}

Choice choose(NormalMethod method, int radius) {
  return method == NormalMethod::pca ? choose<PcaNormals>(radius)
                                     : choose<InverseDepthNormals>(radius);
}

// Whether the kernel waits for its image itself, so that it may be launched before that is there.
// Machine code made from older PTX does not.
bool waits_for_image(Kernel kernel) {
  cudaFuncAttributes attributes;
  check(cudaFuncGetAttributes(&attributes, reinterpret_cast<const void*>(kernel)));
  return attributes.ptxVersion >= 90 && attributes.binaryVersion >= 90;
}

// What every kernel may take without asking.
constexpr std::size_t kSharedBytes = 48 * 1024;

}  // namespace

Preparation preparation_of(const NormalOptions& options) {
  int most = 0;
  check(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, current_device()));
  const Choice choice = choose(options.method, options.window / 2);
  if (choice.bytes > static_cast<std::size_t>(most)) return {};
  if (choice.bytes > kSharedBytes)
    check(cudaFuncSetAttribute(reinterpret_cast<const void*>(choice.kernel),
                               cudaFuncAttributeMaxDynamicSharedMemorySize,
                               static_cast<int>(choice.bytes)));
  return {true, waits_for_image(choice.kernel)};
}

void prepare_on_device(const CloudRecipe& recipe, NormalMethod method,
                       const Preparation& preparation, CloudCounters* counters, CloudAnswer* answer,
                       unsigned sequence, cudaStream_t stream) {
  const Choice choice = choose(method, recipe.window / 2);
  launch_over_tiles(recipe, choice.kernel, kTileThreads, choice.bytes, preparation.overlaps, stream, recipe,
                    counters, answer, sequence);
}

}  // namespace vpm::cuda
