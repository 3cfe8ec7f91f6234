// Orders the items of binary trees: each node's items are halved at the median of their middles.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"

namespace vpm {

// Returns where the second half of [begin, end) begins.
inline std::size_t half_of(std::size_t begin, std::size_t end) {
  return begin + (end - begin + 1) / 2;
}

// Halves [begin, end) along the longest side of the box of the middles. Items have a `middle` and
// an `index`, of which the lower one decides between equal middles.
template <class Item>
void halve(std::vector<Item>& items, std::size_t begin, std::size_t end) {
  Box box;
  for (std::size_t k = begin; k < end; ++k) box.add(items[k].middle);
  const int axis = box.longest_axis();
  const auto place = [&](std::size_t k) { return items.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(place(begin), place(half_of(begin, end)), place(end),
                   [axis](const Item& a, const Item& b) {
                     const double p = coordinate(a.middle, axis), q = coordinate(b.middle, axis);
                     return p != q ? p < q : a.index < b.index;
                   });
}

// Halves disjoint ranges [begin, end), and their halves, down to `most` items, which is 1 or more.
// The result does not depend on the number of threads.
template <class Item>
void halve_down(std::vector<Item>& items, std::vector<std::array<std::size_t, 2>> ranges,
                std::size_t most) {
  constexpr std::size_t kTasks = 64;  // of a level
  while (!ranges.empty()) {
    std::erase_if(ranges, [&](const auto& range) { return range[1] - range[0] <= most; });
    parallel_for(ranges.size(), 1 + ranges.size() / kTasks, [&](std::size_t from, std::size_t to) {
      for (std::size_t k = from; k < to; ++k) halve(items, ranges[k][0], ranges[k][1]);
    });
    std::vector<std::array<std::size_t, 2>> halves;
    for (const auto& [begin, end] : ranges) {
      halves.push_back({begin, half_of(begin, end)});
      halves.push_back({half_of(begin, end), end});
    }
    ranges = std::move(halves);
  }
}

}  // namespace vpm
