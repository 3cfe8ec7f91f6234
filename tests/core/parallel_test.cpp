#include "libvpm/core/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace vpm {
namespace {

class Parallel : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(Parallel, CoversEveryIndexOnceInRangesOfTheGrain) {
  for (const std::size_t count : {0U, 1U, 63U, 64U, 65U, 10000U}) {
    std::vector<int> visits(count);
    parallel_for(count, 64, [&](std::size_t begin, std::size_t end) {
      EXPECT_LT(begin, end);
      EXPECT_LE(end - begin, 64U);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(count, 1));
  }
}

TEST_P(Parallel, TakesAGrainOfZeroForOne) {
  std::vector<int> visits(5);
  parallel_for(5, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  EXPECT_EQ(visits, std::vector<int>(5, 1));
}

TEST_P(Parallel, PassesExceptionsOn) {
  EXPECT_THROW(parallel_for(1000, 1,
                            [](std::size_t begin, std::size_t) {
                              if (begin == 500) throw std::runtime_error("here");
                            }),
               std::runtime_error);
}

TEST_P(Parallel, MayBeNested) {
  std::vector<std::vector<int>> visits(20, std::vector<int>(50));
  parallel_for(20, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      parallel_for(50, 3, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) ++visits[i][k];
      });
    }
  });
  EXPECT_EQ(visits, (std::vector<std::vector<int>>(20, std::vector<int>(50, 1))));
}

INSTANTIATE_TEST_SUITE_P(Threads, Parallel, testing::Values(1, 2, 8),
                         testing::PrintToStringParamName());

TEST(ThreadCount, IsWhatWasSet) {
  set_thread_count(3);
  EXPECT_EQ(thread_count(), 3);
  set_thread_count(0);
  EXPECT_GE(thread_count(), 1);
}

}  // namespace
}  // namespace vpm
