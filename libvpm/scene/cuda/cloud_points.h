// Finds the normals of a tile of an image by a block, and closes its holes, for cloud_prepare.cu.
#pragma once

#include "libvpm/scene/cuda/cloud_normals.h"

namespace vpm::cuda {

// Lays out a block's arrays in shared memory.
template <class Normals>
struct TileArrays {
  using Frame = typename Normals::Frame;
  using Column = typename Normals::Column;
  Column* columns;  // columns of the windows
  double *ray_x, *ray_y;
  float *inverse, *depth;  // with the margin
  float* closed;           // after the first pass, with a margin of 1
  Vec3f* normals;          // camera axes
  float* measured;         // inverse depth without holes
  std::uint16_t* gated;    // pixels whose windows are not smooth

  static constexpr int kClosedWidth = CloudTile::kWidth + 2, kClosedHeight = CloudTile::kHeight + 2;

  __device__ TileArrays(const Frame& tile, SharedArrays arrays)
      : columns(arrays.take<Column>(CloudTile::kHeight * tile.columns())),
        ray_x(arrays.take<double>(CloudTile::kWidth)),
        ray_y(arrays.take<double>(CloudTile::kHeight)),
        inverse(arrays.take<float>(tile.rows() * tile.pitch())),
        depth(arrays.take<float>(Normals::kNeedsDepth ? tile.rows() * tile.pitch() : 0)),
        closed(arrays.take<float>(kClosedWidth * kClosedHeight)),
        normals(arrays.take<Vec3f>(CloudTile::kPixels)),
        measured(arrays.take<float>(CloudTile::kPixels)),
        gated(arrays.take<std::uint16_t>(CloudTile::kPixels)) {}

  static constexpr std::size_t bytes(int radius) {
    const int margin = Frame::margin_of(radius);
    const int image = (CloudTile::kHeight + 2 * margin) * (CloudTile::kWidth + 2 * margin);
    const auto size = [](std::size_t of_one, int count) {
      return of_one * static_cast<std::size_t>(count);
    };
    return size(sizeof(Column), CloudTile::kHeight * (CloudTile::kWidth + 2 * radius)) +
           size(sizeof(double), CloudTile::kWidth + CloudTile::kHeight) +
           size(sizeof(float),
                (Normals::kNeedsDepth ? 2 : 1) * image + kClosedWidth * kClosedHeight) +
           size(sizeof(Vec3f) + sizeof(float) + sizeof(std::uint16_t), CloudTile::kPixels);
  }
};

// Works on one tile of an image with one block.
template <class Normals>
class TileWork {
 public:
  using Frame = typename Normals::Frame;
  __device__ __forceinline__ TileWork(const CloudRecipe& recipe, int number, void* shared)
      : recipe_(recipe),
        tile_(recipe, number),
        arrays_(tile_, SharedArrays(shared)),
        normals_(recipe, {tile_, arrays_.inverse, arrays_.depth, arrays_.ray_x, arrays_.ray_y}) {}

  // Computes the tile's rays, which do not need the image.
  __device__ __forceinline__ void find_rays() const {
    const Intrinsics& k = recipe_.camera.intrinsics;
    const int i = thread();
    if (i < CloudTile::kWidth) arrays_.ray_x[i] = (tile_.u0 + i - k.cx) / k.fx;
    if (i < CloudTile::kHeight) arrays_.ray_y[i] = (tile_.v0 + i - k.cy) / k.fy;
  }

  // Computes all normals by all threads of the block, and synchronises. `gated` must be 0.
  __device__ __forceinline__ void find_normals(unsigned& gated) const {
    const bool has_holes = __syncthreads_or(load()) != 0;
    if (tile_.may_be_cut())
      sum_columns<true>();
    else
      sum_columns<false>();
    if (has_holes) close_once();
    __syncthreads();
    if (tile_.may_be_cut())
      find_smooth_normals<true>(has_holes, gated);
    else
      find_smooth_normals<false>(has_holes, gated);
    __syncthreads();
    find_gated_normals(gated);
    __syncthreads();
  }

  // Loads the image. Returns true if pixels of the tile or its margin are unknown.
  __device__ __forceinline__ bool load() const {
    const float *const inverses = recipe_.inverse, *const depths = recipe_.depth;
    const int count = tile_.rows() * tile_.pitch();
    constexpr int kAtOnce = 4;  // loads in flight before any is stored
    bool unknown = false;
    for (int begin = thread(); begin < count; begin += kAtOnce * CloudTile::kPointThreads) {
      float inverse[kAtOnce], depth[kAtOnce];
#pragma unroll
      for (int i = 0; i < kAtOnce; ++i) {
        const int k = begin + i * CloudTile::kPointThreads;
        const int x = k % tile_.pitch() - tile_.margin(), y = k / tile_.pitch() - tile_.margin();
        const bool is_there = k < count && tile_.is_in_image(x, y);
        inverse[i] = is_there ? measured_or_none(inverses[tile_.pixel(x, y)]) : beyond_image();
        if constexpr (Normals::kNeedsDepth) depth[i] = is_there ? depths[tile_.pixel(x, y)] : 0.0F;
        unknown |= is_there && !(inverse[i] > 0);
      }
#pragma unroll
      for (int i = 0; i < kAtOnce; ++i) {
        const int k = begin + i * CloudTile::kPointThreads;
        if (k >= count) break;
        arrays_.inverse[k] = inverse[i];
        if constexpr (Normals::kNeedsDepth) arrays_.depth[k] = depth[i];
      }
    }
    return unknown;
  }

  // Closes holes in a first pass, in the tile and the pixels beside it.
  __device__ __forceinline__ void close_once() const {
    const auto image = [&](int u, int v) {
      return arrays_.inverse[tile_.index(u - tile_.u0, v - tile_.v0)];
    };
#pragma unroll kUnroll
    for (int k = thread(); k < kClosedWidth * Arrays::kClosedHeight;
         k += CloudTile::kPointThreads) {
      const int x = k % kClosedWidth - 1, y = k / kClosedWidth - 1;
      const int u = tile_.u0 + x, v = tile_.v0 + y;
      const float value = arrays_.inverse[tile_.index(x, y)];
      const bool may_close = !(value > 0) && !is_removed_pixel(value) && tile_.is_in_image(x, y);
      arrays_.closed[k] =
          may_close ? between_neighbors(image, tile_.width, tile_.height, u, v) : value;
    }
  }

  __device__ __forceinline__ void find_gated_normals(unsigned count) const {
#pragma unroll 1
    for (unsigned k = threadIdx.x; k < count; k += CloudTile::kPointThreads) {
      const int pixel = arrays_.gated[k];
      arrays_.normals[pixel] =
          normals_.gated_normal(pixel % CloudTile::kWidth, pixel / CloudTile::kWidth);
    }
  }

  // Writes the image for denoising. Counts the pixels that have a normal, and those whose normals
  // are not of unit length.
  __device__ __forceinline__ void write_seen(unsigned& points, unsigned& doubtful) const {
    const Rotation to_world = recipe_.camera.to_world.rotation, to_camera = recipe_.to_camera;
    float4* const seen = recipe_.seen;
    float* const image = recipe_.room.measured;
#pragma unroll kUnroll
    for (int k = thread(); k < CloudTile::kPixels; k += CloudTile::kPointThreads) {
      const int x = k % CloudTile::kWidth, y = k / CloudTile::kWidth;
      const Vec3f normal = arrays_.normals[k];
      const bool is_point = !is_zero(normal);
      Vec3f turned_back;
      if (is_point) turned_back = narrow(to_camera * widen(narrow(to_world * widen(normal))));
      if (tile_.holds(x, y)) {
        const float measured = arrays_.measured[k];
        seen[tile_.pixel(x, y)] = {turned_back.x, turned_back.y, turned_back.z, measured + 0.0F};
        image[tile_.pixel(x, y)] = measured;  // keeps the -0 of one that was removed
      }
      add_up(is_point && is_doubtful(normal), doubtful);
      add_up(is_point, points);
    }
  }

 private:
  template <bool kMayBeCut>
  __device__ __forceinline__ void sum_columns() const {
#pragma unroll kMayBeCut ? 1 : kUnroll
    for (int k = thread(); k < CloudTile::kHeight * tile_.columns(); k += CloudTile::kPointThreads)
      arrays_.columns[k] = normals_.template sum_column<kMayBeCut>(
          k % tile_.columns() - tile_.radius(), k / tile_.columns());
  }
  // Computes normals of smooth windows, lists the other windows, and closes holes.
  template <bool kMayBeCut>
  __device__ __forceinline__ void find_smooth_normals(bool has_holes, unsigned& gated) const {
#pragma unroll kMayBeCut ? 1 : kUnroll
    for (int k = thread(); k < CloudTile::kPixels; k += CloudTile::kPointThreads) {
      const int x = k % CloudTile::kWidth, y = k / CloudTile::kWidth;
      const float inverse = arrays_.inverse[tile_.index(x, y)];
      Vec3f normal;
      if (tile_.holds(x, y) && inverse > 0 &&
          !normals_.template smooth_normal<kMayBeCut>(
              arrays_.columns + y * tile_.columns() + x + tile_.radius(), x, y, normal))
        arrays_.gated[atomicAdd(&gated, 1U)] = static_cast<std::uint16_t>(k);
      arrays_.normals[k] = normal;
      arrays_.measured[k] = has_holes ? closed_twice(x, y) : inverse;
    }
  }

  using Arrays = TileArrays<Normals>;
  static constexpr int kClosedWidth = Arrays::kClosedWidth;
  static constexpr int kUnroll = 6;

  __device__ __forceinline__ static int thread() {
    return static_cast<int>(threadIdx.x);
  }

  __device__ __forceinline__ static bool is_zero(Vec3f n) {
    return n.x == 0 && n.y == 0 && n.z == 0;
  }

  __device__ __forceinline__ float closed_twice(int x, int y) const {
    const auto image = [&](int u, int v) {
      return arrays_.closed[(v - tile_.v0 + 1) * kClosedWidth + u - tile_.u0 + 1];
    };
    const int u = tile_.u0 + x, v = tile_.v0 + y;
    const float value = image(u, v);
    if (is_removed_pixel(value)) return kRemovedDepth;
    return value > 0 || !tile_.is_in_image(x, y)
               ? value
               : between_neighbors(image, tile_.width, tile_.height, u, v);
  }

  // True if a normal is so far off unit length that a PreparedImage might refuse it.
  __device__ __forceinline__ static bool is_doubtful(Vec3f n) {
    constexpr float kSquaredTolerance = 1e-3F;
    return !(std::fabs(n.x * n.x + n.y * n.y + n.z * n.z - 1) <= kSquaredTolerance);
  }

  // Counts for whole warps at once.
  __device__ __forceinline__ static void add_up(bool is_one, unsigned& count) {
    const unsigned ones = __ballot_sync(~0U, is_one);
    if (ones != 0 && threadIdx.x % 32 == 0) atomicAdd(&count, static_cast<unsigned>(__popc(ones)));
  }

  const CloudRecipe& recipe_;
  Frame tile_;
  Arrays arrays_;
  Normals normals_;
};

}  // namespace vpm::cuda
