#include "libvpm/scene/points/point_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <span>

#include "libvpm/core/box.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm {
namespace {

[[gnu::always_inline]] inline Double4 load_four(const float* from) {
  Float4 four;
  std::memcpy(&four, from, sizeof four);
  return widen(four);
}

// Holds the nearest points so far of four places, one in each lane.
class FourNearest {
 public:
  explicit FourNearest(const Vec3 (&places)[4]) : x_(places[0], places[1], places[2], places[3]) {}

  [[gnu::always_inline]] void consider(Vec3f point, std::uint32_t i) {
    const Vec3 p = widen(point);
    const Double4 squared = squared_norm(Vec3x4(p, p, p, p) - x_);
    const Mask4 index = Mask4{} + static_cast<std::int64_t>(i);
    const Mask4 nearer = (squared < squared_) | ((squared == squared_) & (index < points_));
    squared_ = nearer ? squared : squared_;
    points_ = nearer ? index : points_;
  }
  // True if a box may hold a point that is nearer to one of the places, or equally near.
  [[gnu::always_inline]] bool may_hold_nearer(const BoxQuad& quad, std::uint32_t k) const {
    const Double4* const at[3] = {&x_.x, &x_.y, &x_.z};
    Double4 sum{};
    for (int axis = 0; axis < 3; ++axis) {
      const Double4 before = double{quad.low[axis][k]} - *at[axis],
                    after = *at[axis] - double{quad.high[axis][k]}, zero{};
      const Double4 gap = before > after ? before : after;
      sum += gap > 0 ? gap * gap : zero;
    }
    return any(sum <= squared_);
  }
  // Returns the squared distance of the farthest of the nearest points, m^2.
  [[gnu::always_inline]] double farthest() const {
    return std::max(std::max(squared_[0], squared_[1]), std::max(squared_[2], squared_[3]));
  }
  [[gnu::always_inline]] std::uint32_t point(int lane) const {
    return static_cast<std::uint32_t>(points_[lane]);
  }

 private:
  Vec3x4 x_;
  Double4 squared_ = Double4{} + HUGE_VAL;  // to the points, m^2
  Mask4 points_ = Mask4{} + std::int64_t{kNoPoint};
};

constexpr float kInf = HUGE_VALF;
constexpr PointBox kEmpty{{kInf, kInf, kInf}, {-kInf, -kInf, -kInf}};

PointBox around(const PointBox& a, const PointBox& b) {
  return {
      {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
      {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

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

// Sets cone k of a quad to that of the disks [begin, end).
void set_cone(const DiskSurface& disks, std::uint32_t begin, std::uint32_t end, ConeQuad& quad,
              std::uint32_t k) {
  Vec3 sum;
  for (std::uint32_t i = begin; i < end; ++i)
    disks.for_normals_of(i, [&](Vec3 normal) { sum += normal; });
  const Vec3f axis = narrow(normalized_or_zero(sum));
  double cosine = 1;
  for (std::uint32_t i = begin; i < end; ++i)
    disks.for_normals_of(i,
                         [&](Vec3 normal) { cosine = std::min(cosine, dot(widen(axis), normal)); });
  quad.set(k, axis, static_cast<float>(cosine));
}

}  // namespace

// Computes squared distances of four boxes, and of up to four points, by vectors.
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
  entry.nearest = nearest_point;
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

// Goes down by the distances of boxes from the middle of the places, and asks for each node that it
// takes whether one of them needs it.
VPM_VECTOR_CLONES
void PointTree::nearest_of_four(const Vec3 (&places)[4], std::uint32_t near,
                                std::uint32_t (&found)[4]) const {
  const auto is_held = [&](Vec3 x) { return entry.holds(x, 0); };
  if (entry.squared_reach >= 0 && !std::ranges::all_of(places, is_held)) {
    for (int k = 0; k < kFour; ++k) found[k] = nearest(places[k], HUGE_VAL, near);
    return;
  }
  constexpr double kSlack = 1 + 1e-9;  // more than distances are rounded by
  const Vec3 middle = 0.25 * ((places[0] + places[1]) + (places[2] + places[3]));
  double reach = 0;
  for (const Vec3& x : places) reach = std::max(reach, norm(x - middle));
  FourNearest best(places);
  if (near != kNoPoint) best.consider(points[near], near);
  const auto last_key = [&]() __attribute__((always_inline)) {
    const double bound = kSlack * (std::sqrt(best.farthest()) + reach);
    return NodeStack::last_key(bound * bound);
  };
  NodeStack waiting;
  std::uint64_t last = last_key();
  begin_search<ByVectors>(middle, EachPoint{}, last, waiting);
  while (!waiting.is_empty()) {
    const std::uint64_t key = waiting.top_key();
    const std::uint32_t node = waiting.take();
    if (key > last || !best.may_hold_nearer(boxes[node / 4], node % 4)) continue;
    if (node < leaves) {
      double squared[4];
      ByVectors::to_boxes(boxes[node], middle, squared);
      waiting.push([&](std::uint32_t k) { return 4 * node + k; }, squared, last);
      continue;
    }
    const std::uint32_t begin = (node - leaves) * kLeafSize, end = end_of_leaf(begin);
    for (std::uint32_t i = begin; i < end; ++i) best.consider(points[i], i);
    last = last_key();
  }
  for (int k = 0; k < kFour; ++k) found[k] = best.point(k);
}

std::uint32_t PointTree::list_in_leaf(std::uint32_t begin, std::uint32_t end, Vec3 center,
                                      double squared_radius, std::uint32_t* listed) const {
  std::uint32_t size = 0;
  for (std::uint32_t first = begin; first < end; first += 4) {
    double squared[4];
    ByVectors::to_points(points + first, end - first, center, squared);
    for (std::uint32_t k = 0; k < 4 && first + k < end; ++k) {
      listed[size] = first + k;
      size += squared[k] <= squared_radius ? 1 : 0;
    }
  }
  return size;
}

VPM_VECTOR_CLONES
std::uint32_t PointTree::list_by_vectors(Vec3 center, double squared_radius,
                                         std::uint32_t (&listed)[kMostListed]) const {
  std::uint32_t size = 0;
  const bool all = for_leaves_in_ball<ByVectors>(
      center, squared_radius, EachNode{}, [&](std::uint32_t begin, std::uint32_t end) {
        if (size + kLeafSize > kMostListed) return false;
        size += list_in_leaf(begin, end, center, squared_radius, listed + size);
        return true;
      });
  return all ? size : kMostListed + 1;
}

VPM_VECTOR_CLONES
void PointTree::list_quads(Vec3 center, double squared_radius,
                           std::vector<std::uint32_t>& quads) const {
  quads.clear();
  for_leaves_in_ball<ByVectors>(center, squared_radius, EachNode{},
                                [&](std::uint32_t begin, std::uint32_t) {
                                  const std::uint32_t quad = (leaves + begin / kLeafSize) / 4;
                                  if (quads.empty() || quads.back() != quad) quads.push_back(quad);
                                  return true;
                                });
}

VPM_VECTOR_CLONES
void PointTree::list_leaves(Vec3 center, double squared_radius,
                            std::span<const std::uint32_t> quads,
                            std::vector<std::uint32_t>& listed) const {
  for (const std::uint32_t quad : quads) {
    double squared[4];
    ByVectors::to_boxes(boxes[quad], center, squared);
    for (std::uint32_t k = 0; k < 4; ++k) {
      if (squared[k] <= squared_radius && 4 * quad + k >= leaves)
        listed.push_back(4 * quad + k - leaves);
    }
  }
}

VPM_VECTOR_CLONES
std::uint32_t PointTree::list_points(std::span<const std::uint32_t> in_leaves, Vec3 center,
                                     double squared_radius, std::uint32_t* listed) const {
  std::uint32_t size = 0;
  for (const std::uint32_t leaf : in_leaves) {
    const std::uint32_t begin = leaf * kLeafSize;
    size += list_in_leaf(begin, end_of_leaf(begin), center, squared_radius, listed + size);
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

VPM_VECTOR_CLONES
int PointList::nearest_by_vectors(Vec3 x) const {
  static_assert(kMost % kFour == 0);
  Double4 least = Double4{} + HUGE_VAL;
  Mask4 lane{0, 1, 2, 3}, best{};
  for (int first = 0; first < size_; first += kFour) {
    const Vec3x4 away{load_four(places_[0] + first) - x.x, load_four(places_[1] + first) - x.y,
                      load_four(places_[2] + first) - x.z};
    const Double4 squared = squared_norm(away);
    const Mask4 nearer = (squared < least) & (lane < size_ - first);
    least = nearer ? squared : least;
    best = nearer ? lane + first : best;
  }
  int k = 0;
  for (int other = 1; other < kFour; ++other) {
    if (least[other] < least[k] || (least[other] == least[k] && best[other] < best[k])) k = other;
  }
  return static_cast<int>(best[k]);
}

VPM_VECTOR_CLONES
bool DiskSurface::face_one_way_by_vectors(Vec3 center, double radius, Vec3 n, double least) const {
  return face_one_way_by<PointTree::ByVectors>(center, radius, n, least);
}

std::vector<ConeQuad> cones_of(const DiskSurface& disks) {
  const PointTree& tree = disks.feet;
  std::vector<ConeQuad> quads(tree.quads());
  for (std::uint32_t nodes = tree.leaves, size = PointTree::kLeafSize; nodes > 0;
       nodes /= 4, size *= 4) {
    constexpr std::size_t kGrain = 8192;  // disks
    const std::size_t used = (std::size_t{tree.count} + size - 1) / size;
    parallel_for(used, std::max<std::size_t>(kGrain / size, 4),
                 [&](std::size_t first, std::size_t last) {
                   for (auto k = static_cast<std::uint32_t>(first); k < last; ++k) {
                     const std::uint32_t node = nodes + k;
                     set_cone(disks, k * size, std::min((k + 1) * size, tree.count),
                              quads[node / 4], node % 4);
                   }
                 });
  }
  return quads;
}

}  // namespace vpm
