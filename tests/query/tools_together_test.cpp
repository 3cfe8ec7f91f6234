// Tests poses of several tools in one call.
#include <gtest/gtest.h>
#include <vpm/device.h>

#include <cmath>
#include <deque>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

class ToolsTogether : public ::testing::Test {
 protected:
  ToolsTogether() : cloud_(testing::see(synthetic::make_scene("wall"))) {
    for (const std::uint32_t side : {5U, 2U, 4U}) {
      tools_.push_back(testing::lattice_cube(0.1 * side, side, 1));
      queries_.emplace_back(tools_.back(), QueryOptions{.stiffness = 1.0 * side});
      together_.push_back(&queries_.back());
    }
    for (std::uint32_t k = 0; k < 30; ++k)
      poses_.push_back(
          {{testing::generic_rotation(), {0.01 * k, 0.02, 0.8 + 0.01 * k}}, k * k % 3});
    results_.resize(poses_.size());
  }

  // Returns the message of the usage error.
  std::string refusal() {
    try {
      ToolQuery::run(together_, cloud_, poses_, results_);
    } catch (const Error& fault) {
      EXPECT_EQ(fault.kind(), ErrorKind::invalid_argument);
      return fault.what();
    }
    return "";
  }

  AnyBody cloud_;
  std::deque<ToolModel> tools_;
  std::deque<ToolQuery> queries_;
  std::vector<ToolQuery*> together_;
  std::vector<Job> poses_;
  std::vector<Result> results_;
};

TEST_F(ToolsTogether, AnswerAsOneByOne) {
  ToolQuery::run(together_, cloud_, poses_, results_);
  double volume = 0;
  for (std::size_t k = 0; k < poses_.size(); ++k) {
    SCOPED_TRACE(k);
    testing::expect_equal(queries_[poses_[k].tool].run(cloud_, poses_[k].pose), results_[k]);
    volume += results_[k].volume;
  }
  EXPECT_GT(volume, 0);
}

TEST_F(ToolsTogether, GiveTheSameBitsByAnyNumberOfThreads) {
  std::vector<Result> by_one(poses_.size());
  set_thread_count(1);
  ToolQuery::run(together_, cloud_, poses_, by_one);
  for (const int threads : {2, 3, 16}) {
    set_thread_count(threads);
    ToolQuery::run(together_, cloud_, poses_, results_);
    for (std::size_t k = 0; k < poses_.size(); ++k) testing::expect_equal(by_one[k], results_[k]);
  }
  set_thread_count(0);
}

TEST_F(ToolsTogether, TellTheFirstOfSeveralPosesThatAreRefused) {
  for (const std::size_t k : {7, 9, 25}) poses_[k].pose.translation.x = 1e40;
  poses_[7].pose.translation.x = std::nan("");
  std::string by_one;
  for (const int threads : {1, 2, 3, 16}) {
    set_thread_count(threads);
    std::string refusal;
    try {
      ToolQuery::run(together_, cloud_, poses_, results_);
    } catch (const Error& fault) {
      refusal = fault.what();
    }
    if (threads == 1) by_one = refusal;
    EXPECT_NE(refusal, "");
    EXPECT_EQ(refusal, by_one) << threads;
  }
  set_thread_count(0);
}

TEST_F(ToolsTogether, NoPoseIsNoQuestion) {
  ToolQuery::run({}, cloud_, {}, {});
  ToolQuery::run(together_, cloud_, {}, {});
}

TEST_F(ToolsTogether, SayWhatIsWrong) {
  poses_[3].tool = 3;
  EXPECT_NE(refusal().find("tool 3"), std::string::npos);
  poses_[3].tool = 2;
  results_.pop_back();
  EXPECT_NE(refusal().find("room for 29"), std::string::npos);
  results_.resize(poses_.size());
  ToolQuery paper(tools_[1], {.measure = Measure::paper});
  together_[1] = &paper;
  EXPECT_NE(refusal().find("same measure"), std::string::npos);
  ToolQuery coherent(tools_[1], {.coherent = true});
  together_[1] = &coherent;
  EXPECT_NE(refusal().find("one by one"), std::string::npos);
}

}  // namespace
}  // namespace vpm
