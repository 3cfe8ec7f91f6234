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

class Region : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { set_thread_count(GetParam()); }
  void TearDown() override { set_thread_count(0); }
};

TEST_P(Region, CoversEveryIndexOnceInRangesOfTheGrain) {
  ParallelRegion region;
  for (const std::size_t count : {0U, 1U, 63U, 64U, 65U, 10000U}) {
    std::vector<int> visits(count);
    region.loop(count, 64, [&](std::size_t begin, std::size_t end) {
      EXPECT_LT(begin, end);
      EXPECT_LE(end - begin, 64U);
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
    });
    EXPECT_EQ(visits, std::vector<int>(count, 1));
  }
}

TEST_P(Region, ALoopSeesWhatTheLoopBeforeWrote) {
  constexpr std::size_t kCount = 500;
  ParallelRegion region;
  std::vector<int> a(kCount), b(kCount);
  for (int round = 1; round <= 200; ++round) {
    region.loop(kCount, 7, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) a[i] = b[kCount - 1 - i] + 1;
    });
    region.loop(kCount, 5, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) b[i] = a[kCount - 1 - i];
    });
    ASSERT_EQ(b, std::vector<int>(kCount, round));
  }
}

TEST_P(Region, TakesAGrainOfZeroForOne) {
  ParallelRegion region;
  std::vector<int> visits(5);
  region.loop(5, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) ++visits[i];
  });
  EXPECT_EQ(visits, std::vector<int>(5, 1));
}

TEST_P(Region, PassesExceptionsOnAndGoesOn) {
  ParallelRegion region;
  EXPECT_THROW(region.loop(1000, 1,
                           [](std::size_t begin, std::size_t) {
                             if (begin % 100 == 0) throw std::runtime_error("here");
                           }),
               std::runtime_error);
  std::vector<int> visits(100);
  region.loop(100, 1, [&](std::size_t begin, std::size_t) { ++visits[begin]; });
  EXPECT_EQ(visits, std::vector<int>(100, 1));
}

TEST_P(Region, MayBeWithinAnotherAndWithinParallelFor) {
  const auto count_by_region = [](std::vector<int>& visits) {
    ParallelRegion region;
    region.loop(visits.size(), 3, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) ++visits[k];
    });
  };
  std::vector<std::vector<int>> visits(40, std::vector<int>(50));
  ParallelRegion region;
  region.loop(20, 1, [&](std::size_t i, std::size_t) { count_by_region(visits[i]); });
  parallel_for(20, 1, [&](std::size_t i, std::size_t) { count_by_region(visits[20 + i]); });
  EXPECT_EQ(visits, (std::vector<std::vector<int>>(40, std::vector<int>(50, 1))));
}

INSTANTIATE_TEST_SUITE_P(Threads, Region, testing::Values(1, 2, 8),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace vpm
