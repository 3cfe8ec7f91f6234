// Windows that are measured as far as the image goes and cross no edge: sums over all their pixels,
// down each column and then across, in the order of libvpm/cloud/normal_rows_*.cpp. A thread takes
// kAtOnce pixels side by side, whose windows share most of what they read; kAtOnce and Radius are
// known beforehand, or the radius is at run time only: Radius is 0 and kAtOnce 1 then.
//
// The columns lie in a block's shared memory beside the image, row by row with the same pitch, so
// that one index serves for both. Rows begin where kAtOnce values lie together.
#pragma once

#include "libvpm/cloud/covariance_fit.h"
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

// Those at `values`, should they be there.
template <int kCount>
__device__ __forceinline__ Pack<float, kCount> pack_or(bool is_there, const float* values,
                                                       const Pack<float, kCount>& other) {
  Pack<float, kCount> pack = pack_at<kCount>(values);
#pragma unroll
  for (int p = 0; p < kCount; ++p) pack.of[p] = is_there ? pack.of[p] : other.of[p];
  return pack;
}

// Calls body(below, above, d) for each pair of rows as far from the one at `row`; what stands there
// beyond the image is `middle`, which that has.
template <int kCount, class Down, class Body>
__device__ __forceinline__ void for_rows(const float* row, int pitch, const Down& down, int radius,
                                         const Pack<float, kCount>& middle, const Body& body) {
#pragma unroll
  for (int d = 1; d <= radius; ++d)
    body(pack_or(down.has(d), row + d * pitch, middle),
         pack_or(down.has(-d), row - d * pitch, middle), d);
}

// The least, or the greatest, value of each pixel's window: pick(a, b, c) chooses.
template <int kAtOnce, class Row, class Pick, class Integer>
__device__ __forceinline__ void pick_in_windows(const Row& row, const Pick& pick,
                                                Integer (&picked)[kAtOnce]) {
  const int radius = row.radius();
  Integer common = row.at(kAtOnce - 1 - radius);
#pragma unroll
  for (int i = kAtOnce - radius; i <= radius; i += 2)
    common = pick(common, row.at(i), row.at(i < radius ? i + 1 : i));
  Integer left = common, right = common;
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
    __device__ unsigned operator()(unsigned a, unsigned b, unsigned c) const {
      return __vimin3_u32(a, b, c);
    }
  };
  struct Greatest {
    __device__ int operator()(int a, int b, int c) const { return __vimax3_s32(a, b, c); }
  };

 public:
  __device__ WindowExtents(SharedArrays& arrays, int count)
      : low_(arrays.take<unsigned>(count)), high_(arrays.take<int>(count)) {}
  static constexpr std::size_t kBytes = sizeof(unsigned) + sizeof(int);  // of a column

  struct Columns {
    Pack<unsigned, kAtOnce> low;
    Pack<int, kAtOnce> high;
  };
  // Down kAtOnce columns about the image's row at `middle`.
  __device__ __forceinline__ static Columns of_columns(const float* middle, int pitch, int radius) {
    Columns columns;
    const Pack<float, kAtOnce> values = pack_at<kAtOnce>(middle);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      const Extent extent(values.of[p]);
      columns.low.of[p] = extent.low, columns.high.of[p] = extent.high;
    }
#pragma unroll
    for (int d = 1; d <= radius; ++d) {
      const Pack<float, kAtOnce> below = pack_at<kAtOnce>(middle + d * pitch),
                                 above = pack_at<kAtOnce>(middle - d * pitch);
#pragma unroll
      for (int p = 0; p < kAtOnce; ++p) {
        Extent extent(columns.low.of[p], columns.high.of[p]);
        extent.take(Extent(below.of[p]), Extent(above.of[p]));
        columns.low.of[p] = extent.low, columns.high.of[p] = extent.high;
      }
    }
    return columns;
  }
  __device__ __forceinline__ void put(const Columns& columns, int at) const {
    put_pack(columns.low, low_ + at);
    put_pack(columns.high, high_ + at);
  }

  // Which of the pixels have a smooth window, a bit for each; kInFloats: whose squares floats hold.
  // `centres`: their inverse depths.
  template <bool kInFloats>
  __device__ __forceinline__ unsigned smooth(int at, int radius,
                                             const Pack<float, kAtOnce>& centres,
                                             const EdgeGate& edges) const {
    unsigned low[kAtOnce];
    int high[kAtOnce];
    pick_in_windows(RowValues<unsigned, kAtOnce, Radius>(low_ + at, radius), Least(), low);
    pick_in_windows(RowValues<int, kAtOnce, Radius>(high_ + at, radius), Greatest(), high);
    unsigned smooth = 0;
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      const Extent extent(low[p], high[p]);
      const bool is_smooth =
          extent.is_smooth(centres.of[p], edges) && (!kInFloats || extent.is_in_floats(edges));
      smooth |= (is_smooth ? 1U : 0U) << p;
    }
    return smooth;
  }

 private:
  unsigned* low_;
  int* high_;
};

// Of a tile's columns and rows of pixels.
class TileRays {
 public:
  __device__ TileRays(SharedArrays& arrays, int width, int height)
      : x_(arrays.take<float>(width)), y_(arrays.take<float>(height)) {}
  static constexpr std::size_t kBytes = sizeof(float);  // of a column or row

  __device__ const float& x(int column) const { return x_[column]; }
  __device__ float y(int row) const { return y_[row]; }

 protected:
  float *x_, *y_;
};
// Of each, the ray at depth 1.
class UnitRays : public TileRays {
 public:
  using TileRays::TileRays;
  __device__ void set_column(int i, int u, const Intrinsics& k) const {
    x_[i] = static_cast<float>((u - k.cx) / k.fx);
  }
  __device__ void set_row(int i, int v, const Intrinsics& k) const {
    y_[i] = static_cast<float>((v - k.cy) / k.fy);
  }
};
// Of each, how far the camera's axis is, in pixels.
class PixelsToAxis : public TileRays {
 public:
  using TileRays::TileRays;
  __device__ void set_column(int i, int u, const Intrinsics& k) const {
    x_[i] = static_cast<float>(k.cx - u);
  }
  __device__ void set_row(int i, int v, const Intrinsics& k) const {
    y_[i] = static_cast<float>(k.cy - v);
  }
};

// Windows of kAtOnce pixels side by side: what the image has of them. The tile's windows are whole
// ...
struct WholeWindows {
  static constexpr bool kMayBeCut = false;
  int radius;

  __device__ WholeSpan across(int /*p*/) const { return {radius}; }
  __device__ WholeSpan down() const { return {radius}; }
};
// ... or the image's border cuts some of them.
template <int kAtOnce>
struct CutWindows {
  static constexpr bool kMayBeCut = true;
  Span spans[kAtOnce], upright;

  __device__ Span across(int p) const { return spans[p]; }
  __device__ Span down() const { return upright; }
  __device__ WindowShape shape(int p) const { return {spans[p], upright}; }
  // A bit for each.
  __device__ unsigned that_tell_planes() const {
    unsigned windows = 0;
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) windows |= (tells_plane(spans[p], upright) ? 1U : 0U) << p;
    return windows;
  }
};

// Of a tile that has the image's inverse depth at `inverse`, each with what normals need of it.
template <int TheAtOnce, int Radius>
class SmoothInverseDepth {
 public:
  static constexpr int kAtOnce = TheAtOnce, kRadius = Radius;
  static constexpr int kThreads = 128, kBlocks = 10;  // of a multiprocessor
  static constexpr bool kNeedsDepth = false, kInFloats = false;
  using Rays = PixelsToAxis;
  static constexpr std::size_t kBytes = 2 * sizeof(float);  // of a column

  // `count`: of columns in all rows.
  __device__ SmoothInverseDepth(SharedArrays& arrays, int count, const float* inverse,
                                const float* /*depth*/)
      : inverse_(inverse), s_(arrays.take<float>(count)), vs_(arrays.take<float>(count)) {}

  // Down kAtOnce columns about the image's row at `from`.
  template <class Down>
  __device__ __forceinline__ void sum_columns(int from, int pitch, const Down& down, int radius,
                                              int at) const {
    const Pack<float, kAtOnce> middle = pack_at<kAtOnce>(inverse_ + from);
    PlaneRows<float> rows[kAtOnce];
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) rows[p].centre = middle.of[p];
    for_rows(inverse_ + from, pitch, down, radius, middle,
             [&](const auto& below, const auto& above, int d) {
#pragma unroll
               for (int p = 0; p < kAtOnce; ++p)
                 rows[p].add(below.of[p], above.of[p], static_cast<float>(d));
             });
    Pack<float, kAtOnce> s, vs;
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      const PlaneColumn<float> column = rows[p].sums(down);
      s.of[p] = column.s, vs.of[p] = column.vs;
    }
    put_pack(s, s_ + at), put_pack(vs, vs_ + at);
  }

  // Normals of windows that are smooth. (x, y): the first pixel.
  template <class Windows>
  __device__ __forceinline__ void normals(const CloudRecipe& recipe, int at, int /*pitch*/,
                                          int radius, const Pack<float, kAtOnce>& centres,
                                          const Rays& rays, int x, int y, const Windows& windows,
                                          Vec3f (&normals)[kAtOnce]) const {
    const RowValues<float, kAtOnce, Radius> s(s_ + at, radius), vs(vs_ + at, radius);
    PlaneWindow<float> sums[kAtOnce];
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p)
      sums[p] = vpm::sum_columns<float>(windows.across(p), radius, [&](int du) {
        return PlaneColumn<float>{s.at(p + du), vs.at(p + du)};
      });
    const Pack<float, kAtOnce> du_axis = pack_at<kAtOnce>(&rays.x(x));
    const float dv_axis = rays.y(y);
    const Intrinsics& k = recipe.camera.intrinsics;
    const auto fx = static_cast<float>(k.fx), fy = static_cast<float>(k.fy);
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      if constexpr (Windows::kMayBeCut) {
        const WindowShape shape = windows.shape(p);
        normals[p] = normal_of_smooth_window(shape, plane_of_sums(shape, sums[p], centres.of[p]),
                                             fx, fy, du_axis.of[p], dv_axis);
      } else {
        normals[p] = normal_of_plane(plane_of_sums(recipe.whole, sums[p], centres.of[p]), fx, fy,
                                     du_axis.of[p], dv_axis);
      }
    }
  }

 private:
  const float* inverse_;
  float *s_, *vs_;
};

template <int TheAtOnce, int Radius>
class SmoothPca {
 public:
  static constexpr int kAtOnce = TheAtOnce, kRadius = Radius;
  static constexpr int kThreads = 128, kBlocks = 5;  // more leave too few registers
  static constexpr bool kNeedsDepth = true, kInFloats = true;
  using Rays = UnitRays;
  static constexpr std::size_t kBytes = 5 * sizeof(float);

  __device__ SmoothPca(SharedArrays& arrays, int count, const float* inverse, const float* depth)
      : inverse_(inverse),
        depth_(depth),
        w_(arrays.take<float>(count)),
        vw_(arrays.take<float>(count)),
        w2_(arrays.take<float>(count)),
        vw2_(arrays.take<float>(count)),
        vvz2_(arrays.take<float>(count)) {}

  template <class Down>
  __device__ __forceinline__ void sum_columns(int from, int pitch, const Down& down, int radius,
                                              int at) const {
    const Pack<float, kAtOnce> middle = pack_at<kAtOnce>(depth_ + from);
    OffsetRows<float> rows[kAtOnce];
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) rows[p].reference = middle.of[p];
    for_rows(depth_ + from, pitch, down, radius, middle,
             [&](const auto& below, const auto& above, int d) {
#pragma unroll
               for (int p = 0; p < kAtOnce; ++p)
                 rows[p].add(below.of[p], above.of[p], down.has(d), down.has(-d),
                             static_cast<float>(d));
             });
    Pack<float, kAtOnce> w, vw, w2, vw2, vvz2;
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      const ColumnOffsets<float>& sums = rows[p].sums;
      w.of[p] = sums.w, vw.of[p] = sums.vw, w2.of[p] = sums.w2;
      vw2.of[p] = sums.vw2, vvz2.of[p] = sums.vvz2;
    }
    put_pack(w, w_ + at), put_pack(vw, vw_ + at), put_pack(w2, w2_ + at);
    put_pack(vw2, vw2_ + at), put_pack(vvz2, vvz2_ + at);
  }

  template <class Windows>
  __device__ __forceinline__ void normals(const CloudRecipe& recipe, int at, int pitch, int radius,
                                          const Pack<float, kAtOnce>& centres, const Rays& rays,
                                          int x, int y, const Windows& windows,
                                          Vec3f (&normals)[kAtOnce]) const {
    const Row z(depth_ + at + radius * pitch, radius), w(w_ + at, radius), vw(vw_ + at, radius),
        w2(w2_ + at, radius), vw2(vw2_ + at, radius), vvz2(vvz2_ + at, radius);
    const Pack<float, kAtOnce> rx = pack_at<kAtOnce>(&rays.x(x));
    const float ry = rays.y(y);
    // All pixels have the same reference, or one of them has it beside: tiles begin at even ones.
    const int side = kAtOnce == 1 ? reference_of(x) - x : 0;
    const float reference = depth_[at + radius * pitch + side];
    const float inverse = kAtOnce == 1 ? inverse_[at + radius * pitch + side] : centres.of[0];
    const auto column = [&](int i) {
      const ColumnOffsets<float> own{w.at(i), vw.at(i), w2.at(i), vw2.at(i), vvz2.at(i)};
      return about_reference(own, z.at(i) - reference, windows.down());
    };
    Symmetric3<float> covariances[kAtOnce];
#pragma unroll
    for (int p = 0; p < kAtOnce; ++p) {
      const WindowOffsets<float> sums = sum_offset_columns<float>(
          windows.across(p), radius, [&](int du) { return column(p + du); });
      const auto covariance_of = [&](const WindowShape& shape) {
        return covariance_of_offsets(sums, inverse, shape, recipe.scale, rx.of[p], ry);
      };
      if constexpr (Windows::kMayBeCut)
        covariances[p] = covariance_of(windows.shape(p));
      else
        covariances[p] = covariance_of(recipe.whole);
    }
    find_normals_of<kAtOnce>([&](int p) { return covariances[p]; }, rx.of, ry,
                             [&](int p, const Vec3f& normal) { normals[p] = normal; });
  }

 private:
  using Row = RowValues<float, kAtOnce, Radius>;

  const float *inverse_, *depth_;
  float *w_, *vw_, *w2_, *vw2_, *vvz2_;
};

}  // namespace vpm::cuda
