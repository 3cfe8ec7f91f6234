#include "libvpm/query/point_tree.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "libvpm/core/vec3x4.h"
#include "libvpm/core/vector_clones.h"

namespace vpm {
namespace {

constexpr float kInf = HUGE_VALF;
constexpr PointBox kEmpty{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};

PointBox around(const PointBox& a, const PointBox& b) {
  return {
      {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
      {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

[[gnu::always_inline]] inline Double4 load_four(const float* from) {
  Float4 four;
  std::memcpy(&four, from, sizeof four);
  return widen(four);
}

// PointBox::squared_distance of four; infinite of empty ones.
[[gnu::always_inline]] inline Double4 squared_distances(const BoxQuad& quad, const Vec3& x) {
  const double at[3] = {x.x, x.y, x.z};
  Double4 squared{};
  for (int axis = 0; axis < 3; ++axis) {
    const Double4 before = load_four(quad.low[axis]) - at[axis],
                  after = at[axis] - load_four(quad.high[axis]), zero{};
    const Double4 gap = before > after ? before : after;
    squared += gap > 0 ? gap * gap : zero;
  }
  return squared;
}

// The same of points; the last one stands for those beyond the end.
[[gnu::always_inline]] inline Double4 squared_distances(std::span<const Vec3f> points,
                                                        const Vec3& x) {
  const auto [a, b, c, d] = four_of(points, 0);
  return squared_norm(Vec3x4(a, b, c, d) - Vec3x4(x, x, x, x));
}

// Squared distances as integers that order like them, rounded down; the last two bits say which of
// four.
constexpr std::uint64_t kWhich = 3;

std::uint64_t key_of(double squared, std::uint64_t which) {
  return (std::bit_cast<std::uint64_t>(squared) & ~kWhich) | which;
}
// Nodes whose key is greater hold no point that is as near.
std::uint64_t last_key(double squared) {
  return (squared < HUGE_VAL ? key_of(squared, 0) : key_of(HUGE_VAL, 0) - 1) | kWhich;
}

// The nodes that are left to search, the nearest of each quad on top. Without branches that depend
// on distances: nobody predicts those.
class Waiting {
 public:
  struct Node {
    std::uint64_t key;
    std::uint32_t index;
  };

  bool is_empty() const { return size_ == 0; }
  Node take() { return nodes_[--size_]; }
  void push_root() { nodes_[size_++] = {0, 1}; }
  [[gnu::always_inline]] void push(std::uint32_t quad, const Double4& squared, std::uint64_t last) {
    std::uint64_t key[4];
    for (std::uint32_t k = 0; k < 4; ++k) key[k] = key_of(squared[k], k);
    for (const auto& [a, b] : {std::pair{0, 1}, {2, 3}, {0, 2}, {1, 3}, {1, 2}}) {
      const std::uint64_t swapped =
          (key[a] ^ key[b]) & (std::uint64_t{0} - static_cast<std::uint64_t>(key[a] < key[b]));
      key[a] ^= swapped, key[b] ^= swapped;
    }
    for (const std::uint64_t k : key) {
      nodes_[size_] = {k, 4 * quad + static_cast<std::uint32_t>(k & kWhich)};
      size_ += k <= last ? 1 : 0;
    }
  }

 private:
  int size_ = 0;
  Node nodes_[3 * PointTree::kMaxDepth / 2 + 4];  // three of each quad, and one more
};

}  // namespace

void BoxQuad::set(std::uint32_t k, const PointBox& box) {
  low[0][k] = box.low.x, low[1][k] = box.low.y, low[2][k] = box.low.z;
  high[0][k] = box.high.x, high[1][k] = box.high.y, high[2][k] = box.high.z;
}

VPM_VECTOR_CLONES
void PointTree::search_by_vectors(Vec3 x, Nearest& best) const {
  Waiting waiting;
  // A step goes down two levels: from the root or from its children, so that it ends at a leaf.
  if (std::countr_zero(leaves) % 2 == 0) {
    waiting.push_root();
  } else {
    Double4 squared = squared_distances(boxes[0], x);
    squared[0] = squared[1] = HUGE_VAL;
    waiting.push(0, squared, last_key(best.squared));
  }
  while (!waiting.is_empty()) {
    const auto [key, node] = waiting.take();
    const std::uint64_t last = last_key(best.squared);
    if (key > last) continue;
    if (node < leaves) {
      waiting.push(node, squared_distances(boxes[node], x), last);
      continue;
    }
    const std::uint32_t begin = (node - leaves) * kLeafSize, end = end_of_leaf(begin);
    for (std::uint32_t first = begin; first < end; first += kFour) {
      const Double4 squared = squared_distances({points + first, end - first}, x);
      if (!any(squared <= best.squared)) continue;
      for (std::uint32_t k = 0; k < kFour && first + k < end; ++k)
        best.consider(squared[k], first + k);
    }
  }
}

VPM_VECTOR_CLONES
std::uint32_t PointTree::list_by_vectors(Vec3 center, double squared_radius,
                                         std::uint32_t (&listed)[kMostListed]) const {
  if (count == 0) return 0;
  std::uint32_t stack[2 * kMaxDepth], size = 0, waiting = 0;
  const auto enter_quad = [&](std::uint32_t quad, std::uint32_t first) {
    const Mask4 touched = squared_distances(boxes[quad], center) <= squared_radius;
    for (std::uint32_t k = 4; k-- > first;) {
      stack[waiting] = 4 * quad + k;
      waiting += touched[k] != 0 ? 1 : 0;
    }
  };
  if (std::countr_zero(leaves) % 2 == 0)
    stack[waiting++] = 1;
  else
    enter_quad(0, 2);
  while (waiting > 0) {
    const std::uint32_t node = stack[--waiting];
    if (node < leaves) {
      enter_quad(node, 0);
      continue;
    }
    const std::uint32_t begin = (node - leaves) * kLeafSize, end = end_of_leaf(begin);
    if (size + kLeafSize > kMostListed) return kMostListed + 1;
    for (std::uint32_t first = begin; first < end; first += kFour) {
      const Mask4 inside =
          squared_distances({points + first, end - first}, center) <= squared_radius;
      for (std::uint32_t k = 0; k < kFour && first + k < end; ++k) {
        listed[size] = first + k;
        size += inside[k] != 0 ? 1 : 0;
      }
    }
  }
  return size;
}

std::uint32_t leaves_for(std::size_t points) {
  constexpr std::size_t kLeaf = PointTree::kLeafSize;
  return static_cast<std::uint32_t>(
      std::bit_ceil(std::max<std::size_t>((points + kLeaf - 1) / kLeaf, 1)));
}

std::vector<BoxQuad> boxes_of(std::span<const Vec3f> points) {
  const std::uint32_t leaves = leaves_for(points.size());
  std::vector<PointBox> boxes(2 * std::size_t{leaves}, kEmpty);
  for (std::size_t i = 0; i < points.size(); ++i) {
    PointBox& leaf = boxes[leaves + i / PointTree::kLeafSize];
    leaf = around(leaf, {points[i], points[i]});
  }
  for (std::uint32_t node = leaves; node-- > 1;)
    boxes[node] = around(boxes[2 * node], boxes[2 * node + 1]);
  boxes.resize(std::max<std::size_t>(boxes.size(), 4), kEmpty);
  std::vector<BoxQuad> quads(boxes.size() / 4);
  for (std::uint32_t node = 0; node < boxes.size(); ++node)
    quads[node / 4].set(node % 4, boxes[node]);
  return quads;
}

}  // namespace vpm
