#include "libvpm/query/quadric_fit.h"

#include <algorithm>
#include <cmath>

namespace vpm {
namespace {

constexpr std::size_t kTerms = 6;  // 1, u, v, u^2, u v, v^2
using Terms = std::array<double, kTerms>;
// A pivot below this part of its diagonal is rounding: the points do not determine the term.
constexpr double kSingular = 1e-10;

// Solves the normal equations by Cholesky's method; `a` holds the lower triangle.
std::optional<Terms> solve(std::array<Terms, kTerms> a, Terms b) {
  for (std::size_t i = 0; i < kTerms; ++i) {
    const double diagonal = a[i][i];
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k];
      a[i][j] /= a[j][j];
      a[i][i] -= a[i][j] * a[i][j];
    }
    if (!(a[i][i] > kSingular * diagonal)) return std::nullopt;
    a[i][i] = std::sqrt(a[i][i]);
  }
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= a[i][k] * b[k];
    b[i] /= a[i][i];
  }
  for (std::size_t i = kTerms; i-- > 0;) {
    for (std::size_t k = i + 1; k < kTerms; ++k) b[i] -= a[k][i] * b[k];
    b[i] /= a[i][i];
  }
  return b;
}

// Returns the larger principal curvature of w = f u + g v + d u^2 + e u v + h v^2 at its middle.
double larger_curvature(const Terms& t) {
  const double f = t[1], g = t[2], lean = 1 + f * f + g * g;
  const double uu = 2 * t[3], uv = t[4], vv = 2 * t[5];
  const double mean =
      ((1 + g * g) * uu - 2 * f * g * uv + (1 + f * f) * vv) / (2 * lean * std::sqrt(lean));
  const double gauss = (uu * vv - uv * uv) / (lean * lean);
  return std::abs(mean) + std::sqrt(std::max(mean * mean - gauss, 0.0));
}

}  // namespace

std::optional<QuadricFit> fit_quadric(std::span<const Vec3> points, Vec3 place, Vec3 normal) {
  if (points.size() <= kTerms) return std::nullopt;
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, norm(p - place));
  if (!(size > 0)) return std::nullopt;
  const Vec3 other = std::abs(normal.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 axis_u = normalized_or_zero(cross(normal, other)), axis_v = cross(normal, axis_u);

  std::array<Terms, kTerms> products{};
  Terms moments{};
  double squares = 0;
  for (const Vec3& p : points) {
    const Vec3 d = (p - place) / size;
    const double u = dot(axis_u, d), v = dot(axis_v, d), w = dot(normal, d);
    const Terms terms{1, u, v, u * u, u * v, v * v};
    for (std::size_t i = 0; i < kTerms; ++i) {
      for (std::size_t j = 0; j <= i; ++j) products[i][j] += terms[i] * terms[j];
      moments[i] += terms[i] * w;
    }
    squares += w * w;
  }
  const std::optional<Terms> found = solve(products, moments);
  if (!found) return std::nullopt;
  for (std::size_t i = 0; i < kTerms; ++i) squares -= (*found)[i] * moments[i];
  const double freedom = static_cast<double>(points.size() - kTerms);
  return QuadricFit{size * std::sqrt(std::max(squares, 0.0) / freedom),
                    larger_curvature(*found) / size};
}

}  // namespace vpm
