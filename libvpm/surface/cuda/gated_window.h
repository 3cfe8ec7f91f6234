// The plane of those pixels of a window that belong to the surface of its centre, with the sums of
// GatedWindows (libvpm/cloud/normal_window.h) in the same order.
#pragma once

#include "libvpm/surface/cuda/tile_around.h"

namespace vpm::cuda {

// What a window keeps of a column: how many pixels, the sums of dv and dv^2 over them, and of the
// difference and dv times it. Counts are integers, exact in any order: they share a word.
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
  // Where the sums of dv^2 and of dv begin: that one has a sign, and is the last.
  static constexpr int kSecond = 8, kFirst = 20, kMostAway = kMaxWindow / 2;
  static_assert(kMaxWindow < 1 << kSecond);
  static_assert(kMostAway * (kMostAway + 1) * (2 * kMostAway + 1) / 3 < 1 << (kFirst - kSecond));
  static_assert(kMostAway * (kMostAway + 1) / 2 < 1 << (31 - kFirst));

  int counts_ = 0;
  float e_ = 0, ye_ = 0;
};

// Sums over the pixels that are kept: of those that are integers, and of the difference.
struct KeptCounts {
  int n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
};
struct KeptDifferences {
  float e = 0, ue = 0, ve = 0;
  friend __device__ KeptDifferences operator+(const KeptDifferences& a, const KeptDifferences& b) {
    return {a.e + b.e, a.ue + b.ue, a.ve + b.ve};
  }
};

// Which pixels a window's last choice has kept: those no further from a plane than the gate.
struct LastChoice {
  WindowPlane near;
  float gate = HUGE_VALF;
};

// Who adds up a window's columns, and then knows the sums: a lane, or two side by side that take
// half of the columns each, whole warps. (To choose at run time makes slower code of both.)
struct OneLane {
  template <class Half>
  __device__ __forceinline__ KeptDifferences add(const Half& half) const {
    KeptDifferences both;
#pragma unroll 1  // half as much code to read, where few windows share it
    for (int k = 0; k < 2; ++k) {
      const KeptDifferences one = half(k);
      both = k == 0 ? one : both + one;
    }
    return both;
  }
  __device__ int add(int own) const {
    return own;
  }
  __device__ bool any(bool own) const {
    return own;
  }
};
struct TwoLanes {
  template <class Half>
  __device__ __forceinline__ KeptDifferences add(const Half& half) const {
    const KeptDifferences own = half(static_cast<int>(threadIdx.x) % 2);
    return {own.e + other(own.e), own.ue + other(own.ue), own.ve + other(own.ve)};
  }
  __device__ int add(int own) const { return own + other(own); }
  __device__ bool any(bool own) const { return (int{own} | other(int{own})) != 0; }

 private:
  template <class T>
  __device__ static T other(T own) {
    return __shfl_xor_sync(~0U, own, 1);
  }
};

// `Radius`: 0 if it is known at run time only.
template <int Radius>
class GatedWindow {
 public:
  __device__ __forceinline__ GatedWindow(const TileAround& image, int radius, const EdgeGate& edges)
      : image_(image),
        radius_(radius),
        edges_(edges),
        middle_(image.at(0, 0)),
        unit_(reciprocal(middle_)) {}

  __device__ __forceinline__ WindowPlane fit(LastChoice& last) const {
    bool has_edge;
    const WindowPlane first = plane_of_sums(choose_first(OneLane(), has_edge));
    last = {};
    if (!has_edge || !first.found) return first;
    last = {first, edges_.gate};
    return plane_of_sums(choose_last(OneLane(), first));
  }
  // Sums over what the steepest surface could reach, and whether something is beyond the edge gate
  // of the centre.
  template <class Lanes>
  __device__ __forceinline__ PlaneSums choose_first(const Lanes& lanes, bool& has_edge) const {
    has_edge = false;
    const PlaneSums sums = choose<true>({}, lanes, has_edge);
    has_edge = lanes.any(has_edge);
    return sums;
  }
  // Over what lies near a plane.
  template <class Lanes>
  __device__ __forceinline__ PlaneSums choose_last(const Lanes& lanes,
                                                   const WindowPlane& near) const {
    bool has_edge = false;
    return choose<false>(near, lanes, has_edge);
  }

  // Of the depths about the same centre.
  __device__ __forceinline__ Moments moments(const LastChoice& last,
                                             const TileAround& depths) const {
    Moments m;
#pragma unroll 1
    for (int du = -radius(); du <= radius(); ++du) {
      KeptDepths<double> column;
      int kept = 0;
#pragma unroll
      for (int dv = -radius(); dv <= radius(); ++dv) {
        const bool is_kept = keeps(last, du, dv);
        kept += is_kept ? 1 : 0;
        add_depth<double>(column, is_kept ? depths.at(du, dv) : 0.0F, dv);
      }
      column.n = kept;
      add_kept(m, column, du);
    }
    return m;
  }

 private:
  static constexpr int kGroup = 8;  // columns are added pairwise, so many at a time

  __device__ __forceinline__ int radius() const {
    return Radius > 0 ? Radius : radius_;
  }

  template <bool kFirst, class Lanes>
  __device__ __forceinline__ PlaneSums choose(const WindowPlane& near, const Lanes& lanes,
                                              bool& has_edge) const {
    KeptCounts c;
    PlaneSums sums;
    for (int first = -radius(); first <= radius(); first += kGroup) {
      const KeptDifferences sum =
          lanes.add([&](int half) { return add_half<kFirst>(first + half, near, c, has_edge); });
      sums.e += sum.e, sums.ue += sum.ue, sums.ve += sum.ve;
    }
    sums.n = lanes.add(c.n), sums.u = lanes.add(c.u), sums.v = lanes.add(c.v);
    sums.uu = lanes.add(c.uu), sums.uv = lanes.add(c.uv), sums.vv = lanes.add(c.vv);
    return sums;
  }

  // Every second of eight columns.
  template <bool kFirst>
  __device__ __forceinline__ KeptDifferences add_half(int first, const WindowPlane& near,
                                                      KeptCounts& counts, bool& has_edge) const {
    const auto pair = [&](int du) {
      const KeptDifferences one = add_column<kFirst>(du, near, counts, has_edge);
      return one + add_column<kFirst>(du + kGroup / 2, near, counts, has_edge);
    };
    const KeptDifferences one = pair(first);
    return one + pair(first + 2);
  }
  // Columns that the window does not have are 0.
  template <bool kFirst>
  __device__ __forceinline__ KeptDifferences add_column(int du, const WindowPlane& near,
                                                        KeptCounts& counts, bool& has_edge) const {
    if (du > radius()) return {};
    const float x = static_cast<float>(du), predicted = near.c + near.a * x;
    const float gate = edges_.gate, along = gate + edges_.slope * std::fabs(x);
    KeptColumn kept;
#pragma unroll
    for (int dv = -radius(); dv <= radius(); ++dv) {
      const float difference = difference_at(du, dv), y = static_cast<float>(dv);
      if constexpr (kFirst) {
        has_edge |= std::fabs(difference) > gate;
        // That of the greater distance: rounding keeps the order.
        const float allowed = fmaxf(along, gate + edges_.slope * std::fabs(y));
        if (std::fabs(difference) <= allowed) kept.add(difference, dv);
      } else {
        if (std::fabs(difference - (predicted + near.b * y)) <= gate) kept.add(difference, dv);
      }
    }
    counts.n += kept.pixels(), counts.u += du * kept.pixels(), counts.uu += du * du * kept.pixels();
    counts.v += kept.y(), counts.uv += du * kept.y(), counts.vv += kept.yy();
    return {kept.e(), x * kept.e(), kept.ye()};
  }
  __device__ __forceinline__ bool keeps(const LastChoice& last, int du, int dv) const {
    const WindowPlane& near = last.near;
    const float expected =
        near.c + near.a * static_cast<float>(du) + near.b * static_cast<float>(dv);
    return std::fabs(difference_at(du, dv) - expected) <= last.gate;
  }
  // Not a number where nothing is measured.
  __device__ __forceinline__ float difference_at(int du, int dv) const {
    return (image_.at(du, dv) - middle_) * unit_;
  }

  TileAround image_;
  int radius_;
  const EdgeGate& edges_;
  float middle_, unit_;
};

}  // namespace vpm::cuda
