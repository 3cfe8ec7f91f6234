// Normals of a tile of a depth image: the sums of libvpm/cloud/normal_rows_*.cpp and
// normal_window.cpp in the same order, by a thread for each column and then for each pixel.
#pragma once

#include "libvpm/surface/cuda/cloud_tile.h"
#include "libvpm/surface/cuda/gated_window.h"

namespace vpm::cuda {

// What a block knows of its tile when normals are estimated.
template <class Frame>
struct TileImage {
  Frame frame;
  const float *inverse, *depth;  // with the margin (tile_around.h); depth only where it is needed
  const double *ray_x, *ray_y;   // of the tile's columns and rows
};

// How a tile's normals are estimated. Each has: what is kept of a column, the sums down a column,
// the normal of a smooth window from them, and that of a gated one.
template <class Tile>
class InverseDepthNormals {
 public:
  using Frame = Tile;
  static constexpr bool kNeedsDepth = false;
  static constexpr int kMostBlocks = 5;  // of a multiprocessor
  struct alignas(16) Column {
    int low, high;
    float s, vs;
  };

  __device__ __forceinline__ InverseDepthNormals(const CloudRecipe& recipe,
                                                 const TileImage<Frame>& image)
      : recipe_(recipe), image_(image) {}

  // Down the column x (from -radius on) around the row y.
  __device__ __forceinline__ Column sum_column(int x, int y) const {
    const Frame& frame = image_.frame;
    const float* const middle = image_.inverse + frame.index(x, y);
    float s = *middle, vs = 0;
    Extent extent(s);
#pragma unroll
    for (int d = 1; d <= frame.radius(); ++d) {
      const float below = middle[d * frame.pitch()], above = middle[-d * frame.pitch()];
      add_rows(below, above, static_cast<float>(d), s, vs);
      extent.take(Extent(below), Extent(above));
    }
    return {extent.low, extent.high, s, vs};
  }

  // `column`: that of the pixel; false where its window is not smooth.
  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    const float centre = image_.inverse[image_.frame.index(x, y)];
    float s = column->s, us = 0, vs = column->vs;
    Extent extent(column->low, column->high);
#pragma unroll
    for (int d = 1; d <= image_.frame.radius(); ++d) {
      const Column right = column[d], left = column[-d];
      add_columns(right.s, left.s, right.vs, left.vs, static_cast<float>(d), s, us, vs);
      extent.take({right.low, right.high}, {left.low, left.high});
    }
    if (!extent.is_smooth(centre, recipe_.edges)) return false;
    normal = normal_of_plane<float>(recipe_.whole.plane(s, us, vs, centre), fx(), fy(), du_axis(x),
                                    dv_axis(y));
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const Frame& frame = image_.frame;
    const GatedWindow<Frame::kRadius> window({image_.inverse + frame.index(x, y), frame.pitch()},
                                             frame.radius(), recipe_.edges);
    LastChoice last;
    return normal_of_window(window.fit(last), fx(), fy(), du_axis(x), dv_axis(y));
  }

 private:
  __device__ __forceinline__ float fx() const {
    return static_cast<float>(recipe_.camera.intrinsics.fx);
  }
  __device__ __forceinline__ float fy() const {
    return static_cast<float>(recipe_.camera.intrinsics.fy);
  }
  __device__ __forceinline__ float du_axis(int x) const {
    return static_cast<float>(recipe_.camera.intrinsics.cx - (image_.frame.u0 + x));
  }
  __device__ __forceinline__ float dv_axis(int y) const {
    return static_cast<float>(recipe_.camera.intrinsics.cy - (image_.frame.v0 + y));
  }

  const CloudRecipe& recipe_;
  TileImage<Frame> image_;
};

template <class Tile>
class PcaNormals {
 public:
  using Frame = Tile;
  static constexpr bool kNeedsDepth = true;
  static constexpr int kMostBlocks = 3;
  struct Column {
    double z, vz, z2, vz2, vvz2;
    int low, high;
  };

  __device__ __forceinline__ PcaNormals(const CloudRecipe& recipe, const TileImage<Frame>& image)
      : recipe_(recipe), image_(image) {}

  __device__ __forceinline__ Column sum_column(int x, int y) const {
    const Frame& frame = image_.frame;
    const int at = frame.index(x, y);
    const double middle = image_.depth[at];
    double z = middle, vz = 0, z2 = middle * middle, vz2 = 0, vvz2 = 0;
    Extent extent(image_.inverse[at]);
#pragma unroll
    for (int d = 1; d <= frame.radius(); ++d) {
      const int b = at + d * frame.pitch(), a = at - d * frame.pitch();
      const double below = image_.depth[b], above = image_.depth[a], distance = d;
      add_depth_rows(below, above, distance, z, vz);
      add_square_rows(below, above, distance, z2, vz2, vvz2);
      extent.take(Extent(image_.inverse[b]), Extent(image_.inverse[a]));
    }
    return {z, vz, z2, vz2, vvz2, extent.low, extent.high};
  }

  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    Extent extent(column->low, column->high);
#pragma unroll
    for (int d = 1; d <= image_.frame.radius(); ++d) {
      extent.take({column[d].low, column[d].high}, {column[-d].low, column[-d].high});
    }
    if (!extent.is_smooth(image_.inverse[image_.frame.index(x, y)], recipe_.edges)) return false;
    Moments m;
    const int side = 2 * image_.frame.radius() + 1;
    m.n = side * side;
    m.y = column->vz, m.z = column->z, m.yy = column->vvz2, m.yz = column->vz2, m.zz = column->z2;
#pragma unroll
    for (int d = 1; d <= image_.frame.radius(); ++d) {
      const Column &r = column[d], &l = column[-d];
      const double distance = d;
      add_depth_columns(r.z, l.z, r.vz, l.vz, distance, m.x, m.y, m.z);
      add_square_columns(r.z2, l.z2, distance, m.xx, m.xz, m.zz);
      add_tilted_columns(r.vz2, l.vz2, r.vvz2, l.vvz2, distance, m.xy, m.yz, m.yy);
    }
    normal = normal_of(m, 1 / m.n, x, y);
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const Frame& frame = image_.frame;
    const int at = frame.index(x, y);
    const GatedWindow<Frame::kRadius> window({image_.inverse + at, frame.pitch()}, frame.radius(),
                                             recipe_.edges);
    LastChoice last;
    if (!window.fit(last).found) return {};
    const Moments m = window.moments(last, TileAround(image_.depth + at, frame.pitch()));
    return normal_of(m, quotient(1, m.n), x, y);
  }

 private:
  __device__ __forceinline__ Vec3f normal_of(const Moments& m, double per_n, int x, int y) const {
    return normal_of_moments(m, per_n, recipe_.per_fx, recipe_.per_fy, image_.ray_x[x],
                             image_.ray_y[y]);
  }

  const CloudRecipe& recipe_;
  TileImage<Frame> image_;
};

}  // namespace vpm::cuda
