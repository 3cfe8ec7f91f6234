// Sums of doubles that do not depend on the order of their terms.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/solid/surface_moments.h"

namespace vpm {

// Reaches of the smaller solid from which on a larger one is measured only where they can meet.
inline constexpr double kMuchLarger = 16;

// Returns the unit in which a pair of solids is summed, m: a power of two that is larger than any
// coordinate where they can meet, in the first's frame, and than those of a second one that is not
// much larger than the first, which must not have the larger reach.
inline double unit_for(double reach, double other_reach) {
  int exponent = 0;
  std::frexp(reach + 2 * std::min(other_reach, kMuchLarger * reach), &exponent);
  return std::ldexp(1.0, exponent);
}
// Returns whether the second solid is so large that what is inside as a whole is summed by
// triangles, about the first's centre: about its own, digits would be lost.
inline bool outgrows(double other_reach, double unit) {
  return 2 * other_reach > unit;
}

// Splits each term at 2^-34 and 2^-70, by rounding against a large constant (Demmel and Nguyen,
// "Fast reproducible floating-point summation", 2013), and adds both parts in doubles that hold
// their sums exactly: as long as these stay below 2^18, for 2^18 terms. Terms are 1 or so: what is
// summed is scaled by powers of two. Needs rounding to nearest, and no contraction.
class WideSum {
 public:
  VPM_HD void add(double term) { add(term, high_, low_); }
  // Adds the parts of a term, or of several side by side, to the sums of these parts.
  template <class Number>
  [[gnu::always_inline]] VPM_HD static void add(const Number& term, Number& high_sum,
                                                Number& low_sum) {
    const Number high = (term + kHigh) - kHigh;
    const Number low = ((term - high) + kLow) - kLow;
    high_sum += high;
    low_sum += low;
  }
  // Takes a sum of some of the terms away, exactly.
  VPM_HD void subtract(const WideSum& o) { high_ -= o.high_, low_ -= o.low_; }
  VPM_HD double real() const { return high_ + low_; }

 private:
  static constexpr double kHigh = 1.5 * 0x1p18, kLow = 1.5 * 0x1p-18;  // 2^52 times the grids
  double high_ = 0, low_ = 0;
};

class WideVec3 {
 public:
  void add(Vec3 term) { x_.add(term.x), y_.add(term.y), z_.add(term.z); }
  void subtract(const WideVec3& o) { x_.subtract(o.x_), y_.subtract(o.y_), z_.subtract(o.z_); }
  Vec3 real() const { return {x_.real(), y_.real(), z_.real()}; }

 private:
  WideSum x_, y_, z_;
};

// 4 N sums side by side, four in each element; that of term k is in lane k % 4 of element k / 4.
template <std::size_t N, class Four = FourNumbers>
class WideSums {
 public:
  using Terms = std::array<Four, N>;

  [[gnu::always_inline]] VPM_HD void add(const Terms& terms) {
    for (std::size_t k = 0; k < N; ++k) WideSum::add(terms[k], high_[k], low_[k]);
  }
  void subtract(const WideSums& o) {
    for (std::size_t k = 0; k < N; ++k) high_[k] -= o.high_[k], low_[k] -= o.low_[k];
  }
  VPM_HD double real(std::size_t k) const {
    const auto lane = static_cast<int>(k % 4);
    return high_[k / 4][lane] + low_[k / 4][lane];
  }

 private:
  // GCC aligns vectors less in functions that are not compiled for AVX.
  alignas(sizeof(Four)) Terms high_{}, low_{};
};

class WideMoments {
 public:
  [[gnu::always_inline]] void add(const SurfaceMoments& m) {
    const auto& [a, x, y, z, f] = m;
    sums_.add({FourNumbers{a.x, a.y, a.z, x.x}, FourNumbers{x.y, x.z, y.x, y.y},
               FourNumbers{y.z, z.x, z.y, z.z}, FourNumbers{f.x, f.y, f.z, 0}});
  }
  void subtract(const WideMoments& o) { sums_.subtract(o.sums_); }
  SurfaceMoments real() const {
    const auto at = [&](std::size_t k) {
      return Vec3{sums_.real(k), sums_.real(k + 1), sums_.real(k + 2)};
    };
    return {at(0), at(3), at(6), at(9), at(12)};
  }

 private:
  WideSums<4> sums_;
};

// Force and torque about the origin.
struct WideWrench {
  WideVec3 force, torque;

  void add(Vec3 f, Vec3 t) { force.add(f), torque.add(t); }
  void subtract(const WideWrench& o) { force.subtract(o.force), torque.subtract(o.torque); }
};

}  // namespace vpm
