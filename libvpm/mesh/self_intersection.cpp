#include "libvpm/mesh/self_intersection.h"

#include <algorithm>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/triangle_intersection.h"

namespace vpm {
namespace {

constexpr std::size_t kMostPartners = 100;

using Pair = std::pair<std::uint32_t, std::uint32_t>;

struct Leaf {
  const TriangleBvh::Node* node;
  std::size_t slot;
};

bool boxes_meet(const TriangleBvh::Node& a, std::size_t i, const TriangleBvh::Node& b,
                std::size_t j) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (a.high[axis][i] < b.low[axis][j] || b.high[axis][j] < a.low[axis][i]) return false;
  }
  return true;
}

class Search {
 public:
  Search(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles)
      : vertices_(vertices), triangles_(triangles), bvh_(vertices, triangles) {
    for (const TriangleBvh::Node& node : bvh_.nodes()) {
      for (std::size_t slot = 0; slot < 4; ++slot) {
        if (node.count[slot] > 0) leaves_.push_back({&node, slot});
      }
    }
    flat_.resize(triangles.size());
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const Triangle& t = triangles[k];
      flat_[k] = has_area(vertices[t[0]], vertices[t[1]], vertices[t[2]]) ? 0 : 1;
    }
  }

  std::vector<Pair> all() const {
    std::vector<std::vector<Pair>> found(leaves_.size());
    constexpr std::size_t kGrain = 16;
    parallel_for(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) found[k] = partners_of(leaves_[k]);
    });
    std::vector<Pair> pairs;
    for (const std::vector<Pair>& part : found) pairs.insert(pairs.end(), part.begin(), part.end());
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  // Pairs of a triangle of this leaf with one that comes later in the order of the hierarchy.
  std::vector<Pair> partners_of(const Leaf& leaf) const {
    std::vector<Pair> pairs;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const TriangleBvh::Node& node = bvh_.nodes()[stack.back()];
      stack.pop_back();
      for (std::size_t slot = 0; slot < 4; ++slot) {
        if (node.count[slot] == 0 && node.child[slot] == 0) continue;
        if (!boxes_meet(*leaf.node, leaf.slot, node, slot)) continue;
        if (node.count[slot] == 0) {
          stack.push_back(node.child[slot]);
        } else if (node.child[slot] >= leaf.node->child[leaf.slot]) {
          compare(leaf, {&node, slot}, pairs);
        }
        if (pairs.size() >= kMostPartners * leaf.node->count[leaf.slot]) return pairs;
      }
    }
    return pairs;
  }

  void compare(const Leaf& one, const Leaf& other, std::vector<Pair>& pairs) const {
    const std::uint32_t one_begin = one.node->child[one.slot],
                        other_begin = other.node->child[other.slot];
    for (std::uint32_t i = one_begin; i < one_begin + one.node->count[one.slot]; ++i) {
      const std::uint32_t first = std::max(i + 1, other_begin);
      for (std::uint32_t j = first; j < other_begin + other.node->count[other.slot]; ++j) {
        const std::uint32_t s = bvh_.corners()[i].triangle, t = bvh_.corners()[j].triangle;
        if (flat_[s] != 0 || flat_[t] != 0) continue;
        if (triangles_intersect(vertices_, triangles_[s], triangles_[t]))
          pairs.emplace_back(std::min(s, t), std::max(s, t));
      }
    }
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle>& triangles_;
  TriangleBvh bvh_;
  std::vector<Leaf> leaves_;
  std::vector<char> flat_;
};

}  // namespace

SelfIntersections find_self_intersections(const std::vector<Vec3>& vertices,
                                          const std::vector<Triangle>& triangles) {
  SelfIntersections result;
  if (triangles.empty()) return result;
  const std::vector<Pair> pairs = Search(vertices, triangles).all();
  result.pairs = pairs.size();
  for (const Pair& pair : pairs) {
    if (result.first_triangles.size() == SelfIntersections::kListed) break;
    if (result.first_triangles.empty() || result.first_triangles.back() != pair.first)
      result.first_triangles.push_back(pair.first);
  }
  return result;
}

}  // namespace vpm
