#include "libvpm/scene/points/disk_winding.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

constexpr double kPi = kFullSolidAngle / 4;
constexpr std::size_t kLeavesPerTask = 64;

// From this multiple of a node's radius on its dipole stands for its disks. Barill et al. take 2,
// which keeps the error to some thousandths.
constexpr double kFarFactor = 2;

// Radius of the ball in which disks are counted: in sampling radii, and at most in diagonals of
// leaves, since radii may be much wider than the spacing. It holds about thirty disks.
constexpr double kReach = 4, kReachInLeaves = 1.5;
// Disks whose normals have a smaller cosine belong to the other side of a plate. Those about a
// right angle count, since the two sides of an edge cover together what a plane would.
constexpr double kOtherSide = -0.5;

// Calls visit(first, end) for the disks of each leaf, in parallel.
template <class Visit>
void for_leaves(std::uint32_t count, const Visit& visit) {
  const std::size_t leaves = (count + PointTree::kLeafSize - 1) / PointTree::kLeafSize;
  parallel_for(leaves, kLeavesPerTask, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto first = static_cast<std::uint32_t>(k * PointTree::kLeafSize);
      visit(first, std::min(first + PointTree::kLeafSize, count));
    }
  });
}

struct NearDisk {
  Vec3 place, normal;
};

// Returns the area of a disk, m^2. Near disks have weights that fall to 0 at the reach, so that it
// hardly matters which of a lattice's points are just within it.
double area_of(const NearDisk& disk, double reach, std::span<const NearDisk> near) {
  double weights = 0;
  for (const NearDisk& other : near) {
    const double weight = 1 - squared_norm(other.place - disk.place) / (reach * reach);
    weights += weight > 0 && dot(other.normal, disk.normal) > kOtherSide ? weight : 0;
  }
  return 0.5 * kPi * reach * reach / weights;
}

// Sets the areas of the disks of a leaf.
void measure_leaf(const PointTree& tree, std::span<const Vec3f> normals,
                  std::span<const float> radii, std::uint32_t begin, std::uint32_t end,
                  std::vector<WindingDisk>& disks) {
  const PointBox box = tree.leaf_of(begin);
  const double diagonal = norm(widen(box.high) - widen(box.low));
  const auto reach_of = [&](std::uint32_t i) {
    const double reach = kReach * radii[i], most = kReachInLeaves * diagonal;
    return most > 0 ? std::min(reach, most) : reach;
  };
  double widest = 0;
  for (std::uint32_t i = begin; i < end; ++i) widest = std::max(widest, reach_of(i));
  thread_local std::vector<NearDisk> near;
  near.clear();
  const double all = widest + 0.5 * diagonal;
  tree.for_points_in_ball(0.5 * (widen(box.low) + widen(box.high)), all * all,
                          [&](std::uint32_t j) {
                            near.push_back({widen(tree.points[j]), widen(normals[j])});
                            return true;
                          });
  for (std::uint32_t i = begin; i < end; ++i) {
    const NearDisk disk{widen(tree.points[i]), widen(normals[i])};
    const double reach = reach_of(i), area = reach > 0 ? area_of(disk, reach, near) : 0;
    disks[i] = {tree.points[i], static_cast<float>(area / kPi), narrow(area * disk.normal)};
  }
}

// Sums up disks below a node, about the cloud's origin.
struct DiskGroup {
  Vec3 area, place;   // sums of the areas times normals, and times places
  Vec3 rows[3];       // sum of the areas times places times normals, by the places' coordinates
  double weight = 0;  // sum of the areas, m^2

  void add(const DiskGroup& other) {
    area += other.area;
    place += other.place;
    for (int k = 0; k < 3; ++k) rows[k] += other.rows[k];
    weight += other.weight;
  }
};

DiskGroup group_of(const WindingDisk& disk) {
  const double weight = kPi * disk.rim;
  const Vec3 area = widen(disk.area), place = widen(disk.center);
  return {area, weight * place, {place.x * area, place.y * area, place.z * area}, weight};
}

// Returns the moments of the disks in a box.
WindingNode node_of(const DiskGroup& group, const PointBox& box) {
  if (!(group.weight > 0)) return {};
  const Vec3 low = widen(box.low), high = widen(box.high), center = group.place / group.weight;
  const auto farther = [](double c, double a, double b) { return std::max(c - a, b - c); };
  const Vec3 corner{farther(center.x, low.x, high.x), farther(center.y, low.y, high.y),
                    farther(center.z, low.z, high.z)};
  const Vec3 x = group.rows[0] - center.x * group.area, y = group.rows[1] - center.y * group.area,
             z = group.rows[2] - center.z * group.area;
  const double third = (x.x + y.y + z.z) / 3;
  const auto single = [](double value) { return static_cast<float>(value); };
  return {narrow(center),
          single(kFarFactor * kFarFactor * squared_norm(corner)),
          narrow(group.area),
          {single(x.x - third), single(0.5 * (x.y + y.x)), single(0.5 * (x.z + z.x)),
           single(y.y - third), single(0.5 * (y.z + z.y)), single(z.z - third)}};
}

std::vector<WindingNode> nodes_of(const PointTree& tree, const std::vector<WindingDisk>& disks) {
  std::vector<DiskGroup> groups(2 * std::size_t{tree.leaves});
  for (std::uint32_t i = 0; i < tree.count; ++i)
    groups[tree.leaves + i / PointTree::kLeafSize].add(group_of(disks[i]));
  for (std::uint32_t node = tree.leaves; node-- > 1;) {
    groups[node] = groups[2 * node];
    groups[node].add(groups[2 * node + 1]);
  }
  std::vector<WindingNode> nodes(tree.nodes());
  for (std::uint32_t node = 1; node < groups.size(); ++node)
    nodes[node] = node_of(groups[node], tree.box_of(node));
  return nodes;
}

}  // namespace

DiskDipoles::DiskDipoles(const PointTree& tree, std::span<const Vec3f> normals,
                         std::span<const float> radii)
    : disks_(tree.count), count_(tree.count), leaves_(tree.leaves) {
  for_leaves(tree.count, [&](std::uint32_t begin, std::uint32_t end) {
    measure_leaf(tree, normals, radii, begin, end, disks_);
  });
  nodes_ = nodes_of(tree, disks_);
  find_sides(tree);
}

void DiskDipoles::find_sides(const PointTree& tree) {
  // On the surface of one solid the mean of both sides is 1/2, on an inner face 3/2, and before a
  // wide wall, of which one side was seen, 0.
  constexpr double kInner = 1, kMaybeInner = 0.75, kMayEnclose = 0.25;
  const DiskWinding winding = this->winding();
  const auto leaf_of = [](std::uint32_t i) { return i / PointTree::kLeafSize; };
  std::vector<char> is_inner(count_);
  std::vector<double> of_leaf(leaf_of(count_ + PointTree::kLeafSize - 1));
  for_leaves(count_, [&](std::uint32_t begin, std::uint32_t) {
    of_leaf[leaf_of(begin)] = winding.at(widen(nodes_[leaves_ + leaf_of(begin)].center));
  });
  // Where a face becomes an inner one, at another surface, leaves hold points of both sides.
  const auto is_near_inner = [&](std::uint32_t begin) {
    const PointBox box = tree.leaf_of(begin);
    const Vec3 low = widen(box.low), high = widen(box.high);
    return !tree.for_leaves_in_ball(
        0.5 * (low + high), squared_norm(high - low),
        [&](std::uint32_t other, std::uint32_t) { return of_leaf[leaf_of(other)] <= kMaybeInner; });
  };
  const bool has_inner = std::ranges::any_of(of_leaf, [](double n) { return n > kMaybeInner; });
  may_enclose_ = std::ranges::any_of(of_leaf, [](double n) { return n > kMayEnclose; });
  if (!has_inner) return;
  for_leaves(count_, [&](std::uint32_t begin, std::uint32_t end) {
    if (!is_near_inner(begin)) return;
    for (std::uint32_t i = begin; i < end; ++i)
      is_inner[i] = winding.at(widen(disks_[i].center)) > kInner;
  });
  for (std::uint32_t i = 0; i < count_; ++i)
    if (is_inner[i] != 0) inner_.push_back(i);
}

}  // namespace vpm
