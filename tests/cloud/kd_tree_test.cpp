#include "libvpm/cloud/kd_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace vpm {
namespace {

std::vector<Vec3f> random_points(std::size_t count, bool on_grid) {
  std::mt19937 generator(7);
  std::vector<Vec3f> points(count);
  const auto coordinate = [&] {
    const float value = static_cast<float>(generator() >> 8) * 0x1p-24F;
    return on_grid ? std::floor(value * 8) : value;
  };
  for (Vec3f& p : points) p = {coordinate(), coordinate(), coordinate() * 0.1F};
  return points;
}

TEST(KdTree, FindsWhatASearchOverAllFinds) {
  for (const bool on_grid : {false, true}) {  // a grid has many points at one place
    for (const std::size_t count : {1U, 5U, 13U, 14U, 700U}) {
      const std::vector<Vec3f> points = random_points(count, on_grid);
      const KdTree tree(points);
      for (std::size_t i = 0; i < points.size(); i += 1 + count / 60) {
        std::vector<double> squares;
        for (const Vec3f& p : points) squares.push_back(squared_norm(widen(p) - widen(points[i])));
        std::sort(squares.begin(), squares.end());
        for (const int n : {1, 2, 7})
          ASSERT_EQ(tree.squared_distance(points[i], n),
                    squares[std::min<std::size_t>(static_cast<std::size_t>(n), count) - 1]);
      }
    }
  }
}

}  // namespace
}  // namespace vpm
