#include "libvpm/query/point_tree.h"

#include <algorithm>
#include <bit>
#include <cstring>

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

}  // namespace

void BoxQuad::set(std::uint32_t k, const PointBox& box) {
  low[0][k] = box.low.x, low[1][k] = box.low.y, low[2][k] = box.low.z;
  high[0][k] = box.high.x, high[1][k] = box.high.y, high[2][k] = box.high.z;
}

struct PointTree::ByVectors {
  [[gnu::always_inline]] static void to_boxes(const BoxQuad& quad, Vec3 x, double (&squared)[4]) {
    const double at[3] = {x.x, x.y, x.z};
    Double4 sum{};
    for (int axis = 0; axis < 3; ++axis) {
      const Double4 before = load_four(quad.low[axis]) - at[axis],
                    after = at[axis] - load_four(quad.high[axis]), zero{};
      const Double4 gap = before > after ? before : after;
      sum += gap > 0 ? gap * gap : zero;
    }
    std::memcpy(squared, &sum, sizeof sum);
  }
  [[gnu::always_inline]] static void to_points(const Vec3f* points, std::uint32_t count, Vec3 x,
                                               double (&squared)[4]) {
    const auto [a, b, c, d] = four_of(std::span(points, count), 0);
    const Double4 all = squared_norm(Vec3x4(a, b, c, d) - Vec3x4(x, x, x, x));
    std::memcpy(squared, &all, sizeof all);
  }
};

VPM_VECTOR_CLONES
void PointTree::search_by_vectors(Vec3 x, Nearest& best) const {
  search<ByVectors>(x, best);
}

VPM_VECTOR_CLONES
std::uint32_t PointTree::list_by_vectors(Vec3 center, double squared_radius,
                                         std::uint32_t (&listed)[kMostListed]) const {
  std::uint32_t size = 0;
  const bool all =
      for_leaves<ByVectors>(center, squared_radius, [&](std::uint32_t begin, std::uint32_t end) {
        if (size + kLeafSize > kMostListed) return false;
        for (std::uint32_t first = begin; first < end; first += 4) {
          double squared[4];
          ByVectors::to_points(points + first, end - first, center, squared);
          for (std::uint32_t k = 0; k < 4 && first + k < end; ++k) {
            listed[size] = first + k;
            size += squared[k] <= squared_radius ? 1 : 0;
          }
        }
        return true;
      });
  return all ? size : kMostListed + 1;
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
