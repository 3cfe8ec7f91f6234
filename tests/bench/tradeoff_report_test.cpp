#include "tools/bench/tradeoff_report.h"

#include <gtest/gtest.h>

namespace vpm::bench {
namespace {

TEST(ParetoFront, KeepsWhatNothingBeats) {
  const std::vector<double> time{3, 1, 2, 2.5, 4}, error{1, 9, 5, 6, 1};
  EXPECT_EQ(pareto_front(time, error), (std::vector<std::size_t>{1, 2, 0}));
  EXPECT_TRUE(pareto_front({}, {}).empty());
}

TEST(Knee, IsWhereTheCurveTurns) {
  EXPECT_EQ(knee({1, 10, 100, 1000}, {100, 1, 0.9, 0.8}), 1u);
  EXPECT_EQ(knee({1, 10, 100, 1000}, {100, 10, 1, 0.99}), 2u);
  EXPECT_EQ(knee({5}, {1}), 0u);
}

}  // namespace
}  // namespace vpm::bench
