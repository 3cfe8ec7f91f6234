#include "libvpm/cloud/row_bands.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

TEST(RowBands, CoverEveryRowOnce) {
  for (const int threads : {1, 3}) {
    set_thread_count(threads);
    for (const int height : {0, 1, kRowsPerBand, kRowsPerBand + 1, 10 * kRowsPerBand - 1}) {
      std::vector<int> times(static_cast<std::size_t>(height));
      for_bands(height, [&](int begin, int end) {
        EXPECT_EQ(begin % kRowsPerBand, 0);
        for (int v = begin; v < end; ++v) ++times[static_cast<std::size_t>(v)];
      });
      EXPECT_EQ(std::count(times.begin(), times.end(), 1), height);
    }
  }
  set_thread_count(0);
}

// Makes the bands of rows in several orders.
TEST(FollowingRows, FollowOnceAndNotBeforeWhatTheyRead) {
  std::mt19937 random(3);
  FollowingRows following;
  for (const int reach : {0, 1, 4, FollowingRows::kMostReach}) {
    for (int height = 1; height < 5 * kRowsPerBand; height += height < 80 ? 1 : 7) {
      std::vector<int> bands((static_cast<std::size_t>(height) - 1) / kRowsPerBand + 1);
      std::iota(bands.begin(), bands.end(), 0);
      std::shuffle(bands.begin(), bands.end(), random);
      std::vector<int> is_made(static_cast<std::size_t>(height)), followed = is_made;
      following.start(height, reach);
      for (const int band : bands) {
        const int begin = band * kRowsPerBand;
        for (int v = begin; v < std::min(begin + kRowsPerBand, height); ++v) {
          is_made[static_cast<std::size_t>(v)] = 1;
          following.made(v, [&](int first, int last) {
            ASSERT_LT(first, last);
            const auto from = is_made.begin() + std::max(first - reach, 0),
                       to = is_made.begin() + std::min(last + reach, height);
            EXPECT_EQ(std::count(from, to, 1), to - from)
                << "rows " << first << " to " << last << " of " << height << ", reach " << reach;
            for (int k = first; k < last; ++k) ++followed[static_cast<std::size_t>(k)];
          });
        }
      }
      EXPECT_EQ(std::count(followed.begin(), followed.end(), 1), height) << "reach " << reach;
    }
  }
}

// Reads rows that several threads made; the thread sanitizer shows races here.
TEST(FollowingRows, SeeWhatOtherThreadsMade) {
  constexpr int kHeight = 20 * kRowsPerBand, kReach = 4;
  set_thread_count(4);
  FollowingRows following;
  for (int repeat = 0; repeat < 50; ++repeat) {
    std::vector<int> made(kHeight), sums(kHeight);
    following.start(kHeight, kReach);
    for_bands(kHeight, [&](int begin, int end) {
      for (int v = begin; v < end; ++v) {
        made[static_cast<std::size_t>(v)] = v + 1;
        following.made(v, [&](int first, int last) {
          for (int k = first; k < last; ++k) {
            for (int d = std::max(k - kReach, 0); d <= std::min(k + kReach, kHeight - 1); ++d)
              sums[static_cast<std::size_t>(k)] += made[static_cast<std::size_t>(d)];
          }
        });
      }
    });
    for (int k = kReach; k < kHeight - kReach; ++k)
      ASSERT_EQ(sums[static_cast<std::size_t>(k)], (2 * kReach + 1) * (k + 1));
  }
  set_thread_count(0);
}

}  // namespace
}  // namespace vpm
