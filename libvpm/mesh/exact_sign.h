// The exact sign of a determinant of points, for host and device: a floating-point filter first,
// expansion arithmetic where it cannot decide (Shewchuk 1997, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates"). Exact for coordinates of magnitudes from 1e-90
// to 1e90, for which no product overflows or underflows.
#pragma once

#include <cmath>

#include "libvpm/core/vec3.h"

namespace vpm {

// Number as an exact sum of non-overlapping doubles, smallest first, none zero.
template <int Capacity>
struct Expansion {
  double term[Capacity];
  int size = 0;

  // Adds b by Shewchuk's Grow-Expansion with zero elimination.
  VPM_HD void add(double b) {
    int kept = 0;
    for (int k = 0; k < size; ++k) {
      const double a = term[k];
      const double sum = a + b, b_part = sum - a;
      const double error = (a - (sum - b_part)) + (b - b_part);
      b = sum;
      if (error != 0) term[kept++] = error;
    }
    if (b != 0) term[kept++] = b;
    size = kept;
  }
  VPM_HD int sign() const {
    if (size == 0) return 0;
    return term[size - 1] > 0 ? 1 : -1;
  }
};

VPM_HD inline Expansion<2> difference(double a, double b) {
  Expansion<2> result;
  result.add(a);
  result.add(-b);
  return result;
}

// Computes sum += factor * a * b.
template <int N, int M, int K>
VPM_HD void add_product(Expansion<N>& sum, double factor, const Expansion<M>& a,
                        const Expansion<K>& b) {
  static_assert(N >= 2 * M * K);
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < b.size; ++j) {
      const double s = factor * a.term[i], t = b.term[j];
      const double product = s * t;
      sum.add(std::fma(s, t, -product));
      sum.add(product);
    }
  }
}

VPM_HD inline int sign_of(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

// Rounding error of the determinant below, relative to the sum of magnitudes of its terms:
// Shewchuk's first bound, (7 + 56 e) e with e = 2^-53.
inline constexpr double kRoundingUnit = 0x1p-53;
inline constexpr double kOrientationBound = (7 + 56 * kRoundingUnit) * kRoundingUnit;

[[gnu::noinline]] VPM_HD inline int exact_orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const auto ax = difference(a.x, d.x), ay = difference(a.y, d.y), az = difference(a.z, d.z);
  const auto bx = difference(b.x, d.x), by = difference(b.y, d.y), bz = difference(b.z, d.z);
  const auto cx = difference(c.x, d.x), cy = difference(c.y, d.y), cz = difference(c.z, d.z);
  const auto minor = [](const auto& p, const auto& q, const auto& r, const auto& s) {
    Expansion<16> value;
    add_product(value, 1, p, q);
    add_product(value, -1, r, s);
    return value;
  };
  Expansion<192> determinant;
  add_product(determinant, 1, minor(by, cz, bz, cy), ax);
  add_product(determinant, 1, minor(bz, cx, bx, cz), ay);
  add_product(determinant, 1, minor(bx, cy, by, cx), az);
  return determinant.sign();
}

// Returns the sign of (a - d) . ((b - d) x (c - d)): +1 if d lies below the plane in which a, b, c
// turn counter-clockwise seen from above, 0 if on it.
VPM_HD inline int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 p = a - d, q = b - d, r = c - d;
  const double qr = q.y * r.z, rq = q.z * r.y, rp = q.z * r.x, pr = q.x * r.z, pq = q.x * r.y,
               qp = q.y * r.x;
  const double determinant = p.x * (qr - rq) + p.y * (rp - pr) + p.z * (pq - qp);
  const double bound = kOrientationBound * (std::abs(p.x) * (std::abs(qr) + std::abs(rq)) +
                                            std::abs(p.y) * (std::abs(rp) + std::abs(pr)) +
                                            std::abs(p.z) * (std::abs(pq) + std::abs(qp)));
  if (std::abs(determinant) > bound || bound == 0) return sign_of(determinant);
  return exact_orientation(a, b, c, d);
}

}  // namespace vpm
