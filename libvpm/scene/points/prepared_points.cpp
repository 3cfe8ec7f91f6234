#include "libvpm/scene/points/prepared_points.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>
#include <utility>

namespace vpm {

PreparedPoints::PreparedPoints(const Cloud& cloud, Denoising points) {
  check_for_queries(cloud);
  std::vector<std::uint32_t> order = order_in_space(cloud);
  DiskWindows windows = take(cloud, order);
  if (leaves_out_inner(cloud, order)) windows = take(cloud, order);
  disks_ = points == Denoising::on ? denoised(windows) : as_measured(windows);
  if (points == Denoising::on) foot_boxes_ = boxes_of(disks_.feet);
  largest_radii_ = largest_in_nodes(disks_.radii);
  cones_ = cones_of(surface());
}

// Takes the points of inner faces from `order`; returns false if there are none.
bool PreparedPoints::leaves_out_inner(const Cloud& cloud, std::vector<std::uint32_t>& order) {
  const std::vector<std::uint32_t>& inner = dipoles_.inner();
  if (inner.empty() || inner.size() == order.size()) return false;
  inner_ = inner.size();
  for (const std::uint32_t i : inner) order[i] = kNoPoint;
  std::erase(order, kNoPoint);
  order_by_leaves(cloud.positions, order);
  return true;
}

namespace {

// Returns a number that orders like a coordinate; the same one for 0 and -0.
std::uint32_t rank_of(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(positive_zero(x));
  constexpr std::uint32_t kSign = std::uint32_t{1} << 31;
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

// Holds the rank of a point's x, and its index.
struct RankedPoint {
  std::uint32_t rank, index;
};

// Sorts by rank; equal ones keep their order.
void sort_by_rank(std::vector<RankedPoint>& points) {
  constexpr int kBits = 11;
  constexpr std::uint32_t kDigits = 1U << kBits;
  std::vector<RankedPoint> sorted(points.size());
  for (int shift = 0; shift < 32; shift += kBits) {
    std::uint32_t next[kDigits] = {};
    for (const RankedPoint& p : points) ++next[p.rank >> shift & (kDigits - 1)];
    std::exclusive_scan(std::begin(next), std::end(next), std::begin(next), 0U);
    for (const RankedPoint& p : points) sorted[next[p.rank >> shift & (kDigits - 1)]++] = p;
    points.swap(sorted);
  }
}

}  // namespace

std::vector<std::uint32_t> PreparedPoints::order_in_space(const Cloud& cloud) {
  std::vector<RankedPoint> points(cloud.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) points[i] = {rank_of(cloud.positions[i].x), i};
  sort_by_rank(points);
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (auto same = points.begin(); same != points.end();) {
    auto end = std::next(same);
    while (end != points.end() && end->rank == same->rank) ++end;
    const auto key = [&](const RankedPoint& p) { return order_key(cloud, p.index); };
    if (end - same > 1) std::sort(same, end, [&](auto& a, auto& b) { return key(a) < key(b); });
    for (const auto begin = same; same != end; ++same) {
      if (same == begin || key(*same) != key(*std::prev(same))) order.push_back(same->index);
    }
  }
  order_by_leaves(cloud.positions, order);
  return order;
}

DiskWindows PreparedPoints::take(const Cloud& cloud, const std::vector<std::uint32_t>& order) {
  points_ = OrderedPoints(cloud, order);
  std::vector<float> radii(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) radii[k] = cloud.radii[order[k]];
  boxes_ = boxes_of(positions());
  DiskWindows windows({point_tree(), normals().data(), std::move(radii)});
  dipoles_ = DiskDipoles(windows);
  return windows;
}

PointTree PreparedPoints::point_tree() const {
  static_assert(kMaxPoints <= std::size_t{PointTree::kMostLeaves} * PointTree::kLeafSize);
  return {positions().data(), boxes_.data(), static_cast<std::uint32_t>(positions().size()),
          leaves_for(positions().size())};
}

DiskSurface PreparedPoints::surface() const {
  PointTree feet = point_tree();
  feet.points = disks_.feet.data();
  if (!foot_boxes_.empty()) feet.boxes = foot_boxes_.data();
  return {feet,
          disks_.normals.data(),
          disks_.second_of.data(),
          disks_.seconds.data(),
          {disks_.radii.data(), largest_radii_.data()},
          {cones_.data()},
          dipoles_.winding(),
          foot_boxes_.empty() ? nullptr : positions().data()};
}

}  // namespace vpm
