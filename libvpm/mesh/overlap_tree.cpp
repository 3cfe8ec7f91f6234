#include "libvpm/mesh/overlap_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/halving.h"

namespace vpm {
namespace {

constexpr std::size_t kLeafItems = 4;
// Items up to which a group has an oriented box: its cost is linear in them on each level.
constexpr std::size_t kOrientedItems = 64;
// Rounding of an oriented box relative to the coordinates: far more than that of a few products.
constexpr double kRounding = 1e-12;

Box box_of(const OverlapTree::Item& item) {
  Box box;
  for (const Vec3& p : item.points) box.add(p);
  const Vec3 pad{item.pad, item.pad, item.pad};
  return {box.low - pad, box.high + pad};
}

}  // namespace

struct OverlapTree::Build {
  // Item, or run of items of one family, with the middle by which it is sorted.
  struct Sorted {
    Vec3 middle;
    std::uint32_t index;           // of the item, the first one of a run
    std::uint32_t begin, end = 0;  // bounds of a run
  };

  OverlapTree& tree;
  const std::vector<Item>& items;
  std::vector<Sorted> order;

  const Item& at(std::size_t k) const { return items[order[k].index]; }

  Build(OverlapTree& of, const std::vector<Item>& all) : tree(of), items(all) {
    order.reserve(items.size());
    for (std::uint32_t k = 0; k < items.size(); ++k) {
      const auto& [a, b, c] = items[k].points;
      order.push_back({(a + b + c) / 3, k, k});
    }
  }

  // Puts items of a family side by side, and families near each other: each family is a subtree of
  // its own, and all items without one are one more run. Orders the items of each run for its
  // subtree. Returns where the runs end.
  std::vector<std::size_t> sort_items() {
    std::sort(order.begin(), order.end(), [&](const Sorted& a, const Sorted& b) {
      const std::uint32_t p = items[a.index].family, q = items[b.index].family;
      return p != q ? p < q : a.index < b.index;
    });
    std::vector<Sorted> runs;
    for (std::uint32_t k = 0; k < order.size(); ++k) {
      if (k == 0 || at(k).family != at(k - 1).family)
        runs.push_back({order[k].middle, order[k].index, k});
      runs.back().end = k + 1;
    }
    halve_down(runs, {{0, runs.size()}}, 1);
    std::vector<Sorted> sorted;
    sorted.reserve(order.size());
    std::vector<std::size_t> ends;
    std::vector<std::array<std::size_t, 2>> ranges;
    for (const Sorted& run : runs) {
      ranges.push_back({sorted.size(), sorted.size() + run.end - run.begin});
      sorted.insert(sorted.end(), order.begin() + run.begin, order.begin() + run.end);
      ends.push_back(sorted.size());
    }
    order = std::move(sorted);
    halve_down(order, std::move(ranges), kLeafItems);
    return ends;
  }

  // Returns the node of [begin, end), all of one family.
  std::uint32_t node_of(std::size_t begin, std::size_t end) {
    const auto index = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_.push_back({{}, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
    std::uint32_t left = 0, right = 0;
    if (end - begin > kLeafItems) {
      const std::size_t half = half_of(begin, end);
      left = node_of(begin, half);
      right = node_of(half, end);
    }
    finish(index, left, right);
    return index;
  }

  // Returns a node over the runs [first, last), given the ends of all.
  std::uint32_t node_over(const std::vector<std::size_t>& ends, std::size_t first,
                          std::size_t last) {
    const std::size_t begin = first == 0 ? 0 : ends[first - 1], end = ends[last - 1];
    if (last - first == 1) return node_of(begin, end);
    const auto index = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_.push_back({{}, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
    const std::size_t half = half_of(first, last);
    const std::uint32_t left = node_over(ends, first, half), right = node_over(ends, half, last);
    finish(index, left, right);
    return index;
  }

  void finish(std::uint32_t index, std::uint32_t left, std::uint32_t right) {
    Node& node = tree.nodes_[index];
    node.left = left;
    node.right = right;
    node.family = at(node.begin).family;
    if (left == 0) {
      for (std::size_t k = node.begin; k < node.end; ++k) node.box.add_box(box_of(at(k)));
    } else {
      for (const std::uint32_t child : {left, right}) {
        node.box.add_box(tree.nodes_[child].box);
        if (tree.nodes_[child].family != node.family) node.family = kNone;
      }
    }
  }

  // Gives groups of few items their oriented boxes.
  void orient() {
    std::vector<std::array<std::uint32_t, 2>> groups;  // first item, end
    for (Node& node : tree.nodes_) {
      if (node.end - node.begin > kOrientedItems) continue;
      node.oriented = static_cast<std::uint32_t>(groups.size());
      groups.push_back({node.begin, node.end});
    }
    tree.oriented_.resize(groups.size());
    constexpr std::size_t kTogether = 256;
    parallel_for(groups.size(), kTogether, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        tree.oriented_[k] = oriented_box(groups[k][0], groups[k][1]);
    });
  }

  // Returns the point of [begin, end) for which `measure` is largest.
  template <class Measure>
  Vec3 farthest(std::size_t begin, std::size_t end, Measure measure) const {
    Vec3 best = at(begin).points[0];
    double most = measure(best);
    for (std::size_t k = begin; k < end; ++k) {
      for (const Vec3& p : at(k).points) {
        if (const double size = measure(p); size > most) most = size, best = p;
      }
    }
    return best;
  }

  // Takes the first axis between points far apart, the second towards the point farthest from it.
  Oriented oriented_box(std::size_t begin, std::size_t end) const {
    const Vec3 start = at(begin).points[0];
    const Vec3 from = farthest(begin, end, [&](Vec3 p) { return squared_norm(p - start); });
    const Vec3 to = farthest(begin, end, [&](Vec3 p) { return squared_norm(p - from); });
    std::array<Vec3, 3> axis{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    const Vec3 along = normalized_or_zero(to - from);
    if (squared_norm(along) > 0) {
      const auto across = [&](Vec3 p) { return (p - from) - dot(along, p - from) * along; };
      const Vec3 widest = farthest(begin, end, [&](Vec3 p) { return squared_norm(across(p)); });
      Vec3 second = normalized_or_zero(across(widest));
      second = normalized_or_zero(second - dot(along, second) * along);
      if (squared_norm(second) == 0) {  // on a line
        const Vec3 least = std::abs(along.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
        second = normalized_or_zero(cross(along, least));
      }
      axis = {along, second, cross(along, second)};
    }
    return box_along(axis, from, begin, end);
  }

  Oriented box_along(const std::array<Vec3, 3>& axis, Vec3 origin, std::size_t begin,
                     std::size_t end) const {
    std::array<double, 3> low{}, high{};
    double pad = 0, size = 0;
    for (std::size_t k = begin; k < end; ++k) {
      pad = std::max(pad, at(k).pad);
      for (const Vec3& p : at(k).points) {
        size = std::max({size, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        for (std::size_t a = 0; a < 3; ++a) {
          const double at = dot(axis[a], p - origin);
          low[a] = std::min(low[a], at);
          high[a] = std::max(high[a], at);
        }
      }
    }
    Oriented box{origin, axis};
    pad += kRounding * size;
    for (std::size_t a = 0; a < 3; ++a) {
      box.center += 0.5 * (low[a] + high[a]) * axis[a];
      box.axis[a] = (0.5 * (high[a] - low[a]) + pad) * axis[a];
    }
    return box;
  }
};

OverlapTree::OverlapTree(const std::vector<Item>& items) {
  if (items.empty()) return;
  Build build(*this, items);
  nodes_.reserve(items.size());
  const std::vector<std::size_t> ends = build.sort_items();
  build.node_over(ends, 0, ends.size());
  build.orient();
  places_.reserve(items.size());
  for (const Build::Sorted& s : build.order)
    places_.push_back({box_of(items[s.index]), s.index, items[s.index].family});
  for (std::uint32_t k = 0; k < nodes_.size(); ++k) {
    if (nodes_[k].left == 0) leaves_.push_back(k);
  }
}

// Tests the six directions of the boxes' faces. Those across an edge of each would part a few more
// pairs of boxes, at three times the cost.
bool OverlapTree::meet(const Oriented& a, const Oriented& b) {
  const Vec3 between = b.center - a.center;
  const auto reach = [](const Oriented& box, Vec3 d) {
    return std::abs(dot(box.axis[0], d)) + std::abs(dot(box.axis[1], d)) +
           std::abs(dot(box.axis[2], d));
  };
  const auto apart = [&](Vec3 d) { return std::abs(dot(between, d)) > reach(a, d) + reach(b, d); };
  for (std::size_t k = 0; k < 3; ++k) {
    if (apart(a.axis[k]) || apart(b.axis[k])) return false;
  }
  return true;
}

}  // namespace vpm
