#include "libvpm/scene/points/prepared_points.h"

#include <algorithm>

namespace vpm {

PreparedPoints::PreparedPoints(const Cloud& cloud, Denoising points) {
  check_for_queries(cloud);
  std::vector<std::uint32_t> order = order_in_space(cloud);
  std::vector<float> radii = take(cloud, order);
  if (leaves_out_inner(cloud, order)) radii = take(cloud, order);
  const DiskSurface measured{point_tree(), normals().data()};
  if (points == Denoising::on) {
    disks_ = denoised(measured, std::move(radii));
    foot_boxes_ = boxes_of(disks_.feet);
  } else {
    disks_ = as_measured(measured, std::move(radii));
  }
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

std::vector<std::uint32_t> PreparedPoints::order_in_space(const Cloud& cloud) {
  struct Placed {  // side by side, for the cache
    Vec3f at;
    std::uint32_t index;
  };
  std::vector<Placed> placed;
  placed.reserve(cloud.size());
  for (std::uint32_t i = 0; i < cloud.size(); ++i) placed.push_back({cloud.positions[i], i});
  std::sort(placed.begin(), placed.end(), [&](const Placed& a, const Placed& b) {
    if (a.at.x != b.at.x) return a.at.x < b.at.x;
    if (a.at.y != b.at.y) return a.at.y < b.at.y;
    if (a.at.z != b.at.z) return a.at.z < b.at.z;
    return order_key(cloud, a.index) < order_key(cloud, b.index);
  });
  std::vector<std::uint32_t> order;
  order.reserve(placed.size());
  for (const Placed& p : placed) {
    if (order.empty() || order_key(cloud, p.index) != order_key(cloud, order.back()))
      order.push_back(p.index);
  }
  order_by_leaves(cloud.positions, order);
  return order;
}

std::vector<float> PreparedPoints::take(const Cloud& cloud,
                                        const std::vector<std::uint32_t>& order) {
  points_ = OrderedPoints(cloud, order);
  std::vector<float> radii;
  radii.reserve(order.size());
  for (const std::uint32_t i : order) radii.push_back(cloud.radii[i]);
  boxes_ = boxes_of(positions());
  dipoles_ = DiskDipoles(point_tree(), normals(), radii);
  return radii;
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
