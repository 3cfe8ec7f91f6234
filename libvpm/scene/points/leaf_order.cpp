#include "libvpm/scene/points/leaf_order.h"

#include <algorithm>

#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/points/point_tree.h"

namespace vpm {
namespace {

// Holds a point and its rank in the given order.
struct Ranked {
  float at[3];
  std::uint32_t rank;
};

// Partitions points along the longest side of their box, the `count` lower ones first.
void part(std::span<Ranked> points, std::size_t count) {
  Box box;
  for (const Ranked& p : points) box.add({p.at[0], p.at[1], p.at[2]});
  const int axis = box.longest_axis();
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(count),
                   points.end(), [axis](const Ranked& a, const Ranked& b) {
                     return a.at[axis] != b.at[axis] ? a.at[axis] < b.at[axis] : a.rank < b.rank;
                   });
}

// Calls body(points) for the nodes of one level, which hold `size` points each.
template <class Body>
void for_nodes(std::span<Ranked> all, std::size_t size, const Body& body) {
  constexpr std::size_t kGrain = 8192;  // points
  parallel_for((all.size() + size - 1) / size, std::max<std::size_t>(kGrain / size, 1),
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t k = begin; k < end; ++k)
                   body(all.subspan(k * size, std::min(size, all.size() - k * size)));
               });
}

}  // namespace

void order_by_leaves(std::span<const Vec3f> points, std::vector<std::uint32_t>& order) {
  std::vector<Ranked> ranked(order.size());
  for (std::uint32_t rank = 0; rank < order.size(); ++rank) {
    const Vec3f p = points[order[rank]];
    ranked[rank] = {{p.x, p.y, p.z}, rank};
  }
  constexpr std::size_t kLeaf = PointTree::kLeafSize;
  for (std::size_t size = kLeaf * leaves_for(order.size()); size > kLeaf; size /= 2) {
    for_nodes(ranked, size, [&](std::span<Ranked> node) {
      if (node.size() > size / 2) part(node, size / 2);
    });
  }
  for_nodes(ranked, kLeaf, [](std::span<Ranked> leaf) {
    std::sort(leaf.begin(), leaf.end(),
              [](const Ranked& a, const Ranked& b) { return a.rank < b.rank; });
  });
  const std::vector<std::uint32_t> given = order;
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = given[ranked[i].rank];
}

}  // namespace vpm
