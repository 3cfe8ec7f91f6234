#include "libvpm/cloud/covariance_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/cloud/normal_scene.h"

namespace vpm {
namespace {

// Three perpendicular unit vectors.
struct Axes {
  Vec3 a, b, c;
};
Axes random_axes(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  const Vec3 a = draw(), b = cross(a, draw()), c = cross(a, b);
  return {normalized_or_zero(a), normalized_or_zero(b), normalized_or_zero(c)};
}
Symmetric3<double> with_eigenvalues(const Axes& axes, double a, double b, double c) {
  const auto sum = [&](auto product) {
    return a * product(axes.a) + b * product(axes.b) + c * product(axes.c);
  };
  return {sum([](Vec3 v) { return v.x * v.x; }), sum([](Vec3 v) { return v.x * v.y; }),
          sum([](Vec3 v) { return v.x * v.z; }), sum([](Vec3 v) { return v.y * v.y; }),
          sum([](Vec3 v) { return v.y * v.z; }), sum([](Vec3 v) { return v.z * v.z; })};
}

TEST(CovarianceFit, FindsTheDirectionOfLeastVariance) {
  // Relative rounding of float entries in a matrix of trace 1; it turns the eigenvector by this
  // over the gap.
  constexpr double kKnown = 4e-6;
  std::mt19937 random(3);
  for (const double least :
       {0.0, 1e-7, 1e-4, 0.01, 0.1, 0.3, 0.6}) {    // fraction of the second eigenvalue
    for (const double second : {1e-3, 0.1, 1.0}) {  // fraction of the greatest
      for (int i = 0; i < 200; ++i) {
        const Axes axes = random_axes(random);
        const double scale = std::ldexp(1.0, i - 100);
        const auto covariance =
            over_trace(with_eigenvalues(axes, scale * least * second, scale * second, scale));
        const double gap = second * (1 - least) / (1 + second + second * least);
        const double rx = axes.a.x / axes.a.z, ry = axes.a.y / axes.a.z;
        const Vec3f n =
            normal_of_covariance(covariance, static_cast<float>(rx), static_cast<float>(ry));
        const Vec3 towards = axes.a.z > 0 ? -1.0 * axes.a : axes.a;
        ASSERT_LT(angle_between(n, towards) * gap, kKnown) << least << " " << second;
      }
    }
  }
}

TEST(CovarianceFit, SaysNothingOfPointsOnALine) {
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    const auto covariance = over_trace(with_eigenvalues(random_axes(random), 0, 1e-7, 1));
    EXPECT_FALSE(exists(normal_of_covariance(covariance, 0, 0)));
  }
  EXPECT_FALSE(exists(normal_of_covariance(over_trace(Symmetric3<double>{}), 0, 0)));
}

}  // namespace
}  // namespace vpm
