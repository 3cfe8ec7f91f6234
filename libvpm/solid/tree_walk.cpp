#include "libvpm/solid/tree_walk.h"

#include <bit>
#include <cmath>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"

namespace vpm {
namespace {

using vpm::absolute, vpm::mask_of;

[[gnu::always_inline]] inline Floats absolute(const Floats& v) {
  return reinterpret_cast<Floats>(reinterpret_cast<Ints>(v) & 0x7fffffff);
}

// Returns a bit per lane that is set.
[[gnu::always_inline]] inline unsigned mask_of(const Ints& lanes) {
  std::array<Int4, 2> halves;
  std::memcpy(&halves, &lanes, sizeof halves);
  return mask_of(halves[0]) | mask_of(halves[1]) << 4;
}

// Returns a row of a node's bounds in the lower lanes. The upper ones, which are not used, hold
// what follows the row: the node does not end with one.
[[gnu::always_inline]] inline Floats row(const Float4& v) {
  return load<Floats>(reinterpret_cast<const float*>(&v));
}
// Returns four numbers of b, and behind them four of a.
[[gnu::always_inline]] inline Floats side_by_side(const Float4& b, const Float4& a) {
  return __builtin_shuffle(row(b), row(a), Ints{0, 1, 2, 3, 8, 9, 10, 11});
}
// The eight lanes of a vector stand for eight pairs of children: two children of one node, each
// with all four of another. These functions give each lane the value that belongs to its child.
// twice() repeats the values of the four children, which lie in the lower four lanes; upper_twice()
// does so from the upper four. fourfold() repeats the values of the two children, which lie in the
// lanes `first` (0 or 2) and `first` + 1, four times each.
[[gnu::always_inline]] inline Floats twice(const Floats& v) {
  return __builtin_shuffle(v, Ints{0, 1, 2, 3, 0, 1, 2, 3});
}
[[gnu::always_inline]] inline Floats upper_twice(const Floats& v) {
  return __builtin_shuffle(v, Ints{4, 5, 6, 7, 4, 5, 6, 7});
}
[[gnu::always_inline]] inline Floats fourfold(const Floats& v, int first) {
  return first == 0 ? __builtin_shuffle(v, Ints{0, 0, 0, 0, 1, 1, 1, 1})
                    : __builtin_shuffle(v, Ints{2, 2, 2, 2, 3, 3, 3, 3});
}

// A node is opened alone where it is more than so many times as large as the other.
constexpr float kLarger = 2;

}  // namespace

PlacedBounds::PlacedBounds(const SurfaceBounds& piece, const Pose& pose)
    : pose_(pose), own_half_(piece.half), width_(piece.width) {
  const auto& r = pose_.rotation;
  const auto& s = pose_.size;
  const auto &c = piece.center, &h = piece.half, &n = piece.normal;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = 3 * i;
    center_[i] = r[k] * c[0] + r[k + 1] * c[1] + r[k + 2] * c[2] + pose_.translation[i];
    half_[i] = s[k] * h[0] + s[k + 1] * h[1] + s[k + 2] * h[2];
    normal_[i] = r[k] * n[0] + r[k + 1] * n[1] + r[k + 2] * n[2];
  }
  offset_ = piece.offset - (n[0] * c[0] + n[1] * c[1] + n[2] * c[2]);
}

unsigned PlacedBounds::children_that_meet(const SurfaceTree::Node& node) const {
  const auto& r = pose_.rotation;
  const auto& s = pose_.size;
  const auto &n = normal_, &c = center_;
  const auto &h = node.half, &own = node.normal;
  const Float4 d0 = node.center[0] - c[0], d1 = node.center[1] - c[1], d2 = node.center[2] - c[2];
  // Boxes along the axes of the node's frame.
  Int4 meets = (absolute(d0) <= h[0] + half_[0]) & (absolute(d1) <= h[1] + half_[1]) &
               (absolute(d2) <= h[2] + half_[2]);
  if (mask_of(meets) == 0) return 0;
  // The piece's slab, about its box's centre.
  meets &= absolute(n[0] * d0 + n[1] * d1 + n[2] * d2 - offset_) <=
           width_ + std::fabs(n[0]) * h[0] + std::fabs(n[1]) * h[1] + std::fabs(n[2]) * h[2];
  // The slabs of the children, and boxes along the axes of the piece's frame.
  Float4 reach = node.width;
  for (std::size_t j = 0; j < 3; ++j) {
    reach += absolute(own[0] * r[j] + own[1] * r[3 + j] + own[2] * r[6 + j]) * own_half_[j];
    meets &= absolute(r[j] * d0 + r[3 + j] * d1 + r[6 + j] * d2) <=
             own_half_[j] + s[j] * h[0] + s[3 + j] * h[1] + s[6 + j] * h[2];
  }
  meets &= absolute(own[0] * c[0] + own[1] * c[1] + own[2] * c[2] - node.offset) <= reach;
  return mask_of(meets);
}

namespace {

// Rows of the rotation from b's frame to a's in the lower lanes, and from a's to b's in the upper
// ones; and their magnitudes, a little more.
struct BothWays {
  std::array<Floats, 9> rotation, size;
};

[[gnu::always_inline]] inline BothWays both_ways(const FloatPose& pose) {
  const auto lanes = [](float there, float back) __attribute__((always_inline)) {
    return Floats{there, there, there, there, back, back, back, back};
  };
  BothWays ways;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t there = 3 * i + j, back = 3 * j + i;
      ways.rotation[there] = lanes(pose.rotation[there], pose.rotation[back]);
      ways.size[there] = lanes(pose.size[there], pose.size[back]);
    }
  return ways;
}

// Holds what the tests of a's children against b's share: b's bounds, in the lower lanes.
struct Placed {
  std::array<Floats, 3> center, half;  // of b, in a's frame and in its own
  Floats offset, width;                // of b's slabs, from the centres of their boxes
  // Normals, and halves of boxes, of b along a's axes, and in the upper lanes of a along b's.
  std::array<Floats, 3> normal, spread;
};

[[gnu::always_inline]] inline Placed placed(const SurfaceTree::Node& a, const SurfaceTree::Node& b,
                                            const FloatPose& pose, const BothWays& ways) {
  const auto& r = pose.rotation;
  std::array<Floats, 3> c, n, half, normal;
  Placed at;
  for (std::size_t i = 0; i < 3; ++i) {
    c[i] = row(b.center[i]), at.half[i] = row(b.half[i]), n[i] = row(b.normal[i]);
    half[i] = side_by_side(b.half[i], a.half[i]);
    normal[i] = side_by_side(b.normal[i], a.normal[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t k = 3 * i;
    const auto &turn = ways.rotation, &size = ways.size;
    at.center[i] = r[k] * c[0] + r[k + 1] * c[1] + r[k + 2] * c[2] + pose.translation[i];
    at.normal[i] = turn[k] * normal[0] + turn[k + 1] * normal[1] + turn[k + 2] * normal[2];
    at.spread[i] = size[k] * half[0] + size[k + 1] * half[1] + size[k + 2] * half[2];
  }
  at.offset = row(b.offset) - (n[0] * c[0] + n[1] * c[1] + n[2] * c[2]);
  at.width = row(b.width);
  return at;
}

// Tests the children of `a` against two of b, from `first` on. `pose` maps b's frame to a's.
[[gnu::always_inline]] inline unsigned pairs_that_meet(const SurfaceTree::Node& a, int first,
                                                       const Placed& at, const FloatPose& pose) {
  const auto& r = pose.rotation;
  std::array<Floats, 3> normal, d;  // of b's slabs, and between the centres of boxes
  Floats height = -twice(row(a.offset)), reach = twice(row(a.width));  // of b's boxes in a's slabs
  Floats size = fourfold(at.width, first);
  Ints meets{};
  meets = ~meets;
  for (std::size_t i = 0; i < 3; ++i) {
    const Floats center = fourfold(at.center[i], first), own = twice(row(a.half[i]));
    normal[i] = fourfold(at.normal[i], first);
    d[i] = twice(row(a.center[i])) - center;
    // Boxes along the axes of a's frame.
    meets &= absolute(d[i]) <= own + fourfold(at.spread[i], first);
    height += twice(row(a.normal[i])) * center;
    reach += absolute(upper_twice(at.normal[i])) * fourfold(at.half[i], first);
    size += absolute(normal[i]) * own;
  }
  // Slabs of a, and of b.
  meets &= absolute(height) <= reach;
  meets &= absolute(normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2] -
                    fourfold(at.offset, first)) <= size;
  // Boxes along the axes of b's frame.
  for (std::size_t j = 0; j < 3; ++j)
    meets &= absolute(r[j] * d[0] + r[3 + j] * d[1] + r[6 + j] * d[2]) <=
             fourfold(at.half[j], first) + upper_twice(at.spread[j]);
  return mask_of(meets);
}

[[gnu::always_inline]] inline unsigned pairs_that_meet(const SurfaceTree::Node& a,
                                                       const SurfaceTree::Node& b,
                                                       const FloatPose& pose,
                                                       const BothWays& ways) {
  const Placed at = placed(a, b, pose, ways);
  return pairs_that_meet(a, 0, at, pose) | pairs_that_meet(a, 2, at, pose) << 8;
}

// Pairs of children of nodes a and b, bit 4 k + l for a's l and b's k, of which either is so much
// larger that it is opened alone, and those of two triangles. A triangle has size 0.
struct PairSizes {
  unsigned a_is_larger = 0, b_is_larger = 0, are_triangles = 0;
};

[[gnu::always_inline]] inline PairSizes sizes_of(const SurfaceTree::Node& a,
                                                 const SurfaceTree::Node& b) {
  PairSizes sizes;
  const Floats zero{}, of_a = twice(row(a.size)), all_of_b = row(b.size);
  for (int first = 0; first < 4; first += 2) {
    const Floats of_b = fourfold(all_of_b, first);
    const int bit = 4 * first;
    sizes.a_is_larger |= mask_of(of_a > kLarger * of_b) << bit;
    sizes.b_is_larger |= mask_of(of_b > kLarger * of_a) << bit;
    sizes.are_triangles |= mask_of(of_a + of_b <= zero) << bit;
  }
  return sizes;
}

}  // namespace

// Puts the pairs of children of two nodes that meet on the stack, in three sets of bits: of a pair
// of which a's child, or b's, is larger, that child alone is opened next; of a pair that is alike
// in size, both are.
void TreeWalk::push(const SurfaceTree& a, const SurfaceTree& b, Place place, unsigned larger_of_a,
                    unsigned larger_of_b, unsigned alike) {
  const SurfaceTree::Node &p = a.nodes()[place.a], &q = b.nodes()[place.b];
  const auto add = [&](const Place& next) __attribute__((always_inline)) {
    prefetch(&a.nodes()[next.a]), prefetch(&b.nodes()[next.b]);
    stack_.push_back(next);
  };
  for (; alike != 0; alike &= alike - 1) {
    const auto bit = static_cast<unsigned>(std::countr_zero(alike));
    add({p.child[bit & 3], q.child[bit >> 2], 0xffff});
  }
  for (unsigned k = 0; larger_of_b != 0; ++k, larger_of_b >>= 4)
    if ((larger_of_b & 15) != 0) add({place.a, q.child[k], (larger_of_b & 15) * 0x1111});
  for (unsigned l = 0; larger_of_a != 0; ++l, larger_of_a = larger_of_a >> 1 & 0x7777)
    if ((larger_of_a & 0x1111) != 0) add({p.child[l], place.b, (larger_of_a & 0x1111) * 15});
}

// Lists pairs of triangles, which are children of two nodes.
void TreeWalk::list(const SurfaceTree::Node& p, const SurfaceTree::Node& q, unsigned pairs) {
  if (found_.size() < count_ + 16) found_.resize(2 * found_.size() + 16);
  for (; pairs != 0; pairs &= pairs - 1) {
    const auto bit = static_cast<unsigned>(std::countr_zero(pairs));
    found_[count_++] = {p.child[bit & 3] & ~SurfaceTree::kLeaf,
                        q.child[bit >> 2] & ~SurfaceTree::kLeaf};
  }
}

VPM_VECTOR_CLONES
std::span<const CandidatePair> TreeWalk::run(const SurfaceTree& a, const SurfaceTree& b,
                                             const Pose& pose) {
  const FloatPose to_a(pose);
  const BothWays ways = both_ways(to_a);
  stack_.assign(1, {0, 0, 0xffff});
  count_ = 0;
  while (!stack_.empty()) {
    const Place place = stack_.back();
    stack_.pop_back();
    const SurfaceTree::Node &p = a.nodes()[place.a], &q = b.nodes()[place.b];
    const unsigned meets = place.children & pairs_that_meet(p, q, to_a, ways);
    if (meets == 0) continue;
    const auto [a_is_larger, b_is_larger, are_triangles] = sizes_of(p, q);
    list(p, q, meets & are_triangles);
    push(a, b, place, meets & a_is_larger, meets & b_is_larger,
         meets & ~(a_is_larger | b_is_larger | are_triangles));
  }
  return std::span(found_).first(count_);
}

}  // namespace vpm
