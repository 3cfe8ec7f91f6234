#include "libvpm/recording/loop_clock.h"

#include <gtest/gtest.h>

namespace vpm {
namespace {

TEST(Durations, QuantilesAreValuesThatOccurred) {
  std::vector<double> seconds;
  for (int k = 1000; k >= 1; --k) seconds.push_back(k);
  const Durations d(seconds);
  EXPECT_EQ(d.quantile(0), 1);
  EXPECT_EQ(d.quantile(0.5), 500);
  EXPECT_EQ(d.quantile(0.99), 990);
  EXPECT_EQ(d.quantile(0.999), 999);
  EXPECT_EQ(d.quantile(1), 1000);
  EXPECT_EQ(d.mean(), 500.5);
  EXPECT_EQ(d.longer_than(990), 10u);  // a step that takes exactly the deadline keeps it
}

TEST(LoopClock, WaitsForEachStepAndCountsFromWhenItWasDue) {
  constexpr double kRate = 200;
  LoopClock clock(kRate, true);
  for (int k = 0; k < 11; ++k) {
    clock.begin_step();
    clock.end_step();
  }
  EXPECT_GE(clock.seconds(), 10 / kRate);
  ASSERT_EQ(clock.latencies().size(), 11u);
  for (std::size_t k = 0; k < 11; ++k) {
    EXPECT_GE(clock.delays()[k], 0);
    EXPECT_GE(clock.latencies()[k], clock.delays()[k]);
  }
}

TEST(LoopClock, OtherwiseNeverWaits) {
  LoopClock clock(1, false);
  for (int k = 0; k < 100; ++k) {
    clock.begin_step();
    clock.end_step();
  }
  EXPECT_LT(clock.seconds(), 50);
  EXPECT_TRUE(clock.delays().empty());
  for (const double latency : clock.latencies()) EXPECT_GE(latency, 0);
}

}  // namespace
}  // namespace vpm
