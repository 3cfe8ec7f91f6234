// Fits the plane of those pixels of a window that belong to the surface of its centre, with the
// sums of GatedWindows (libvpm/cloud/normal_window.h) in the same order.
#pragma once

#include "libvpm/scene/cuda/tile_around.h"

namespace vpm::cuda {

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
  // Gives the first bits of the sums of dv^2 and of dv; the latter is signed and comes last.
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

}  // namespace vpm::cuda
