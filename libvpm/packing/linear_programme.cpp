#include "libvpm/packing/linear_programme.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace vpm {
namespace {

using Four = LinearProgramme::Four;
using Row = LinearProgramme::Row;

constexpr int kMaxIterations = 50;      // thirty are many
constexpr double kGap = 1e-3;           // allowed error, relative to the gain
constexpr double kNoGain = 1e-6;        // gain not worth an iteration, relative to its bound
constexpr double kInfeasible = 1e-7;    // largest residual of a row
constexpr double kShortOfWall = 0.995;  // part of the way to where a slack vanishes
// Pivots below this part of their diagonal are rounding; the unknown is then held fixed.
constexpr double kMinPivot = 1e-14, kFixed = 1e100;

// Upper triangle of a symmetric positive definite matrix, factored in place. Zeros cost memory but
// no time.
class Symmetric {
 public:
  explicit Symmetric(std::size_t size) : size_(size), values_(size * size) {}
  void clear() { std::fill(values_.begin(), values_.end(), 0); }
  double& operator()(std::size_t i, std::size_t j) { return values_[i * size_ + j]; }

  void factorise() {
    filled_.resize(size_);
    std::vector<double> diagonal(size_);
    for (std::size_t k = 0; k < size_; ++k) diagonal[k] = values_[k * size_ + k];
    for (std::size_t k = 0; k < size_; ++k) {
      double* row = &values_[k * size_];
      row[k] = row[k] > kMinPivot * diagonal[k] ? std::sqrt(row[k]) : kFixed;
      const double scale = 1 / row[k];
      std::vector<std::uint32_t>& filled = filled_[k];
      filled.clear();
      for (std::size_t j = k + 1; j < size_; ++j) {
        if (row[j] == 0) continue;
        row[j] *= scale;
        filled.push_back(static_cast<std::uint32_t>(j));
      }
      for (std::size_t a = 0; a < filled.size(); ++a) {
        double* other = &values_[filled[a] * size_];
        const double f = row[filled[a]];
        for (std::size_t b = a; b < filled.size(); ++b) other[filled[b]] -= f * row[filled[b]];
      }
    }
  }

  void solve(std::vector<double>& x) const {
    for (std::size_t k = 0; k < size_; ++k) {
      const double* row = &values_[k * size_];
      x[k] /= row[k];
      for (const std::uint32_t j : filled_[k]) x[j] -= row[j] * x[k];
    }
    for (std::size_t k = size_; k-- > 0;) {
      const double* row = &values_[k * size_];
      for (const std::uint32_t j : filled_[k]) x[k] -= row[j] * x[j];
      x[k] /= row[k];
    }
  }

 private:
  std::size_t size_;
  std::vector<std::vector<std::uint32_t>> filled_;  // non-zero columns of each row
  std::vector<double> values_;
};

// Mehrotra's predictor-corrector method for: minimise -gain . x subject to G x + s = h and s >= 0.
// G has the programme's rows, then x_k <= 1 and -x_k <= 1 in turn.
class InteriorPoint {
 public:
  explicit InteriorPoint(const LinearProgramme& programme)
      : rows_(programme.rows),
        unknowns_(4 * programme.gain.size()),
        size_(rows_.size() + 2 * unknowns_),
        gain_(unknowns_),
        x_(unknowns_),
        limit_(size_, 1.0),
        slack_(size_),
        price_(size_),
        normal_(unknowns_) {
    for (std::size_t k = 0; k < unknowns_; ++k) {
      gain_[k] = programme.gain[k / 4][k % 4];
      bound_ += std::abs(gain_[k]);
    }
    for (std::size_t r = 0; r < rows_.size(); ++r) limit_[r] = rows_[r].limit;
    for (std::size_t r = 0; r < size_; ++r) {
      slack_[r] = std::max(limit_[r], kFirstSlack);
      price_[r] = bound_ / static_cast<double>(unknowns_);
    }
  }

  std::vector<Four> run() {
    std::vector<Four> result(unknowns_ / 4);
    if (!(bound_ > 0)) return result;
    for (int i = 0; i < kMaxIterations && !done() && step(); ++i) {
    }
    for (std::size_t k = 0; k < unknowns_; ++k) result[k / 4][k % 4] = std::clamp(x_[k], -1.0, 1.0);
    return result;
  }

 private:
  static constexpr double kFirstSlack = 0.1;
  using Vector = std::vector<double>;

  // Computes out = G x.
  void apply(const Vector& x, Vector& out) const {
    out.resize(size_);
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const Row& row = rows_[r];
      double sum = 0;
      for (std::size_t k = 0; k < 4; ++k) sum += row.a[k] * x[4 * row.i + k];
      if (row.j != LinearProgramme::kNone)
        for (std::size_t k = 0; k < 4; ++k) sum += row.b[k] * x[4 * row.j + k];
      out[r] = sum;
    }
    for (std::size_t k = 0; k < unknowns_; ++k) {
      out[rows_.size() + 2 * k] = x[k];
      out[rows_.size() + 2 * k + 1] = -x[k];
    }
  }

  // Computes out += G^T v.
  void apply_transposed(const Vector& v, Vector& out) const {
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const Row& row = rows_[r];
      for (std::size_t k = 0; k < 4; ++k) out[4 * row.i + k] += row.a[k] * v[r];
      if (row.j != LinearProgramme::kNone)
        for (std::size_t k = 0; k < 4; ++k) out[4 * row.j + k] += row.b[k] * v[r];
    }
    for (std::size_t k = 0; k < unknowns_; ++k)
      out[k] += v[rows_.size() + 2 * k] - v[rows_.size() + 2 * k + 1];
  }

  bool done() {
    double gain = 0, gap = 0, violated = 0;
    for (std::size_t k = 0; k < unknowns_; ++k) gain += gain_[k] * x_[k];
    apply(x_, residual_);
    for (std::size_t r = 0; r < size_; ++r) {
      residual_[r] += slack_[r] - limit_[r];
      violated = std::max(violated, std::abs(residual_[r]));
      gap += slack_[r] * price_[r];
    }
    mean_ = gap / static_cast<double>(size_);
    return violated < kInfeasible && gap < std::max(kGap * gain, kNoGain * bound_);
  }

  // Adds weight * v w^T, where v belongs to block i and w to block j.
  void add(double weight, std::size_t i, const Four& v, std::size_t j, const Four& w) {
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t l = i == j ? k : 0; l < 4; ++l)
        normal_(4 * i + k, 4 * j + l) += weight * v[k] * w[l];
  }

  // Computes G^T diag(price / slack) G.
  void assemble() {
    normal_.clear();
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const Row& row = rows_[r];
      const double weight = price_[r] / slack_[r];
      add(weight, row.i, row.a, row.i, row.a);
      if (row.j == LinearProgramme::kNone) continue;
      add(weight, row.j, row.b, row.j, row.b);
      row.i < row.j ? add(weight, row.i, row.a, row.j, row.b)
                    : add(weight, row.j, row.b, row.i, row.a);
    }
    for (std::size_t k = 0; k < unknowns_; ++k) {
      for (const std::size_t r : {rows_.size() + 2 * k, rows_.size() + 2 * k + 1})
        normal_(k, k) += price_[r] / slack_[r];
    }
    normal_.factorise();
  }

  // Solves for the Newton step towards slack * price = slack * price - complement.
  void direction(const Vector& complement) {
    dx_ = gain_;
    Vector along(size_);
    for (std::size_t r = 0; r < size_; ++r)
      along[r] = (complement[r] - price_[r] * residual_[r]) / slack_[r] - price_[r];
    apply_transposed(along, dx_);
    normal_.solve(dx_);
    apply(dx_, dslack_);
    dprice_.resize(size_);
    for (std::size_t r = 0; r < size_; ++r) {
      dslack_[r] = -residual_[r] - dslack_[r];
      dprice_[r] = -(complement[r] + price_[r] * dslack_[r]) / slack_[r];
    }
  }

  // Returns how far `v` may go along `dv`, up to 1, and stay positive.
  static double room(const Vector& v, const Vector& dv) {
    double most = 1;
    for (std::size_t r = 0; r < v.size(); ++r)
      if (dv[r] < 0) most = std::min(most, -v[r] / dv[r]);
    return most;
  }

  // Makes an iteration. Returns false if numbers become infinite or undefined.
  bool step() {
    assemble();
    Vector complement(size_);
    for (std::size_t r = 0; r < size_; ++r) complement[r] = slack_[r] * price_[r];
    direction(complement);
    const double slack_room = room(slack_, dslack_), price_room = room(price_, dprice_);
    double ahead = 0;
    for (std::size_t r = 0; r < size_; ++r)
      ahead += (slack_[r] + slack_room * dslack_[r]) * (price_[r] + price_room * dprice_[r]);
    if (!std::isfinite(ahead)) return false;
    const double ratio = ahead / (static_cast<double>(size_) * mean_);
    const double target = ratio * ratio * ratio * mean_;
    for (std::size_t r = 0; r < size_; ++r) complement[r] += dslack_[r] * dprice_[r] - target;
    direction(complement);
    if (!std::all_of(dx_.begin(), dx_.end(), [](double d) { return std::isfinite(d); }))
      return false;
    const double forward = std::min(1.0, kShortOfWall * room(slack_, dslack_));
    const double priced = std::min(1.0, kShortOfWall * room(price_, dprice_));
    for (std::size_t k = 0; k < unknowns_; ++k) x_[k] += forward * dx_[k];
    for (std::size_t r = 0; r < size_; ++r) {
      slack_[r] += forward * dslack_[r];
      price_[r] += priced * dprice_[r];
    }
    return true;
  }

  const std::vector<Row>& rows_;
  std::size_t unknowns_, size_;
  double bound_ = 0;  // upper bound of the gain
  double mean_ = 0;   // mean of slack * price
  Vector gain_, x_, limit_, slack_, price_, residual_, dx_, dslack_, dprice_;
  Symmetric normal_;
};

}  // namespace

std::vector<LinearProgramme::Four> solve(const LinearProgramme& programme) {
  return InteriorPoint(programme).run();
}

namespace {

// Dual simplex in the four unknowns (delta, s), in units of the box and about the smallest value:
// maximise s subject to s - gradient_j . delta <= value_j and -1 <= delta <= 1. The basis holds
// four tight rows; each pivot brings in the row that is violated most.
constexpr double kFeasible = 1e-13;  // violations below this are rounding
constexpr double kPivot = 1e-12;     // smallest coefficient that may become a pivot
constexpr int kMaxPivots = 64;       // stops cycling; several times what random bounds need

struct Simplex {
  // Inverse of the basis rows; columns correspond to them.
  std::array<std::array<double, 4>, 4> inverse{};
  Four right{};  // right-hand sides of the basis rows

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

  Four solution() const {
    Four y{};
    for (std::size_t r = 0; r < 4; ++r)
      for (std::size_t k = 0; k < 4; ++k) y[r] += inverse[r][k] * right[k];
    return y;
  }

  // Replaces the basis row whose multiplier falls to zero first.
  bool pivot(const Four& row, double row_right) {
    Four weight{};
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
  Four y = simplex.solution();
  for (int pivots = 0; pivots < kMaxPivots; ++pivots) {
    double worst = kFeasible;
    Four row{};
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
