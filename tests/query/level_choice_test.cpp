#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "libvpm/query/level_tool_query.h"
#include "tests/query/lattice_model.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

ToolModel calibrated(const std::vector<double>& worst) {
  ToolModel tool = testing::lattice_cube(0.2, 2, 2);
  const Level level = tool.levels.front();
  tool.levels.assign(worst.size(), level);
  for (const double error : worst) tool.calibration.push_back({error / 4, error / 2, error});
  return tool;
}

TEST(MaxError, TakesTheCoarsestLevelThatKeepsIt) {
  const ToolModel tool = calibrated({0.03, 0.004, 0.001});
  EXPECT_EQ(coarsest_level_within(tool, 0.5), 0u);
  EXPECT_EQ(coarsest_level_within(tool, 0.03), 0u);
  EXPECT_EQ(coarsest_level_within(tool, 0.005), 1u);
  EXPECT_EQ(coarsest_level_within(tool, 0.0039), 2u);
}

std::string refusal(const ToolModel& tool, double max_error) {
  return test::refusal([&] { coarsest_level_within(tool, max_error); });
}

TEST(MaxError, SaysWhyItCannotBeKept) {
  EXPECT_NE(refusal(calibrated({0.03, 0.004}), 0.001).find("the best has 0.4 %"),
            std::string::npos);
  EXPECT_NE(refusal(calibrated({0.03}), 0.1).find("one level only"), std::string::npos);
  ToolModel tool = calibrated({0.03, 0.004});
  tool.calibration.clear();
  EXPECT_NE(refusal(tool, 0.1).find("`calibrate`"), std::string::npos);
  for (const double error : {0.0, -1.0, 1.0, std::nan("")})
    EXPECT_NE(refusal(calibrated({0.03, 0.004}), error), "");
}

// The number that a refusal names is rounded up, so that whoever asks for it gets it.
TEST(MaxError, TheNumberOfItsAdviceIsKept) {
  for (const double best : {0.0123456, 0.00627341, 0.09995, 0.004, 1e-7}) {
    const ToolModel tool = calibrated({0.3, best});
    const std::string said = refusal(tool, best / 100);
    const double advised = std::stod(said.substr(said.find("has ") + 4)) / 100;
    EXPECT_EQ(coarsest_level_within(tool, advised), 1u) << said;
    EXPECT_LT(advised, 1.01 * best) << said;
  }
}

TEST(Deadline, TakesTheFinestLevelWithAMargin) {
  EXPECT_EQ(DeadlineLevel({10, 50, 300}, 1000, 2).level(), 2u);
  EXPECT_EQ(DeadlineLevel({10, 50, 300}, 310, 2).level(), 1u);
  EXPECT_EQ(DeadlineLevel({10, 50, 300}, 1000, 1).level(), 1u);
  const DeadlineLevel hopeless({10, 50, 300}, 5, 2);
  EXPECT_EQ(hopeless.level(), 0u);
  EXPECT_FALSE(hopeless.keeps());
}

// Times drift slowly from a half to ten times the probed time and back, each with some noise.
TEST(Deadline, StepsDownBeforeItMissesAndUpAgain) {
  const std::vector<double> probed{10, 50, 300};
  DeadlineLevel choice(probed, 500, 2);
  int missed = 0;
  bool was_coarse = false;
  constexpr int kQueries = 10000;
  for (int k = 0; k < kQueries; ++k) {
    const double drift = 0.5 + 9.5 * std::pow(std::sin(3.14159265 * k / kQueries), 2);
    const double noise = 1 + 0.1 * std::sin(1e4 * std::sin(k));
    const double time = probed[choice.level()] * drift * noise;
    missed += time > 500;
    was_coarse |= choice.level() == 0;
    choice.took(time);
  }
  EXPECT_LE(missed, kQueries / 100);
  EXPECT_TRUE(was_coarse);
  EXPECT_EQ(choice.level(), 2u);
}

TEST(Deadline, IgnoresALoneSlowQueryAndFreeSpace) {
  DeadlineLevel choice({10, 50, 300}, 400, 2);
  for (int k = 0; k < 1000; ++k) {
    choice.took(k % 100 == 7 ? 9000 : 1);
    ASSERT_EQ(choice.level(), 2u);
  }
}

}  // namespace
}  // namespace vpm
