// Normals of a tile of a depth image: the sums of libvpm/cloud/normal_rows_*.cpp and
// normal_window.cpp in the same order, by a thread for each column and then for each pixel.
#pragma once

#include "libvpm/surface/cuda/cloud_tile.h"

namespace vpm::cuda {

// Least and greatest inverse depth of a column, then of a window.
struct Extent {
  float low, high;

  __device__ explicit Extent(float value) : low(value), high(value) {}
  __device__ Extent(float least, float most) : low(least), high(most) {}
  __device__ void take(Extent other) {
    low = other.low < low ? other.low : low;
    high = other.high > high ? other.high : high;
  }
  // Whether a window is whole, measured everywhere and without an edge.
  __device__ bool is_smooth(float centre, const EdgeGate& edges) const {
    return low > 0 && low >= edges.lowest * centre && high <= edges.highest * centre;
  }
};

// The plane of the pixels of one window that belong to the surface of its centre.
template <class Frame>
class GatedFit {
 public:
  __device__ __forceinline__ GatedFit(const float* centre, const Frame& tile, const EdgeGate& edges)
      : centre_(centre), tile_(tile), edges_(edges), middle_(*centre), unit_(1.0F / middle_) {}

  // The last choice of pixels is by the gate about the plane `first`.
  __device__ __forceinline__ WindowPlane run(WindowPlane& first) const {
    WindowPlane plane;
#pragma unroll 1
    for (int choice = 0; choice < 2; ++choice) {
      first = plane;
      plane = fit(first, choice == 0 ? edges_.slope : 0);
      if (!plane.found) break;
    }
    return plane;
  }
  __device__ __forceinline__ bool keeps(const WindowPlane& first, int du, int dv) const {
    const float value = centre_[dv * tile_.pitch() + du];
    const float expected =
        first.c + first.a * static_cast<float>(du) + first.b * static_cast<float>(dv);
    return is_in_gate(value, (value - middle_) * unit_, expected, edges_.gate);
  }

 private:
  // Columns of a group are added pairwise; those that the window does not have are 0.
  static constexpr int kGroup = 8;
  struct ColumnSums {
    float e = 0, ue = 0, ve = 0;
    friend __device__ ColumnSums operator+(ColumnSums a, ColumnSums b) {
      return {a.e + b.e, a.ue + b.ue, a.ve + b.ve};
    }
  };
  struct Counts {  // integers, exact in any order
    float n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
  };

  __device__ __forceinline__ ColumnSums add_column(int k, const WindowPlane& near, float slope,
                                                   Counts& counts) const {
    if (k > 2 * tile_.radius()) return {};
    const int radius = tile_.radius(), du = k - radius;
    const float x = static_cast<float>(du), predicted = near.c + near.a * x;
    const float along = std::fabs(x);
    float count = 0, y1 = 0, y2 = 0, e1 = 0, ye = 0;
#pragma unroll
    for (int dv = -radius; dv <= radius; ++dv) {
      const float value = centre_[dv * tile_.pitch() + du], y = static_cast<float>(dv);
      const float difference = (value - middle_) * unit_;
      const float away = std::fabs(y), reach = along > away ? along : away;
      const bool kept =
          is_in_gate(value, difference, predicted + near.b * y, edges_.gate + slope * reach);
      const float weight = kept ? 1.0F : 0.0F, e = kept ? difference : 0.0F;
      count += weight, y1 += y * weight, y2 += y * y * weight;
      e1 += e, ye += y * e;
    }
    counts.n += count, counts.u += x * count, counts.uu += x * x * count;
    counts.v += y1, counts.uv += x * y1, counts.vv += y2;
    return {e1, x * e1, ye};
  }

  __device__ __forceinline__ WindowPlane fit(const WindowPlane& near, float slope) const {
    Counts counts;
    double e = 0, ue = 0, ve = 0;
    for (int group = 0; group <= 2 * tile_.radius(); group += kGroup) {
      ColumnSums sum;
#pragma unroll 1
      for (int h = 0; h < 2; ++h) {
        const auto pair = [&](int k) {
          const ColumnSums first = add_column(group + k, near, slope, counts);
          return first + add_column(group + k + kGroup / 2, near, slope, counts);
        };
        const ColumnSums even = pair(h), half = even + pair(h + 2);
        sum = h == 0 ? half : sum + half;
      }
      e += sum.e, ue += sum.ue, ve += sum.ve;
    }
    return plane_of_sums(
        {counts.n, counts.u, counts.v, counts.uu, counts.uv, counts.vv, e, ue, ve});
  }

  const float* centre_;
  const Frame& tile_;
  const EdgeGate& edges_;
  float middle_, unit_;
};

// What a block knows of its tile when normals are estimated.
template <class Frame>
struct TileImage {
  Frame frame;
  const float *inverse, *depth;  // with the margin; depth only where it is needed
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
    float low, high, s, vs;
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
      extent.take(Extent(below));
      extent.take(Extent(above));
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
      extent.take({right.low, right.high});
      extent.take({left.low, left.high});
    }
    if (!extent.is_smooth(centre, recipe_.edges)) return false;
    normal = normal_of_plane<float>(recipe_.whole.plane(s, us, vs, centre), fx(), fy(), du_axis(x),
                                    dv_axis(y));
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const GatedFit<Frame> fit(image_.inverse + image_.frame.index(x, y), image_.frame,
                              recipe_.edges);
    WindowPlane first;
    return normal_of_window(fit.run(first), fx(), fy(), du_axis(x), dv_axis(y));
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
    float low, high;
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
      extent.take(Extent(image_.inverse[b]));
      extent.take(Extent(image_.inverse[a]));
    }
    return {z, vz, z2, vz2, vvz2, extent.low, extent.high};
  }

  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    Extent extent(column->low, column->high);
#pragma unroll
    for (int d = 1; d <= image_.frame.radius(); ++d) {
      extent.take({column[d].low, column[d].high});
      extent.take({column[-d].low, column[-d].high});
    }
    if (!extent.is_smooth(image_.inverse[image_.frame.index(x, y)], recipe_.edges)) return false;
    Moments m;
    m.n = recipe_.window * recipe_.window;
    m.y = column->vz, m.z = column->z, m.yy = column->vvz2, m.yz = column->vz2, m.zz = column->z2;
#pragma unroll
    for (int d = 1; d <= image_.frame.radius(); ++d) {
      const Column &r = column[d], &l = column[-d];
      const double distance = d;
      add_depth_columns(r.z, l.z, r.vz, l.vz, distance, m.x, m.y, m.z);
      add_square_columns(r.z2, l.z2, distance, m.xx, m.xz, m.zz);
      add_tilted_columns(r.vz2, l.vz2, r.vvz2, l.vvz2, distance, m.xy, m.yz, m.yy);
    }
    normal = normal_of(m, x, y);
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const int at = image_.frame.index(x, y), radius = image_.frame.radius();
    const GatedFit<Frame> fit(image_.inverse + at, image_.frame, recipe_.edges);
    WindowPlane first;
    if (!fit.run(first).found) return {};
    Moments m;
    for (int dv = -radius; dv <= radius; ++dv) {
      for (int du = -radius; du <= radius; ++du) {
        // What is not kept would add 0.
        if (fit.keeps(first, du, dv))
          add_pixel(m, 1, image_.depth[at + dv * image_.frame.pitch() + du], du, dv);
      }
    }
    return normal_of(m, x, y);
  }

 private:
  __device__ __forceinline__ Vec3f normal_of(const Moments& m, int x, int y) const {
    return normal_of_moments(m, recipe_.per_fx, recipe_.per_fy, image_.ray_x[x], image_.ray_y[y]);
  }

  const CloudRecipe& recipe_;
  TileImage<Frame> image_;
};

}  // namespace vpm::cuda
