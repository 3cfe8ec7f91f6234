#include "libvpm/solid/box_pairs.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace vpm {
namespace {

double middle(const Box& box, int axis) {
  return 0.5 * coordinate(box.low, axis) + 0.5 * coordinate(box.high, axis);
}

// Returns the axis with the largest variance of the boxes' middles; the lowest one on ties.
int axis_of_sweep(std::span<const Box> boxes) {
  std::array<double, 3> variance{};
  for (int axis = 0; axis < 3; ++axis) {
    double mean = 0;
    for (const Box& box : boxes) mean += middle(box, axis) / static_cast<double>(boxes.size());
    for (const Box& box : boxes) {
      const double off = middle(box, axis) - mean;
      variance[static_cast<std::size_t>(axis)] += off * off;
    }
  }
  return static_cast<int>(std::ranges::max_element(variance) - variance.begin());
}

bool meet_along(const Box& a, const Box& b, int axis) {
  return coordinate(a.low, axis) <= coordinate(b.high, axis) &&
         coordinate(b.low, axis) <= coordinate(a.high, axis);
}

}  // namespace

std::vector<BoxPair> boxes_that_meet(std::span<const Box> boxes) {
  const int axis = axis_of_sweep(boxes), second_axis = (axis + 1) % 3, third_axis = (axis + 2) % 3;
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return coordinate(boxes[k].low, axis); });
  std::vector<BoxPair> pairs;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Box& box = boxes[order[i]];
    const double end = coordinate(box.high, axis);
    for (std::size_t j = i + 1; j < order.size(); ++j) {
      const Box& other = boxes[order[j]];
      if (coordinate(other.low, axis) > end) break;
      if (!meet_along(box, other, second_axis) || !meet_along(box, other, third_axis)) continue;
      pairs.push_back({std::min(order[i], order[j]), std::max(order[i], order[j])});
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace vpm
