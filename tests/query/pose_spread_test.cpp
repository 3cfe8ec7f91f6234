// Poses that several threads answer: the order of the answers, and which failure is told.
#include "tools/query/pose_spread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace vpm::tools {
namespace {

constexpr std::size_t kPoses = 500;

// Answers poses by their index; later ones sooner, so that they wait for those before them. Poses
// of `failing` throw their index.
struct Spread {
  explicit Spread(std::vector<std::size_t> poses = {}, std::size_t most = kPoses)
      : failing(std::move(poses)), takes_at_most(most) {}

  std::vector<std::size_t> failing;
  std::vector<double> taken;
  std::size_t takes_at_most;
  std::atomic<int> taking{0};

  // Returns the message of the failure, or "".
  std::string run(std::size_t threads) {
    taken.clear();
    try {
      PoseSpread spread(
          threads,
          [&](std::size_t thread, std::size_t index, const AskedPose& asked) {
            EXPECT_LT(thread, threads);
            EXPECT_EQ(asked.pose.translation.x, static_cast<double>(index));
            std::this_thread::sleep_for(std::chrono::microseconds(index % 7 == 0 ? 200 : 5));
            for (const std::size_t k : failing)
              if (k == index) throw std::runtime_error(std::to_string(k));
            AnsweredPose answered{asked, {}, {}, {}, 0};
            answered.result.volume = 2 * asked.pose.translation.x;
            return answered;
          },
          [&](const AnsweredPose& answered) {
            EXPECT_EQ(taking.fetch_add(1), 0);
            if (taken.size() == takes_at_most) throw std::runtime_error("no room");
            taken.push_back(answered.result.volume);
            taking.fetch_sub(1);
          });
      for (std::size_t k = 0; k < kPoses; ++k)
        spread.add({{{}, {static_cast<double>(k), 0, 0}}, {}, {}});
      spread.finish();
    } catch (const std::runtime_error& failure) {
      return failure.what();
    }
    return "";
  }
  void expect_first(std::size_t count) const {
    ASSERT_EQ(taken.size(), count);
    for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(taken[k], 2.0 * static_cast<double>(k));
  }
};

TEST(PoseSpread, TakesAnswersInOrderOneAtATime) {
  for (const std::size_t threads : {1, 2, 4, 9}) {
    Spread spread;
    EXPECT_EQ(spread.run(threads), "");
    spread.expect_first(kPoses);
  }
}

TEST(PoseSpread, TellsTheFirstPoseThatFailsAfterAllBeforeIt) {
  for (const std::size_t threads : {1, 2, 4, 9}) {
    Spread spread({21, 23, 24, 400});
    EXPECT_EQ(spread.run(threads), "21");
    spread.expect_first(21);
  }
  Spread last({kPoses - 1});
  EXPECT_EQ(last.run(4), std::to_string(kPoses - 1));
  last.expect_first(kPoses - 1);
}

TEST(PoseSpread, TellsThatAnswersCannotBeTaken) {
  for (const std::size_t threads : {1, 4}) {
    Spread spread({}, 30);
    EXPECT_EQ(spread.run(threads), "no room");
    spread.expect_first(30);
  }
}

TEST(PoseSpread, EndsWithPosesThatNobodyWaitsFor) {
  std::atomic<int> answered{0};
  {
    PoseSpread spread(
        3,
        [&](std::size_t, std::size_t, const AskedPose& asked) {
          ++answered;
          return AnsweredPose{asked, {}, {}, {}, 0};
        },
        [](const AnsweredPose&) {});
    for (int k = 0; k < 100; ++k) spread.add({});
  }
  EXPECT_LE(answered, 100);
}

}  // namespace
}  // namespace vpm::tools
