// Windows that are measured everywhere and cross no edge: sums over all their pixels, down each
// column and then across, in the order of libvpm/cloud/normal_rows_*.cpp. A thread takes kAtOnce
// pixels side by side, whose windows share most of what they read; kAtOnce and Radius are known
// beforehand, or the radius is at run time only: Radius is 0 and kAtOnce 1 then.
//
// The columns lie in a block's shared memory beside the image, row by row with the same pitch, so
// that one index serves for both. Rows begin where kAtOnce values lie together.
#pragma once

#include "libvpm/surface/cuda/cloud_tile.h"
#include "libvpm/surface/cuda/tile_around.h"

namespace vpm::cuda {

template <class Real, int kCount>
struct alignas(kCount * sizeof(Real)) Pack {
  Real of[kCount];
};
template <int kCount, class Real>
__device__ __forceinline__ Pack<Real, kCount> pack_at(const Real* values) {
  return *reinterpret_cast<const Pack<Real, kCount>*>(values);
}
template <int kCount, class Real>
__device__ __forceinline__ void put_pack(const Pack<Real, kCount>& pack, Real* values) {
  *reinterpret_cast<Pack<Real, kCount>*>(values) = pack;
}

// Values of a row, from Radius before the first of kAtOnce pixels to Radius beyond the last.
template <class Real, int kAtOnce, int Radius>
class RowValues {
 public:
  __device__ __forceinline__ RowValues(const Real* first, int /*radius*/) {
#pragma unroll
    for (int k = 0; k < 2 * kSide + 1; ++k)
      packs_[k] = pack_at<kAtOnce>(first + (k - kSide) * kAtOnce);
  }
  __device__ __forceinline__ Real at(int i) const {
    return packs_[(i + kSide * kAtOnce) / kAtOnce].of[(i + kSide * kAtOnce) % kAtOnce];
  }
  __device__ __forceinline__ static constexpr int radius() {
    return Radius;
  }

 private:
  static constexpr int kSide = (Radius + kAtOnce - 1) / kAtOnce;
  Pack<Real, kAtOnce> packs_[2 * kSide + 1];
};
template <class Real>
class RowValues<Real, 1, 0> {
 public:
  __device__ __forceinline__ RowValues(const Real* first, int radius)
      : first_(first), radius_(radius) {}
  __device__ __forceinline__ Real at(int i) const { return first_[i]; }
  __device__ __forceinline__ int radius() const { return radius_; }

 private:
  const Real* first_;
  int radius_;
};

// The least, or the greatest, value of each pixel's window: pick(a, b, c) chooses.
template <int kAtOnce, class Row, class Pick>
__device__ __forceinline__ void pick_in_windows(const Row& row, const Pick& pick,
                                                int (&picked)[kAtOnce]) {
  const int radius = row.radius();
  int common = row.at(kAtOnce - 1 - radius);
#pragma unroll
  for (int i = kAtOnce - radius; i <= radius; i += 2)
    common = pick(common, row.at(i), row.at(i < radius ? i + 1 : i));
  int left = common, right = common;
  picked[kAtOnce - 1] = common;
#pragma unroll
  for (int p = kAtOnce - 2; p >= 0; --p) picked[p] = left = pick(left, left, row.at(p - radius));
#pragma unroll
  for (int p = 1; p < kAtOnce; ++p) {
    right = pick(right, right, row.at(p + radius));
    picked[p] = pick(picked[p], picked[p], right);
  }
}

// Extents of columns, then of windows.
template <int kAtOnce, int Radius>
class WindowExtents {
  struct Least {
    __device__ int operator()(int a, int b, int c) const { return __vimin3_s32(a, b, c); }
  };
  struct Greatest {
    __device__ int operator()(int a, int b, int c) const { return __vimax3_s32(a, b, c); }
  };

 public:
  __device__ WindowExtents(SharedArrays& arrays, int count)
      : low_(arrays.take<int>(count)), high_(arrays.take<int>(count)) {}
  static constexpr std::size_t kBytes = 2 * sizeof(int);  // of a column

  // What is known of kAtOnce columns while they are gone down.
  struct Down {
    Pack<int, kAtOnce> low, high;
    Down() = default;
    __device__ __forceinline__ explicit Down(const Pack<float, kAtOnce>& middle) {
#pragma unroll
      for (int p = 0; p < kAtOnce; ++p) low.of[p] = high.of[p] = __float_as_int(middle.of[p]);
    }
    __device__ __forceinline__ void take(int p, float below, float above) {
      Extent extent(low.of[p], high.of[p]);
      extent.take(Extent(below), Extent(above));
      low.of[p] = extent.low, high.of[p] = extent.high;
    }
  };
  __device__ __forceinline__ void put(const Down& down, int at) const {
    put_pack(down.low, low_ + at);
    put_pack(down.high, high_ + at);
  }

  // Which of the pixels have a smooth window, a bit for each. `centres`: their inverse depths.
  __device__ __forceinline__ unsigned smooth(int at, int radius,
                                             const Pack<float, kAtOnce>& centres,
                                             const EdgeGate& edges) const {
    int low[kAtOnce], high[kAtOnce];
    pick_in_windows(RowValues<int, kAtOnce, Radius>(low_ + at, radius), Least(), low);
    pick_in_windows(RowValues<int, kAtOnce, Radius>(high_ + at, radius), Greatest(), high);
    unsigned smooth = 0;
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p)
      smooth |= (Extent(low[p], high[p]).is_smooth(centres.of[p], edges) ? 1U : 0U) << p;
    return smooth;
  }

 private:
  int *low_, *high_;
};

// Of a tile's columns and rows of pixels.
template <class Real>
class TileRays {
 public:
  __device__ TileRays(SharedArrays& arrays, int width, int height)
      : x_(arrays.take<Real>(width)), y_(arrays.take<Real>(height)) {}
  static constexpr std::size_t kBytes = sizeof(Real);  // of a column or row

  __device__ const Real& x(int column) const { return x_[column]; }
  __device__ Real y(int row) const { return y_[row]; }

 protected:
  Real *x_, *y_;
};
// Of each, the ray at depth 1.
class UnitRays : public TileRays<double> {
 public:
  using TileRays::TileRays;
  __device__ void set_column(int i, int u, const Intrinsics& k) const { x_[i] = (u - k.cx) / k.fx; }
  __device__ void set_row(int i, int v, const Intrinsics& k) const { y_[i] = (v - k.cy) / k.fy; }
};
// Of each, how far the camera's axis is, in pixels.
class PixelsToAxis : public TileRays<float> {
 public:
  using TileRays::TileRays;
  __device__ void set_column(int i, int u, const Intrinsics& k) const {
    x_[i] = static_cast<float>(k.cx - u);
  }
  __device__ void set_row(int i, int v, const Intrinsics& k) const {
    y_[i] = static_cast<float>(k.cy - v);
  }
};

// Of a tile that has the image's inverse depth at `inverse`, each with what normals need of it.
template <int TheAtOnce, int Radius>
class SmoothInverseDepth {
 public:
  static constexpr int kAtOnce = TheAtOnce, kRadius = Radius;
  static constexpr int kThreads = 128, kBlocks = 10;  // of a multiprocessor
  static constexpr int kRows = 1;                     // of sums down a column, by a thread together
  static constexpr bool kNeedsDepth = false;
  using Rays = PixelsToAxis;
  static constexpr std::size_t kBytes =
      WindowExtents<kAtOnce, Radius>::kBytes + 2 * sizeof(float);  // of a column

  // `count`: of columns in all rows.
  __device__ SmoothInverseDepth(SharedArrays& arrays, int count, const float* inverse,
                                const float* /*depth*/)
      : inverse_(inverse),
        extents_(arrays, count),
        s_(arrays.take<float>(count)),
        vs_(arrays.take<float>(count)) {}

  struct Columns {
    typename WindowExtents<kAtOnce, Radius>::Down extents;
    Pack<float, kAtOnce> s, vs;
  };
  // Down the columns about the image's row at `from`.
  __device__ __forceinline__ Columns sum_columns(int from, int pitch, int radius) const {
    Pack<float, kAtOnce> s = pack_at<kAtOnce>(inverse_ + from), vs{};
    typename WindowExtents<kAtOnce, Radius>::Down extents(s);
#pragma unroll
    for (int d = 1; d <= radius; ++d) {
      const Pack<float, kAtOnce> below = pack_at<kAtOnce>(inverse_ + from + d * pitch),
                                 above = pack_at<kAtOnce>(inverse_ + from - d * pitch);
#pragma unroll
      for (int p = 0; p < kAtOnce; ++p) {
        add_rows(below.of[p], above.of[p], static_cast<float>(d), s.of[p], vs.of[p]);
        extents.take(p, below.of[p], above.of[p]);
      }
    }
    return {extents, s, vs};
  }
  __device__ __forceinline__ void put(const Columns& columns, int at) const {
    extents_.put(columns.extents, at);
    put_pack(columns.s, s_ + at);
    put_pack(columns.vs, vs_ + at);
  }

  // Which windows of the columns `at` and beside it are smooth.
  __device__ __forceinline__ unsigned smooth(int at, int radius,
                                             const Pack<float, kAtOnce>& centres,
                                             const EdgeGate& edges) const {
    return extents_.smooth(at, radius, centres, edges);
  }
  // Normals, should they be. (x, y): the first pixel.
  __device__ __forceinline__ void normals(const CloudRecipe& recipe, int at, int radius,
                                          const Pack<float, kAtOnce>& centres, const Rays& rays,
                                          int x, int y, Vec3f (&normals)[kAtOnce]) const {
    const RowValues<float, kAtOnce, Radius> of_s(s_ + at, radius), of_vs(vs_ + at, radius);
    const Pack<float, kAtOnce> du_axis = pack_at<kAtOnce>(&rays.x(x));
    const float dv_axis = rays.y(y);
    const Intrinsics& k = recipe.camera.intrinsics;
    const auto fx = static_cast<float>(k.fx), fy = static_cast<float>(k.fy);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      float s = of_s.at(p), us = 0, vs = of_vs.at(p);
#pragma unroll
      for (int d = 1; d <= radius; ++d)
        add_columns(of_s.at(p + d), of_s.at(p - d), of_vs.at(p + d), of_vs.at(p - d),
                    static_cast<float>(d), s, us, vs);
      normals[p] = normal_of_plane<float>(recipe.whole.plane(s, us, vs, centres.of[p]), fx, fy,
                                          du_axis.of[p], dv_axis);
    }
  }

 private:
  const float* inverse_;
  WindowExtents<kAtOnce, Radius> extents_;
  float *s_, *vs_;
};

template <int TheAtOnce, int Radius>
class SmoothPca {
 public:
  static constexpr int kAtOnce = TheAtOnce, kRadius = Radius;
  static constexpr int kThreads = 128, kBlocks = 6;  // more leave doubles too few registers
  static constexpr int kRows = Radius > 0 ? 2 : 1;  // doubles and squares of most pixels serve both
  static constexpr bool kNeedsDepth = true;
  using Rays = UnitRays;
  static constexpr std::size_t kBytes = WindowExtents<kAtOnce, Radius>::kBytes + 5 * sizeof(double);

  __device__ SmoothPca(SharedArrays& arrays, int count, const float* inverse, const float* depth)
      : inverse_(inverse),
        depth_(depth),
        z_(arrays.take<double>(count)),
        vz_(arrays.take<double>(count)),
        z2_(arrays.take<double>(count)),
        vz2_(arrays.take<double>(count)),
        vvz2_(arrays.take<double>(count)),
        extents_(arrays, count) {}

  struct Columns {
    typename WindowExtents<kAtOnce, Radius>::Down extents;
    Pack<double, kAtOnce> z, vz, z2, vz2, vvz2;
  };
  __device__ __forceinline__ Columns sum_columns(int from, int pitch, int radius) const {
    typename WindowExtents<kAtOnce, Radius>::Down extents(pack_at<kAtOnce>(inverse_ + from));
    const Pack<float, kAtOnce> middle = pack_at<kAtOnce>(depth_ + from);
    Pack<double, kAtOnce> z, vz{}, z2, vz2{}, vvz2{};
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      z.of[p] = middle.of[p];
      z2.of[p] = z.of[p] * z.of[p];
    }
#pragma unroll
    for (int d = 1; d <= radius; ++d) {
      const int b = from + d * pitch, a = from - d * pitch;
      const Pack<float, kAtOnce> below = pack_at<kAtOnce>(depth_ + b),
                                 above = pack_at<kAtOnce>(depth_ + a);
      const Pack<float, kAtOnce> below_inverse = pack_at<kAtOnce>(inverse_ + b),
                                 above_inverse = pack_at<kAtOnce>(inverse_ + a);
      const double distance = d;
#pragma unroll
      for (int p = 0; p < kAtOnce; ++p) {
        add_depth_rows<double>(below.of[p], above.of[p], distance, z.of[p], vz.of[p]);
        add_square_rows<double>(below.of[p], above.of[p], distance, z2.of[p], vz2.of[p],
                                vvz2.of[p]);
        extents.take(p, below_inverse.of[p], above_inverse.of[p]);
      }
    }
    return {extents, z, vz, z2, vz2, vvz2};
  }
  __device__ __forceinline__ void put(const Columns& columns, int at) const {
    extents_.put(columns.extents, at);
    put_pack(columns.z, z_ + at), put_pack(columns.vz, vz_ + at), put_pack(columns.z2, z2_ + at);
    put_pack(columns.vz2, vz2_ + at), put_pack(columns.vvz2, vvz2_ + at);
  }

  __device__ __forceinline__ unsigned smooth(int at, int radius,
                                             const Pack<float, kAtOnce>& centres,
                                             const EdgeGate& edges) const {
    return extents_.smooth(at, radius, centres, edges);
  }
  __device__ __forceinline__ void normals(const CloudRecipe& recipe, int at, int radius,
                                          const Pack<float, kAtOnce>& /*centres*/, const Rays& rays,
                                          int x, int y, Vec3f (&normals)[kAtOnce]) const {
    Moments moments[kAtOnce];
    add_depths(at, radius, moments);
    add_squares(at, radius, moments);
    add_tilted(at, radius, moments);
    const int side = 2 * radius + 1;
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      moments[p].n = side * side;
      normals[p] = normal_of_moments(moments[p], 1.0 / (side * side), recipe.per_fx, recipe.per_fy,
                                     rays.x(x + p), rays.y(y));
    }
  }

 private:
  using Row = RowValues<double, kAtOnce, Radius>;

  __device__ __forceinline__ void add_depths(int at, int radius, Moments* moments) const {
    const Row z(z_ + at, radius), vz(vz_ + at, radius);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      Moments& m = moments[p];
      m.z = z.at(p), m.y = vz.at(p);
#pragma unroll
      for (int d = 1; d <= radius; ++d)
        add_depth_columns(z.at(p + d), z.at(p - d), vz.at(p + d), vz.at(p - d), double(d), m.x, m.y,
                          m.z);
    }
  }
  __device__ __forceinline__ void add_squares(int at, int radius, Moments* moments) const {
    const Row z2(z2_ + at, radius);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      Moments& m = moments[p];
      m.zz = z2.at(p);
#pragma unroll
      for (int d = 1; d <= radius; ++d)
        add_square_columns(z2.at(p + d), z2.at(p - d), double(d), m.xx, m.xz, m.zz);
    }
  }
  __device__ __forceinline__ void add_tilted(int at, int radius, Moments* moments) const {
    const Row vz2(vz2_ + at, radius), vvz2(vvz2_ + at, radius);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      Moments& m = moments[p];
      m.yz = vz2.at(p), m.yy = vvz2.at(p);
#pragma unroll
      for (int d = 1; d <= radius; ++d)
        add_tilted_columns(vz2.at(p + d), vz2.at(p - d), vvz2.at(p + d), vvz2.at(p - d), double(d),
                           m.xy, m.yz, m.yy);
    }
  }

  const float *inverse_, *depth_;
  double *z_, *vz_, *z2_, *vz2_, *vvz2_;
  WindowExtents<kAtOnce, Radius> extents_;
};

}  // namespace vpm::cuda
