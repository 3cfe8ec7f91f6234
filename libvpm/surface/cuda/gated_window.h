// The plane of those pixels of a window that belong to the surface of its centre, with the sums of
// GatedWindows (libvpm/cloud/normal_window.h) in the same order.
#pragma once

#include "libvpm/cloud/normal_window.h"

namespace vpm::cuda {

// What a window keeps of a column: how many pixels, the sums of dv and dv^2 over them, and of the
// difference and dv times it. Counts are integers, exact in any order: they share a word.
class KeptColumn {
 public:
  __device__ __forceinline__ void add(bool is_kept, float difference, int dv) {
    counts_ += is_kept ? (dv << kFirst) + (dv * dv << kSecond) + 1 : 0;
    const float e = is_kept ? difference : 0.0F;
    e_ += e, ye_ += static_cast<float>(dv) * e;
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

// `Image` has the inverse depths about the window's centre: column(du).value(dv), 0 beyond the
// image. `Radius`: 0 if it is known at run time only.
template <class Image, int Radius>
class GatedWindow {
 public:
  __device__ __forceinline__ GatedWindow(const Image& image, int radius, const EdgeGate& edges)
      : image_(image),
        radius_(radius),
        edges_(edges),
        middle_(image.column(0).value(0)),
        unit_(reciprocal(middle_)) {}

  // The last choice of pixels is by the gate about the plane `first`.
  __device__ __forceinline__ WindowPlane fit(WindowPlane& first) const {
    WindowPlane plane;
#pragma unroll 1
    for (int choice = 0; choice < 2; ++choice) {
      first = plane;
      plane = plane_of_sums(choose(first, choice == 0, OneLane()));
      if (!plane.found) break;
    }
    return plane;
  }
  // Sums over what the steepest surface could reach, or over what lies near a plane; by two lanes
  // side by side. By whole warps.
  __device__ __forceinline__ PlaneSums choose_by_two(const WindowPlane& near, bool is_first) const {
    return choose(near, is_first, TwoLanes());
  }

  // Of the pixels of the last choice. `Depths`: as `Image`, of depths.
  template <class Depths>
  __device__ __forceinline__ Moments moments(const WindowPlane& first, const Depths& depths) const {
    Moments m;
#pragma unroll 1
    for (int dv = -radius(); dv <= radius(); ++dv) {
#pragma unroll
      for (int du = -radius(); du <= radius(); ++du)
        add_pixel(m, keeps(first, du, dv) ? 1.0 : 0.0, depths.column(du).value(dv), du, dv);
    }
    return m;
  }

 private:
  static constexpr int kGroup = 8;  // columns are added pairwise, so many at a time

  __device__ __forceinline__ int radius() const {
    return Radius > 0 ? Radius : radius_;
  }

  // Who adds the halves of the columns, and then knows their sums.
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
  };
  struct TwoLanes {
    template <class Half>
    __device__ __forceinline__ KeptDifferences add(const Half& half) const {
      const KeptDifferences own = half(static_cast<int>(threadIdx.x) % 2);
      return {own.e + other(own.e), own.ue + other(own.ue), own.ve + other(own.ve)};
    }
    __device__ int add(int own) const { return own + other(own); }
    template <class T>
    __device__ static T other(T own) {
      return __shfl_xor_sync(~0U, own, 1);
    }
  };

  template <class Lanes>
  __device__ __forceinline__ PlaneSums choose(const WindowPlane& near, bool is_first,
                                              const Lanes& lanes) const {
    const float slope = is_first ? edges_.slope : 0;
    KeptCounts c;
    PlaneSums sums;
    for (int first = -radius(); first <= radius(); first += kGroup) {
      const KeptDifferences sum =
          lanes.add([&](int half) { return add_half(first + half, near, slope, c); });
      sums.e += sum.e, sums.ue += sum.ue, sums.ve += sum.ve;
    }
    sums.n = lanes.add(c.n), sums.u = lanes.add(c.u), sums.v = lanes.add(c.v);
    sums.uu = lanes.add(c.uu), sums.uv = lanes.add(c.uv), sums.vv = lanes.add(c.vv);
    return sums;
  }

  // Every second of eight columns.
  __device__ __forceinline__ KeptDifferences add_half(int first, const WindowPlane& near,
                                                      float slope, KeptCounts& counts) const {
    const auto pair = [&](int du) {
      const KeptDifferences one = add_column(du, near, slope, counts);
      return one + add_column(du + kGroup / 2, near, slope, counts);
    };
    const KeptDifferences one = pair(first);
    return one + pair(first + 2);
  }
  // Columns that the window does not have are 0.
  __device__ __forceinline__ KeptDifferences add_column(int du, const WindowPlane& near,
                                                        float slope, KeptCounts& counts) const {
    if (du > radius()) return {};
    const auto column = image_.column(du);
    const float x = static_cast<float>(du), predicted = near.c + near.a * x;
    const float along = edges_.gate + slope * std::fabs(x);
    KeptColumn kept;
#pragma unroll
    for (int dv = -radius(); dv <= radius(); ++dv) {
      const float value = column.value(dv), y = static_cast<float>(dv);
      const float difference = (value - middle_) * unit_;
      // That of the greater distance: rounding keeps the order.
      const float allowed = fmaxf(along, edges_.gate + slope * std::fabs(y));
      kept.add(is_in_gate(value, difference, predicted + near.b * y, allowed), difference, dv);
    }
    counts.n += kept.pixels(), counts.u += du * kept.pixels(), counts.uu += du * du * kept.pixels();
    counts.v += kept.y(), counts.uv += du * kept.y(), counts.vv += kept.yy();
    return {kept.e(), x * kept.e(), kept.ye()};
  }
  __device__ __forceinline__ bool keeps(const WindowPlane& near, int du, int dv) const {
    const float value = image_.column(du).value(dv);
    const float expected =
        near.c + near.a * static_cast<float>(du) + near.b * static_cast<float>(dv);
    return is_in_gate(value, (value - middle_) * unit_, expected, edges_.gate);
  }

  Image image_;
  int radius_;
  const EdgeGate& edges_;
  float middle_, unit_;
};

}  // namespace vpm::cuda
