#include "libvpm/core/fixed_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace vpm {
namespace {

using Sum = FixedSum<40>;

std::vector<double> terms_in_unit_range() {
  std::mt19937_64 generator(1);
  std::vector<double> terms(10000);
  for (double& term : terms) term = static_cast<double>(generator()) / 0x1p63 - 1;
  return terms;
}

Sum sum_of(const std::vector<double>& terms) {
  Sum sum;
  for (const double term : terms) sum.add(term);
  return sum;
}

TEST(FixedSum, DoesNotDependOnTheOrder) {
  std::vector<double> terms = terms_in_unit_range();
  const std::int64_t expected = sum_of(terms).value;
  std::sort(terms.begin(), terms.end());
  EXPECT_EQ(sum_of(terms).value, expected);
  std::reverse(terms.begin(), terms.end());
  EXPECT_EQ(sum_of(terms).value, expected);
}

TEST(FixedSum, DoesNotDependOnTheGrouping) {
  const std::vector<double> terms = terms_in_unit_range();
  for (const std::size_t groups : {2U, 7U, 64U}) {
    std::vector<Sum> parts(groups);
    for (std::size_t i = 0; i < terms.size(); ++i) parts[i % groups].add(terms[i]);
    Sum total;
    for (const Sum& part : parts) total.add(part);
    EXPECT_EQ(total.value, sum_of(terms).value);
  }
}

TEST(FixedSum, ErrsByHalfAUnitPerTermAtMost) {
  const std::vector<double> terms = terms_in_unit_range();
  double expected = 0;
  for (const double term : terms) expected += term;
  EXPECT_NEAR(sum_of(terms).real(), expected, 10000 * 0.5 / Sum::kOne);
}

TEST(FixedSum, RoundsToTheNearestAndIsOdd) {
  const double unit = 1 / Sum::kOne;
  EXPECT_EQ(Sum::round(0.49 * unit), 0);
  EXPECT_EQ(Sum::round(0.5 * unit), 1);
  EXPECT_EQ(Sum::round(1.49 * unit), 1);
  for (const double term : terms_in_unit_range()) EXPECT_EQ(Sum::round(-term), -Sum::round(term));
}

}  // namespace
}  // namespace vpm
