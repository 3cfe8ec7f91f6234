#include "libvpm/mesh/predicates.h"

#include <array>
#include <cmath>

namespace vpm {
namespace {

// Number as an exact sum of non-overlapping doubles, smallest first, none zero.
template <int Capacity>
struct Expansion {
  std::array<double, Capacity> term;
  int size = 0;

  // Adds b by Shewchuk's Grow-Expansion with zero elimination.
  void add(double b) {
    int kept = 0;
    for (int k = 0; k < size; ++k) {
      const double a = term[static_cast<std::size_t>(k)];
      const double sum = a + b, b_part = sum - a;
      const double error = (a - (sum - b_part)) + (b - b_part);
      b = sum;
      if (error != 0) term[static_cast<std::size_t>(kept++)] = error;
    }
    if (b != 0) term[static_cast<std::size_t>(kept++)] = b;
    size = kept;
  }
  int sign() const {
    if (size == 0) return 0;
    return term[static_cast<std::size_t>(size - 1)] > 0 ? 1 : -1;
  }
};

Expansion<2> difference(double a, double b) {
  Expansion<2> result;
  result.add(a);
  result.add(-b);
  return result;
}

// Computes sum += factor * a * b.
template <int N, int M, int K>
void add_product(Expansion<N>& sum, double factor, const Expansion<M>& a, const Expansion<K>& b) {
  static_assert(N >= 2 * M * K);
  for (int i = 0; i < a.size; ++i) {
    for (int j = 0; j < b.size; ++j) {
      const double s = factor * a.term[static_cast<std::size_t>(i)],
                   t = b.term[static_cast<std::size_t>(j)];
      const double product = s * t;
      sum.add(std::fma(s, t, -product));
      sum.add(product);
    }
  }
}

int sign_of(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

int exact_orientation(Vec2 a, Vec2 b, Vec2 c) {
  Expansion<16> determinant;
  add_product(determinant, 1, difference(a.x, c.x), difference(b.y, c.y));
  add_product(determinant, -1, difference(a.y, c.y), difference(b.x, c.x));
  return determinant.sign();
}

int exact_orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
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

// Rounding error of the determinants below, relative to the sum of magnitudes of their terms:
// Shewchuk's first bounds, (3 + 16 e) e and (7 + 56 e) e with e = 2^-53.
constexpr double kEpsilon = 0x1p-53;
constexpr double kBound2 = (3 + 16 * kEpsilon) * kEpsilon;
constexpr double kBound3 = (7 + 56 * kEpsilon) * kEpsilon;

}  // namespace

int orientation(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double determinant = left - right;
  const double bound = kBound2 * (std::abs(left) + std::abs(right));
  // A zero bound means that every term has a factor that is exactly zero.
  if (std::abs(determinant) > bound || bound == 0) return sign_of(determinant);
  return exact_orientation(a, b, c);
}

int orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const Vec3 p = a - d, q = b - d, r = c - d;
  const double qr = q.y * r.z, rq = q.z * r.y, rp = q.z * r.x, pr = q.x * r.z, pq = q.x * r.y,
               qp = q.y * r.x;
  const double determinant = p.x * (qr - rq) + p.y * (rp - pr) + p.z * (pq - qp);
  const double bound = kBound3 * (std::abs(p.x) * (std::abs(qr) + std::abs(rq)) +
                                  std::abs(p.y) * (std::abs(rp) + std::abs(pr)) +
                                  std::abs(p.z) * (std::abs(pq) + std::abs(qp)));
  if (std::abs(determinant) > bound || bound == 0) return sign_of(determinant);
  return exact_orientation(a, b, c, d);
}

}  // namespace vpm
