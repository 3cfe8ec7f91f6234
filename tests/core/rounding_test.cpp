#include "libvpm/core/rounding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <vector>

namespace vpm {
namespace {

// Returns points up to `far` from 0, each coordinate rounded by `round`.
template <class Round>
std::vector<Vec3> points(double far, Round round) {
  std::vector<Vec3> made;
  for (int k = 0; k < 100; ++k)
    made.push_back({round(far * (1 - 1e-3 * k / 3)), round(far / (k + 3)), round(-std::sqrt(k))});
  return made;
}

double as_float(double value) {
  return double{static_cast<float>(value)};
}

// Returns the number as %g writes it.
double six_digits(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return std::atof(text);
}

TEST(Rounding, TellsFloatsAndSixDigitsByTheirValues) {
  const auto floats = coarseness_of(points(1e5, as_float), 0);
  ASSERT_TRUE(floats);
  EXPECT_STREQ(floats->numbers(), "floats of 32 bits");
  EXPECT_EQ(floats->farthest, 1e5);
  EXPECT_EQ(floats->step, 1.0 / 128);
  for (const double far : {1e-7, 123.456, 1e5, 9.99999e20}) {
    const auto digits = coarseness_of(points(far, six_digits), 0);
    ASSERT_TRUE(digits) << far;
    EXPECT_STREQ(digits->numbers(), "numbers of six digits");
    EXPECT_NEAR(digits->step, std::pow(10, std::floor(std::log10(digits->farthest)) - 5),
                1e-9 * digits->step);
  }
  EXPECT_FALSE(coarseness_of(points(1e5, [](double value) { return value; }), 0));
  EXPECT_FALSE(coarseness_of(points(1e5, as_float), 0.01));
  EXPECT_FALSE(coarseness_of(points(1e5, six_digits), 2));
}

TEST(Rounding, PointsThatAreNotFiniteTellNothing) {
  std::vector<Vec3> some = points(1e5, as_float);
  some[3].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(coarseness_of(some, 0));
  EXPECT_FALSE(coarseness_of({}, 0));
  EXPECT_FALSE(coarseness_of(std::vector<Vec3>(100), 0));
  EXPECT_FALSE(coarseness_of(std::vector<Vec3>(100, Vec3{1e300, 0, 0}), 0));
}

}  // namespace
}  // namespace vpm
