#include "libvpm/mesh/self_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/predicates.h"
#include "libvpm/mesh/triangle_bvh.h"

namespace vpm {
namespace {

constexpr std::size_t kMaxPartners = 100;
constexpr double kTouching = 1e-12;  // relative to the mesh's diagonal

struct Leaf {
  const TriangleBvh::Node* node;
  std::size_t slot;
};

bool boxes_meet(const TriangleBvh::Node& a, std::size_t i, const TriangleBvh::Node& b,
                std::size_t j, double tolerance) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double a_low = double{a.low[axis][i]}, a_high = double{a.high[axis][i]};
    const double b_low = double{b.low[axis][j]}, b_high = double{b.high[axis][j]};
    if (a_high + tolerance < b_low || b_high + tolerance < a_low) return false;
  }
  return true;
}

using Corners = std::array<Vec3, 3>;

// True if the corners of t lie in the plane of s and the two overlap there by more than the
// tolerance in every direction, which the normals of the six edges decide.
bool overlap_in_plane_of(const Corners& s, const Corners& t, double tolerance) {
  const Vec3 normal = normalized_or_zero(cross(s[1] - s[0], s[2] - s[0]));
  for (const Vec3& p : t) {
    if (std::abs(dot(normal, p - s[0])) > tolerance) return false;
  }
  for (const Corners& edges : {s, t}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 from = edges[k];
      const Vec3 across = normalized_or_zero(cross(normal, edges[(k + 1) % 3] - from));
      const auto span = [&](const Corners& c) {
        return std::minmax(
            {dot(across, c[0] - from), dot(across, c[1] - from), dot(across, c[2] - from)});
      };
      const auto [s_low, s_high] = span(s);
      const auto [t_low, t_high] = span(t);
      if (s_high <= t_low + tolerance || t_high <= s_low + tolerance) return false;
    }
  }
  return true;
}

class Search {
 public:
  // A negative tolerance finds true intersections only.
  Search(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
         double tolerance)
      : vertices_(vertices),
        triangles_(triangles),
        tolerance_(tolerance),
        bvh_(vertices, triangles) {
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

  std::vector<TrianglePair> all() const {
    std::vector<std::vector<TrianglePair>> found(leaves_.size());
    constexpr std::size_t kGrain = 16;
    parallel_for(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) found[k] = partners_of(leaves_[k]);
    });
    std::vector<TrianglePair> pairs;
    for (const std::vector<TrianglePair>& part : found)
      pairs.insert(pairs.end(), part.begin(), part.end());
    std::sort(pairs.begin(), pairs.end());
    return pairs;
  }

 private:
  // Returns pairs of a triangle of this leaf and a later one in the hierarchy's order.
  std::vector<TrianglePair> partners_of(const Leaf& leaf) const {
    std::vector<TrianglePair> pairs;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const TriangleBvh::Node& node = bvh_.nodes()[stack.back()];
      stack.pop_back();
      for (std::size_t slot = 0; slot < 4; ++slot) {
        if (node.count[slot] == 0 && node.child[slot] == 0) continue;
        if (!boxes_meet(*leaf.node, leaf.slot, node, slot, std::max(tolerance_, 0.0))) continue;
        if (node.count[slot] == 0) {
          stack.push_back(node.child[slot]);
        } else if (node.child[slot] >= leaf.node->child[leaf.slot]) {
          compare(leaf, {&node, slot}, pairs);
        }
        if (pairs.size() >= kMaxPartners * leaf.node->count[leaf.slot]) return pairs;
      }
    }
    return pairs;
  }

  void compare(const Leaf& one, const Leaf& other, std::vector<TrianglePair>& pairs) const {
    const std::uint32_t one_begin = one.node->child[one.slot],
                        other_begin = other.node->child[other.slot];
    for (std::uint32_t i = one_begin; i < one_begin + one.node->count[one.slot]; ++i) {
      const std::uint32_t first = std::max(i + 1, other_begin);
      for (std::uint32_t j = first; j < other_begin + other.node->count[other.slot]; ++j) {
        const std::uint32_t s = bvh_.corners()[i].triangle, t = bvh_.corners()[j].triangle;
        if (flat_[s] != 0 || flat_[t] != 0) continue;
        if (meet(s, t)) pairs.emplace_back(std::min(s, t), std::max(s, t));
      }
    }
  }

  bool meet(std::uint32_t s, std::uint32_t t) const {
    if (tolerance_ >= 0) {
      const Corners a = corners_of(s), b = corners_of(t);
      if (overlap_in_plane_of(a, b, tolerance_) || overlap_in_plane_of(b, a, tolerance_))
        return true;
    }
    return triangles_intersect(vertices_, triangles_[s], triangles_[t]);
  }

  Corners corners_of(std::uint32_t t) const {
    const auto [a, b, c] = triangles_[t];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle>& triangles_;
  double tolerance_;
  TriangleBvh bvh_;
  std::vector<Leaf> leaves_;
  std::vector<char> flat_;
};

}  // namespace

std::vector<TrianglePair> find_self_intersections(const std::vector<Vec3>& vertices,
                                                  const std::vector<Triangle>& triangles) {
  return triangles.empty() ? std::vector<TrianglePair>{} : Search(vertices, triangles, -1).all();
}

double contact_tolerance(const std::vector<Vec3>& vertices) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  for (const Vec3& p : vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double farthest = std::max(norm(low), norm(high));
  return kTouching * norm(high - low) + 8 * std::numeric_limits<double>::epsilon() * farthest;
}

std::vector<TrianglePair> find_contacts(const std::vector<Vec3>& vertices,
                                        const std::vector<Triangle>& triangles) {
  return triangles.empty() ? std::vector<TrianglePair>{}
                           : Search(vertices, triangles, contact_tolerance(vertices)).all();
}

}  // namespace vpm
