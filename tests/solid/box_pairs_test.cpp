// The pairs of boxes that meet, against the question asked of every pair.
#include "libvpm/solid/box_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace vpm {
namespace {

// Returns boxes of whole coordinates, so that many of them touch.
std::vector<Box> random_boxes(std::size_t count, std::mt19937_64& random) {
  std::uniform_int_distribution<int> place(0, 40), size(0, 6);
  std::vector<Box> boxes(count);
  for (Box& box : boxes) {
    const Vec3 low{double(place(random)), double(place(random)), double(place(random))};
    box.add(low);
    box.add(low + Vec3{double(size(random)), double(size(random)), double(size(random))});
  }
  return boxes;
}

bool meet(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k)
    if (coordinate(a.low, k) > coordinate(b.high, k) ||
        coordinate(b.low, k) > coordinate(a.high, k))
      return false;
  return true;
}

std::vector<BoxPair> by_asking_all(const std::vector<Box>& boxes) {
  std::vector<BoxPair> pairs;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = i + 1; j < boxes.size(); ++j)
      if (meet(boxes[i], boxes[j])) pairs.push_back({i, j});
  return pairs;
}

TEST(BoxPairs, AreThoseThatMeet) {
  std::mt19937_64 random(1);
  for (const std::size_t count : {0, 1, 2, 50, 400}) {
    const std::vector<Box> boxes = random_boxes(count, random);
    EXPECT_EQ(boxes_that_meet(boxes), by_asking_all(boxes));
  }
}

TEST(BoxPairs, OfOnePlaceAreAll) {
  const std::vector<Box> boxes(9, Box{{1, 2, 3}, {1, 2, 3}});
  EXPECT_EQ(boxes_that_meet(boxes), by_asking_all(boxes));
  EXPECT_EQ(boxes_that_meet(boxes).size(), 36U);
}

}  // namespace
}  // namespace vpm
