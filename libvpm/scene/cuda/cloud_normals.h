// Estimates the normals of a tile of a depth image, with the sums of libvpm/cloud/normal_rows_*.cpp
// and normal_window.cpp in the same order: a thread for each column, then for each pixel. Windows
// that are not smooth are fitted by those of their pixels that belong to the surface of the centre.
#pragma once

#include "libvpm/cloud/normal_window.h"
#include "libvpm/scene/cuda/cloud_tile.h"

namespace vpm::cuda {

// Return the stored inverse depth of a pixel that is not measured, a NaN with the greatest integer
// as bits, so that it lies within no gate; of one that was removed, which is no hole to be closed,
// a NaN with the next integer; and of a pixel beyond the image, as on the host (kBeyondImage).
__device__ __forceinline__ float unmeasured() {
  return __int_as_float(0x7fffffff);
}
__device__ __forceinline__ float removed() {
  return __int_as_float(0x7ffffffe);
}
__device__ __forceinline__ float beyond_image() {
  return __int_as_float(-1);
}
// Returns `inverse`, or unmeasured() for 0 and removed() for -0.
__device__ __forceinline__ float measured_or_none(float inverse) {
  return inverse != 0 ? inverse : __float_as_int(inverse) == 0 ? unmeasured() : removed();
}
__device__ __forceinline__ bool is_removed_pixel(float stored) {
  return __float_as_int(stored) == __float_as_int(removed());
}

// Holds least and greatest inverse depth of some pixels as integers, which order like floats that
// are not negative. `high` is a NaN if a pixel is not measured; pixels beyond the image change
// nothing.
struct Extent {
  unsigned low;
  int high;

  __device__ __forceinline__ explicit Extent(float value) {
    low = __float_as_uint(value), high = __float_as_int(value);
  }
  __device__ __forceinline__ Extent(unsigned least, int greatest) : low(least), high(greatest) {}
  __device__ __forceinline__ void take(Extent a, Extent b) {
    low = __vimin3_u32(low, a.low, b.low), high = __vimax3_s32(high, a.high, b.high);
  }
  // True if a window is measured everywhere and has no edge.
  __device__ __forceinline__ bool is_smooth(float centre, const EdgeGate& edges) const {
    return __uint_as_float(low) >= edges.lowest * centre &&
           __int_as_float(high) <= edges.highest * centre;
  }
  // True if floats can hold the squares of the window's depths.
  __device__ __forceinline__ bool is_in_floats(const EdgeGate& edges) const {
    return __uint_as_float(low) >= edges.least && __int_as_float(high) <= edges.greatest;
  }
};

// Accesses a tile in a block's shared memory about one of its pixels.
class TileAround {
 public:
  __device__ TileAround(const float* centre, int pitch) : centre_(centre), pitch_(pitch) {}
  __device__ __forceinline__ float at(int du, int dv) const { return centre_[dv * pitch_ + du]; }

 private:
  const float* centre_;
  int pitch_;
};

// Sums over the kept pixels of a column: their number, dv, dv^2, the difference, and dv times it.
// The integers are exact in any order and share a word.
class KeptColumn {
 public:
  __device__ __forceinline__ void add(float difference, int dv) {
    counts_ += (dv << kFirst) + (dv * dv << kSecond) + 1;
    e_ += difference, ye_ += static_cast<float>(dv) * difference;
  }
  __device__ int pixels() const { return counts_ & ((1 << kSecond) - 1); }
  __device__ int y() const { return counts_ >> kFirst; }
  __device__ int yy() const { return counts_ >> kSecond & ((1 << (kFirst - kSecond)) - 1); }
  __device__ float e() const { return e_; }
  __device__ float ye() const { return ye_; }

 private:
  // First bits of the sums of dv^2 and of dv; the latter is signed and comes last.
  static constexpr int kSecond = 8, kFirst = 20, kMostAway = kMaxWindow / 2;
  static_assert(kMaxWindow < 1 << kSecond);
  static_assert(kMostAway * (kMostAway + 1) * (2 * kMostAway + 1) / 3 < 1 << (kFirst - kSecond));
  static_assert(kMostAway * (kMostAway + 1) / 2 < 1 << (31 - kFirst));

  int counts_ = 0;
  float e_ = 0, ye_ = 0;
};

// Sums over the kept pixels of a window: float sums of the difference in a fixed order, and integer
// sums, with the number of columns that have an edge, in any order.
struct KeptDifferences {
  float e = 0, ue = 0, ve = 0;
  __device__ KeptDifferences operator+(const KeptDifferences& b) const {
    return {e + b.e, ue + b.ue, ve + b.ve};
  }
};
struct KeptCounts {
  int n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, edges = 0;
  __device__ KeptCounts operator+(const KeptCounts& b) const {
    return {n + b.n, u + b.u, v + b.v, uu + b.uu, uv + b.uv, vv + b.vv, edges + b.edges};
  }
};

// Holds the rule by which a window last kept pixels: those no further from a plane than the gate.
struct LastChoice {
  WindowPlane near;
  float gate = HUGE_VALF;
};

// Adds eight of a window's columns, column(0) to column(7), in the order of fold() in
// libvpm/cloud/plane_fit.h.
template <class Column>
__device__ __forceinline__ auto fold(const Column& column) {
  // Adds every second column.
  const auto half = [&](int first) {
    const auto one = column(first) + column(first + 4);
    return one + (column(first + 2) + column(first + 6));
  };
  decltype(half(0)) both;
#pragma unroll 1  // half the code for few windows
  for (int k = 0; k < 2; ++k) {
    const auto one = half(k);
    both = k == 0 ? one : both + one;
  }
  return both;
}

// Works on windows of this `Radius`, 0 if it is known at run time only.
template <int Radius>
class GatedWindow {
 public:
  __device__ __forceinline__ GatedWindow(const TileAround& image, int radius, const EdgeGate& edges)
      : image_(image),
        radius_(radius),
        edges_(edges),
        middle_(image.at(0, 0)),
        unit_(reciprocal(middle_)) {}

  // Returns the plane of the window's surface: fits the pixels that the steepest surface could
  // reach, and if some are beyond the edge gate of the centre, fits again those near that plane.
  __device__ __forceinline__ WindowPlane fit(LastChoice& last) const {
    bool has_edge, unused;
    const WindowPlane first = choose<true>({}, has_edge);
    last = {};
    if (!has_edge || !first.found) return first;
    last = {first, edges_.gate};
    return choose<false>(first, unused);
  }

  // Returns the moments of the kept pixels' depths. `depths` must have the same centre.
  __device__ __forceinline__ Moments moments(const LastChoice& last,
                                             const TileAround& depths) const {
    Moments m;
#pragma unroll 1
    for (int first = -radius(); first <= radius(); first += kFoldedColumns)
      m = m + fold([&](int k) { return moments_of_column(last, first + k, depths); });
    return m;
  }

 private:
  __device__ __forceinline__ int radius() const {
    return Radius > 0 ? Radius : radius_;
  }

  template <bool kFirst>
  __device__ __forceinline__ WindowPlane choose(const WindowPlane& near, bool& has_edge) const {
    KeptDifferences sums;
    KeptCounts counts;
    for (int first = -radius(); first <= radius(); first += kFoldedColumns)
      sums = sums + fold([&](int k) { return sum_column<kFirst>(first + k, near, counts); });
    has_edge = counts.edges != 0;
    const auto exact = [](int count) { return static_cast<float>(count); };
    return fit_plane<float>({exact(counts.n), exact(counts.u), exact(counts.v), exact(counts.uu),
                             exact(counts.uv), exact(counts.vv), sums.e, sums.ue, sums.ve});
  }

  // Sums a column; a column beyond the window adds 0.
  template <bool kFirst>
  __device__ __forceinline__ KeptDifferences sum_column(int du, const WindowPlane& near,
                                                        KeptCounts& counts) const {
    if (du > radius()) return {};
    const float x = static_cast<float>(du), predicted = near.c + near.a * x;
    const float gate = edges_.gate, along = gate + edges_.slope * std::fabs(x);
    bool has_edge = false;
    KeptColumn kept;
#pragma unroll
    for (int dv = -radius(); dv <= radius(); ++dv) {
      const float difference = difference_at(du, dv), y = static_cast<float>(dv);
      if constexpr (kFirst) {
        has_edge |= std::fabs(difference) > gate;
        // Uses the greater distance: rounding keeps the order.
        const float allowed = fmaxf(along, gate + edges_.slope * std::fabs(y));
        if (std::fabs(difference) <= allowed) kept.add(difference, dv);
      } else {
        if (std::fabs(difference - (predicted + near.b * y)) <= gate) kept.add(difference, dv);
      }
    }
    const int n = kept.pixels();
    counts = counts + KeptCounts{n,         du * n,          kept.y(), du * du * n, du * kept.y(),
                                 kept.yy(), has_edge ? 1 : 0};
    return {kept.e(), x * kept.e(), kept.ye()};
  }
  __device__ __forceinline__ Moments moments_of_column(const LastChoice& last, int du,
                                                       const TileAround& depths) const {
    KeptDepths<double> column;
    int kept = 0;
    if (du <= radius()) {
#pragma unroll
      for (int dv = -radius(); dv <= radius(); ++dv) {
        const bool is_kept = keeps(last, du, dv);
        kept += is_kept ? 1 : 0;
        add_depth<double>(column, is_kept ? depths.at(du, dv) : 0.0F, dv);
      }
    }
    column.n = kept;
    return vpm::moments_of_column(column, du);
  }
  __device__ __forceinline__ bool keeps(const LastChoice& last, int du, int dv) const {
    const WindowPlane& near = last.near;
    const float expected =
        near.c + near.a * static_cast<float>(du) + near.b * static_cast<float>(dv);
    return std::fabs(difference_at(du, dv) - expected) <= last.gate;
  }
  // Returns NaN where nothing is measured.
  __device__ __forceinline__ float difference_at(int du, int dv) const {
    return (image_.at(du, dv) - middle_) * unit_;
  }

  TileAround image_;
  int radius_;
  const EdgeGate& edges_;
  float middle_, unit_;
};

// Describes a block's tile while normals are estimated.
template <class Frame>
struct TileImage {
  Frame frame;
  const float *inverse, *depth;  // with the margin; depth only if kNeedsDepth
  const double *ray_x, *ray_y;   // per column and per row of the tile

  __device__ TileAround inverse_around(int x, int y) const {
    return {inverse + frame.index(x, y), frame.pitch()};
  }
  __device__ TileAround depth_around(int x, int y) const {
    return {depth + frame.index(x, y), frame.pitch()};
  }
  // Return the part of the windows about a column, and about a row, that lies in the image.
  template <bool kMayBeCut>
  __device__ auto across(int x) const {
    return span<kMayBeCut>(frame.u0 + x, frame.width);
  }
  template <bool kMayBeCut>
  __device__ auto down(int y) const {
    return span<kMayBeCut>(frame.v0 + y, frame.height);
  }
  // True if a pixel's window determines a plane, should it be smooth. `shape` is that of a whole
  // window and becomes that of this one.
  template <bool kMayBeCut>
  __device__ __forceinline__ bool tells_plane(int x, int y, WindowShape& shape) const {
    if constexpr (kMayBeCut) {
      const Span along = across<true>(x), upright = down<true>(y);
      if (!vpm::tells_plane(along, upright)) return false;
      shape = WindowShape(along, upright);
    }
    return true;
  }

 private:
  template <bool kMayBeCut>
  __device__ auto span(int at, int size) const {
    if constexpr (kMayBeCut)
      return span_of(at, size, frame.radius());
    else
      return WholeSpan{frame.radius()};
  }
};

// Return the extent of inverse depth in a column, and in a window, about the middle.
__device__ __forceinline__ Extent extent_of_column(const TileAround& inverse, int radius) {
  Extent extent(inverse.at(0, 0));
#pragma unroll
  for (int d = 1; d <= radius; ++d)
    extent.take(Extent(inverse.at(0, d)), Extent(inverse.at(0, -d)));
  return extent;
}
template <class Column>
__device__ __forceinline__ Extent extent_of_window(const Column* column, int radius) {
  Extent extent = column->extent;
#pragma unroll
  for (int d = 1; d <= radius; ++d) extent.take(column[d].extent, column[-d].extent);
  return extent;
}

// Estimates normals from inverse depth. Like PcaNormals it provides what is kept of a column, the
// sums down a column, and the normals of smooth windows and of gated ones.
template <class Tile>
class InverseDepthNormals {
 public:
  using Frame = Tile;
  static constexpr bool kNeedsDepth = false;
  static constexpr int kMostBlocks = 5;  // per multiprocessor
  struct alignas(16) Column {
    PlaneColumn<float> sums;
    Extent extent;
  };

  __device__ __forceinline__ InverseDepthNormals(const CloudRecipe& recipe,
                                                 const TileImage<Frame>& image)
      : recipe_(recipe), image_(image) {}

  // Sums down column x (from -radius on) about row y.
  template <bool kMayBeCut>
  __device__ __forceinline__ Column sum_column(int x, int y) const {
    const TileAround inverse = image_.inverse_around(x, y);
    return {sum_rows<float>(image_.template down<kMayBeCut>(y), radius(),
                            [&](int dv) { return inverse.at(0, dv); }),
            extent_of_column(inverse, radius())};
  }

  // Computes the normal of a pixel from its `column` and those beside it. False if its window is
  // not smooth.
  template <bool kMayBeCut>
  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    const float centre = image_.inverse_around(x, y).at(0, 0);
    if (!extent_of_window(column, radius()).is_smooth(centre, recipe_.edges)) return false;
    WindowShape shape = recipe_.whole;
    if (!image_.template tells_plane<kMayBeCut>(x, y, shape)) return false;
    const PlaneWindow<float> sums = sum_columns<float>(
        image_.template across<kMayBeCut>(x), radius(), [&](int du) { return column[du].sums; });
    normal = normal_of_smooth_window(shape, plane_of_sums(shape, sums, centre), fx(), fy(),
                                     du_axis(x), dv_axis(y));
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const GatedWindow<Frame::kRadius> window(image_.inverse_around(x, y), radius(), recipe_.edges);
    LastChoice last;
    return normal_of_window(window.fit(last), fx(), fy(), du_axis(x), dv_axis(y));
  }

 private:
  __device__ int radius() const { return image_.frame.radius(); }
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
  static constexpr int kMostBlocks = 4;
  struct Column {
    ColumnOffsets<float> sums;
    Extent extent;
  };

  __device__ __forceinline__ PcaNormals(const CloudRecipe& recipe, const TileImage<Frame>& image)
      : recipe_(recipe), image_(image) {}

  template <bool kMayBeCut>
  __device__ __forceinline__ Column sum_column(int x, int y) const {
    const TileAround depth = image_.depth_around(x, y);
    return {sum_offset_rows<float>(image_.template down<kMayBeCut>(y), radius(),
                                   [&](int dv) { return depth.at(0, dv); }),
            extent_of_column(image_.inverse_around(x, y), radius())};
  }

  template <bool kMayBeCut>
  __device__ __forceinline__ bool smooth_normal(const Column* column, int x, int y,
                                                Vec3f& normal) const {
    const float inverse = image_.inverse_around(x, y).at(0, 0);
    const Extent extent = extent_of_window(column, radius());
    if (!extent.is_smooth(inverse, recipe_.edges) || !extent.is_in_floats(recipe_.edges))
      return false;
    WindowShape shape = recipe_.whole;
    if (!image_.template tells_plane<kMayBeCut>(x, y, shape)) return false;
    const TileAround depth = image_.depth_around(x, y);
    const int u = image_.frame.u0 + x, side = reference_of(u) - u;
    const float reference = depth.at(side, 0);
    const auto down = image_.template down<kMayBeCut>(y);
    const WindowOffsets<float> sums =
        sum_offset_columns<float>(image_.template across<kMayBeCut>(x), radius(), [&](int du) {
          return about_reference(column[du].sums, depth.at(du, 0) - reference, down);
        });
    const float rx = ray_x(x), ry = ray_y(y);
    normal =
        normal_of_covariance(covariance_of_offsets(sums, image_.inverse_around(x, y).at(side, 0),
                                                   shape, recipe_.scale, rx, ry),
                             rx, ry);
    return true;
  }

  __device__ __forceinline__ Vec3f gated_normal(int x, int y) const {
    const GatedWindow<Frame::kRadius> window(image_.inverse_around(x, y), radius(), recipe_.edges);
    LastChoice last;
    if (!window.fit(last).found) return {};
    const Moments m = window.moments(last, image_.depth_around(x, y));
    const float rx = ray_x(x), ry = ray_y(y);
    return normal_of_covariance(covariance_of_moments(m, recipe_.exact_scale, rx, ry), rx, ry);
  }

 private:
  __device__ int radius() const { return image_.frame.radius(); }
  __device__ __forceinline__ float ray_x(int x) const {
    return static_cast<float>(image_.ray_x[x]);
  }
  __device__ __forceinline__ float ray_y(int y) const {
    return static_cast<float>(image_.ray_y[y]);
  }

  const CloudRecipe& recipe_;
  TileImage<Frame> image_;
};

}  // namespace vpm::cuda
