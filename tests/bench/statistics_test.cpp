#include "tools/bench/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vpm::bench {
namespace {

TEST(Spread, OfOneSampleIsThatSample) {
  const Spread s = spread_of({3});
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.min, 3);
  EXPECT_EQ(s.max, 3);
}

TEST(Spread, QuartilesInterpolate) {
  const Spread s = spread_of({4, 1, 3, 2});
  EXPECT_DOUBLE_EQ(s.quartile1, 1.75);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.quartile3, 3.25);
  EXPECT_EQ(s.min, 1);
  EXPECT_EQ(s.max, 4);
}

TEST(MeanAndWorst, OfNothingIsZero) {
  EXPECT_EQ(MeanAndWorst().mean(), 0);
  EXPECT_EQ(MeanAndWorst().worst(), 0);
}

TEST(MeanAndWorst, NotANumberIsTheWorst) {
  MeanAndWorst errors;
  errors.add(1);
  errors.add(NAN);
  errors.add(0.5);
  EXPECT_FALSE(errors.worst() <= 1);
  EXPECT_TRUE(std::isnan(errors.mean()));
}

}  // namespace
}  // namespace vpm::bench
