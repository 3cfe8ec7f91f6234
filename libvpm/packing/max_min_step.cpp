#include "libvpm/packing/max_min_step.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vpm {
namespace {

// Dual simplex in the four unknowns (delta, s), in units of the box and about the smallest value:
// maximise s subject to s - gradient_j . delta <= value_j and -1 <= delta <= 1. The basis holds
// four tight rows; each pivot brings in the row that is violated most.
using Row = std::array<double, 4>;
constexpr double kFeasible = 1e-13;  // violations below this are rounding
constexpr double kPivot = 1e-12;     // smallest coefficient that may become a pivot
constexpr int kMaxPivots = 64;       // stops cycling; several times what random bounds need

struct Simplex {
  // Inverse of the basis rows; columns correspond to them.
  std::array<std::array<double, 4>, 4> inverse{};
  Row right{};  // right-hand sides of the basis rows

  explicit Simplex(const LinearBound& first, double value) {
    const std::array<double, 3> g{first.gradient.x, first.gradient.y, first.gradient.z};
    for (std::size_t k = 0; k < 3; ++k) {
      const double sign = g[k] < 0 ? -1.0 : 1.0;
      inverse[k][k] = sign;
      inverse[3][k] = g[k] * sign;
      right[k] = 1;
    }
    inverse[3][3] = 1;
    right[3] = value;
  }

  Row solution() const {
    Row y{};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t k = 0; k < 4; ++k) y[r] += inverse[r][k] * right[k];
    return y;
  }

  // Replaces the basis row whose multiplier falls to zero first.
  bool pivot(const Row& row, double row_right) {
    Row weight{};
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t r = 0; r < 4; ++r) weight[k] += row[r] * inverse[r][k];
    std::size_t leaving = 0;
    double ratio = HUGE_VAL;
    for (std::size_t k = 0; k < 4; ++k) {
      if (weight[k] <= kPivot) continue;
      const double candidate = std::max(inverse[3][k], 0.0) / weight[k];
      if (candidate < ratio || (candidate == ratio && weight[k] > weight[leaving])) {
        ratio = candidate;
        leaving = k;
      }
    }
    if (ratio == HUGE_VAL) return false;
    for (auto& r : inverse) {
      r[leaving] /= weight[leaving];
      for (std::size_t k = 0; k < 4; ++k)
        if (k != leaving) r[k] -= weight[k] * r[leaving];
    }
    right[leaving] = row_right;
    return true;
  }
};

}  // namespace

MaxMinStep max_min_step(const std::vector<LinearBound>& bounds, double box) {
  double base = HUGE_VAL;
  for (const LinearBound& b : bounds) base = std::min(base, b.value);
  const auto scaled = [&](const LinearBound& b) { return (b.value - base) / box; };
  Simplex simplex(bounds.front(), scaled(bounds.front()));
  Row y = simplex.solution();
  for (int pivots = 0; pivots < kMaxPivots; ++pivots) {
    double worst = kFeasible;
    Row row{};
    double right = 0;
    for (const LinearBound& b : bounds) {
      const Vec3 g = b.gradient;
      const double violation = y[3] - (g.x * y[0] + g.y * y[1] + g.z * y[2]) - scaled(b);
      if (violation > worst) {
        worst = violation;
        row = {-g.x, -g.y, -g.z, 1};
        right = scaled(b);
      }
    }
    for (std::size_t k = 0; k < 3; ++k) {
      if (std::abs(y[k]) - 1 <= worst) continue;
      worst = std::abs(y[k]) - 1;
      row = {};
      row[k] = y[k] < 0 ? -1 : 1;
      right = 1;
    }
    if (worst == kFeasible || !simplex.pivot(row, right)) break;
    y = simplex.solution();
  }
  MaxMinStep step;
  const auto clamped = [&](double v) { return box * std::clamp(v, -1.0, 1.0); };
  step.delta = {clamped(y[0]), clamped(y[1]), clamped(y[2])};
  step.value = HUGE_VAL;
  for (const LinearBound& b : bounds)
    step.value = std::min(step.value, b.value + dot(b.gradient, step.delta));
  return step;
}

}  // namespace vpm
