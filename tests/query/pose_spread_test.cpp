// Poses that several threads answer: the order of the answers, and which failure is told.
#include "tools/query/pose_spread.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
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

  AnsweredChunk answer(const PoseChunk& chunk) const {
    AnsweredChunk answered;
    for (std::size_t k = 0; k < chunk.poses.size(); ++k) {
      const std::size_t index = chunk.first + k;
      EXPECT_EQ(chunk.poses[k].pose.translation.x, static_cast<double>(index));
      std::this_thread::sleep_for(std::chrono::microseconds(index % 7 == 0 ? 200 : 5));
      if (std::ranges::count(failing, index) > 0) {
        answered.failure = std::make_exception_ptr(std::runtime_error(std::to_string(index)));
        return answered;
      }
      answered.poses.push_back({chunk.poses[k], {}, {}, {}, 0});
      answered.poses.back().result.volume = 2 * chunk.poses[k].pose.translation.x;
    }
    return answered;
  }
  void take(const std::vector<AnsweredChunk>& chunks) {
    EXPECT_EQ(taking.fetch_add(1), 0);
    for (const AnsweredChunk& answered : chunks) {
      EXPECT_TRUE(!answered.failure || &answered == &chunks.back());
      for (const AnsweredPose& pose : answered.poses) {
        if (taken.size() == takes_at_most) throw std::runtime_error("no room");
        taken.push_back(pose.result.volume);
      }
    }
    taking.fetch_sub(1);
  }

  // Adds all poses, some at once. Returns the message of the failure, or "".
  std::string run(std::size_t threads) {
    taken.clear();
    taking = 0;
    try {
      PoseSpread spread(
          threads, [&] { return [&](const PoseChunk& chunk) { return answer(chunk); }; },
          [&](const std::vector<AnsweredChunk>& answered) { take(answered); });
      for (std::size_t first = 0; first < kPoses; first += 20) {
        PoseChunk chunk{first};
        for (std::size_t k = first; k < first + 20; ++k)
          chunk.poses.push_back({{{}, {static_cast<double>(k), 0, 0}}, {}, {}});
        spread.add(chunk);
      }
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

TEST(PoseSpread, TellsThatAThreadCannotBegin) {
  PoseSpread spread(
      3, []() -> PoseSpread::Answer { throw std::runtime_error("no memory"); },
      [](const std::vector<AnsweredChunk>&) {});
  EXPECT_THROW(
      {
        spread.add({0, std::vector<AskedPose>(5)});
        spread.finish();
      },
      std::runtime_error);
}

TEST(PoseSpread, EndsWithPosesThatNobodyWaitsFor) {
  std::atomic<std::size_t> answered{0};
  {
    PoseSpread spread(
        3,
        [&] {
          return [&](const PoseChunk& chunk) {
            answered += chunk.count();
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
            return AnsweredChunk{};
          };
        },
        [](const std::vector<AnsweredChunk>&) {});
    for (int k = 0; k < 100; ++k) spread.add({0, std::vector<AskedPose>(1)});
  }
  EXPECT_LT(answered, 100);
}

// Whatever fails, each line is either taken or left.
TEST(PoseSpread, LeavesTheLinesThatWereNotTaken) {
  std::string all, taken;
  const auto answer = [](const PoseChunk& chunk) {
    AnsweredChunk answered;
    answered.text = chunk.lines.text;
    if (chunk.first + chunk.count() > 300)
      answered.failure = std::make_exception_ptr(std::runtime_error("unclear"));
    return answered;
  };
  PoseSpread spread(
      3, [&] { return answer; },
      [&](const std::vector<AnsweredChunk>& chunks) {
        for (const AnsweredChunk& answered : chunks)
          if (!answered.failure) taken += answered.text;
      });
  const auto add = [&](std::size_t first) {
    PoseChunk chunk{first};
    chunk.lines.count = 100;
    for (std::size_t k = 0; k < 100; ++k)
      chunk.lines.text += "line " + std::to_string(first + k) + "\n";
    all += chunk.lines.text;
    spread.add(chunk);
  };
  EXPECT_THROW(
      {
        for (std::size_t first = 0; first < 1000; first += 100) add(first);
        spread.finish();
      },
      std::runtime_error);
  std::string left;
  for (const PoseChunk& chunk : spread.stop()) left += chunk.lines.text;
  EXPECT_EQ(taken + left, all);
  EXPECT_FALSE(taken.empty());
}

}  // namespace
}  // namespace vpm::tools
