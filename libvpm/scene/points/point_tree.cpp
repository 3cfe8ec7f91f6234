#include "libvpm/scene/points/point_tree.h"

#include <algorithm>
#include <array>
#include <bit>

#include "libvpm/core/lanes.h"
#include "libvpm/scene/points/point_tree_vectors.h"

namespace vpm {
namespace {

constexpr float kInf = HUGE_VALF;
constexpr PointBox kEmpty{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};

PointBox around(const PointBox& a, const PointBox& b) {
  return {
      {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
      {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

}  // namespace

void BoxQuad::set(std::uint32_t k, const PointBox& box) {
  low[0][k] = box.low.x, low[1][k] = box.low.y, low[2][k] = box.low.z;
  high[0][k] = box.high.x, high[1][k] = box.high.y, high[2][k] = box.high.z;
}

void PointTree::enter_near(Vec3 center, double reach) {
  entry = {};
  const std::uint32_t nearest_point = nearest(center, HUGE_VAL);
  if (nearest_point == kNoPoint) return;
  constexpr double kSlack = 1 + 1e-9;  // more than distances are rounded by
  const double ball = kSlack * (reach + norm(widen(points[nearest_point]) - center));
  const double farthest = kSlack * (reach + ball);
  // Descends as long as at most four nodes hold the ball.
  std::array<std::uint32_t, 4> held{1};
  std::size_t size = 1;
  if (!begins_at_root()) held = {2, 3}, size = 2;
  while (held[0] < leaves) {
    std::array<std::uint32_t, 16> below;
    std::size_t found = 0;
    for (std::size_t n = 0; n < size; ++n) {
      for (std::uint32_t node = 4 * held[n]; node < 4 * held[n] + 4; ++node) {
        if (box_of(node).squared_distance(center) <= farthest * farthest) below[found++] = node;
      }
    }
    if (found == 0 || found > held.size()) break;
    std::copy_n(below.begin(), found, held.begin());
    size = found;
  }
  for (std::uint32_t k = 0; k < held.size(); ++k) {
    entry.nodes[k] = held[k < size ? k : size - 1];
    entry.boxes.set(k, k < size ? box_of(held[k]) : kEmpty);
  }
  entry.center = center;
  entry.squared_reach = reach * reach;
  entry.ball = ball;
}

VPM_VECTOR_CLONES
void PointTree::search_by_vectors(Vec3 x, Nearest& best) const {
  search<ByVectors>(x, EachPoint{}, best);
}

VPM_VECTOR_CLONES
void PointTree::search_by_vectors(Vec3 x, const TouchingBall& touching, Nearest& best) const {
  search<ByVectors>(x, touching, best);
}

VPM_VECTOR_CLONES
std::uint32_t PointTree::list_by_vectors(Vec3 center, double squared_radius,
                                         std::uint32_t (&listed)[kMostListed]) const {
  std::uint32_t size = 0;
  const bool all = for_leaves_in_ball<ByVectors>(
      center, squared_radius, EachNode{}, [&](std::uint32_t begin, std::uint32_t end) {
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

std::vector<float> largest_in_nodes(std::span<const float> radii) {
  const std::uint32_t leaves = leaves_for(radii.size());
  std::vector<float> largest(std::max<std::size_t>(2 * std::size_t{leaves}, 4));
  for (std::size_t i = 0; i < radii.size(); ++i) {
    float& of_leaf = largest[leaves + i / PointTree::kLeafSize];
    of_leaf = std::max(of_leaf, radii[i]);
  }
  for (std::uint32_t node = leaves; node-- > 1;)
    largest[node] = std::max(largest[2 * node], largest[2 * node + 1]);
  return largest;
}

}  // namespace vpm
