// Sums of doubles that do not depend on the order of their terms.
#pragma once

#include <array>

#include "libvpm/solid/surface_moments.h"

namespace vpm {

// Splits each term at 2^-34 and 2^-70, by rounding against a large constant (Demmel and Nguyen,
// "Fast reproducible floating-point summation", 2013), and adds both parts in doubles that hold
// their sums exactly: as long as these stay below 2^18, for 2^18 terms. Terms are 1 or so: what is
// summed is scaled by powers of two. Needs rounding to nearest, and no contraction.
class WideSum {
 public:
  void add(double term) {
    const double high = (term + kHigh) - kHigh;
    const double low = ((term - high) + kLow) - kLow;
    high_ += high;
    low_ += low;
  }
  // Takes a sum of some of the terms away, exactly.
  void subtract(const WideSum& o) { high_ -= o.high_, low_ -= o.low_; }
  double real() const { return high_ + low_; }

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

class WideMoments {
 public:
  void add(const SurfaceMoments& m) {
    area_.add(m.area), by_x_.add(m.by_x), by_y_.add(m.by_y), by_z_.add(m.by_z), first_.add(m.first);
  }
  void subtract(const WideMoments& o) {
    area_.subtract(o.area_), first_.subtract(o.first_);
    by_x_.subtract(o.by_x_), by_y_.subtract(o.by_y_), by_z_.subtract(o.by_z_);
  }
  SurfaceMoments real() const {
    return {area_.real(), by_x_.real(), by_y_.real(), by_z_.real(), first_.real()};
  }

 private:
  WideVec3 area_, by_x_, by_y_, by_z_, first_;
};

// Force and torque about the origin.
struct WideWrench {
  WideVec3 force, torque;

  void add(Vec3 f, Vec3 t) { force.add(f), torque.add(t); }
  void subtract(const WideWrench& o) { force.subtract(o.force), torque.subtract(o.torque); }
};

}  // namespace vpm
