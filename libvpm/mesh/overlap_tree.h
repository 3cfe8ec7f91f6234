// Broad phase for triangles and their like: finds pairs of items whose volumes may meet.
//
// Boxes along the axes say little about long and thin items: those of two fans over one rim all
// overlap. So groups of a few items also have an oriented box (Gottschalk, Lin, Manocha 1996,
// "OBBTree: a hierarchical structure for rapid interference detection").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/core/vec3.h"

namespace vpm {

class OverlapTree {
 public:
  static constexpr std::uint32_t kNone = 0xffffffff;

  // Convex hull of three points, widened by `pad` on all sides. Items of one family, unless kNone,
  // are never paired with one another.
  struct Item {
    std::array<Vec3, 3> points;
    double pad = 0;
    std::uint32_t family = kNone;
  };

  explicit OverlapTree(const std::vector<Item>& items);

  // Number of groups of few items, which begin searches.
  std::size_t groups() const { return leaves_.size(); }

  // Calls visit(i, j) once for each pair of items of which the one in group `group` comes first in
  // the tree's order, if their boxes meet. Returns the number of comparisons. Thread-safe.
  template <class Visit>
  std::uint64_t pairs_of(std::size_t group, Visit visit) const {
    const Node& leaf = nodes_[leaves_[group]];
    std::uint64_t compared = 0;
    // Holds at most one sibling of each level, and there are fewer than 70 levels: they halve the
    // runs of families, then the items of one.
    std::array<std::uint32_t, 128> stack;
    std::size_t top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Node& node = nodes_[stack[--top]];
      ++compared;
      if (node.end <= leaf.begin || !may_meet(leaf, node)) continue;
      if (node.left != 0) {
        stack[top++] = node.right;
        stack[top++] = node.left;
        continue;
      }
      for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
        for (std::uint32_t j = std::max(i + 1, node.begin); j < node.end; ++j) {
          ++compared;
          const Place &a = places_[i], &b = places_[j];
          if ((a.family == kNone || a.family != b.family) && meet(a.box, b.box))
            visit(a.item, b.item);
        }
      }
    }
    return compared;
  }

 private:
  struct Oriented {
    Vec3 center;
    std::array<Vec3, 3> axis;  // times half of the extent along it
  };
  struct Place {
    Box box;
    std::uint32_t item, family;
  };
  struct Node {
    Box box;
    std::uint32_t begin, end;           // places below
    std::uint32_t left = 0, right = 0;  // 0 in leaves
    std::uint32_t family = kNone;       // family of all items below, if they have the same
    std::uint32_t oriented = kNone;
  };
  struct Build;

  static bool meet(const Box& a, const Box& b) {
    return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y &&
           b.low.y <= a.high.y && a.low.z <= b.high.z && b.low.z <= a.high.z;
  }
  static bool meet(const Oriented& a, const Oriented& b);
  bool may_meet(const Node& a, const Node& b) const {
    if (!meet(a.box, b.box) || (a.family != kNone && a.family == b.family)) return false;
    return a.oriented == kNone || b.oriented == kNone ||
           meet(oriented_[a.oriented], oriented_[b.oriented]);
  }

  std::vector<Place> places_;
  std::vector<Node> nodes_;
  std::vector<Oriented> oriented_;
  std::vector<std::uint32_t> leaves_;
};

}  // namespace vpm
