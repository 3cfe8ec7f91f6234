#include "libvpm/scene/points/disk_winding.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libvpm/core/lanes.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/vec3x4.h"
#include "libvpm/scene/points/disk_windows.h"

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

// Returns the areas of four disks, m^2, which count their neighbours within `reach`, m. Near disks
// have weights that fall to 0 there, so that it hardly matters which of a lattice's points are just
// within it.
VPM_VECTOR_CLONES
std::array<double, 4> areas_of(const DiskInBall (&four)[4], std::span<const Disk> near) {
  const auto& [a, b, c, d] = four;
  const Vec3x4 place(a.disk.place, b.disk.place, c.disk.place, d.disk.place),
      normal(a.disk.normal, b.disk.normal, c.disk.normal, d.disk.normal);
  const Double4 reach{a.reach, b.reach, c.reach, d.reach}, squared_reach = reach * reach, zero{};
  Double4 weights{};
  for (const Disk& other : near) {
    const Vec3 p = other.place;
    const Double4 weight = 1 - squared_norm(Vec3x4(p, p, p, p) - place) / squared_reach;
    weights += (weight > 0) & (dot(other.normal, normal) > kOtherSide) ? weight : zero;
  }
  const Double4 areas = 0.5 * kPi * reach * reach / weights;
  return {areas[0], areas[1], areas[2], areas[3]};
}

// Sets the areas of the disks of a leaf.
void measure_leaf(const DiskWindows& windows, const DiskLeaf& leaf, std::vector<Disk>& near,
                  std::vector<WindingDisk>& disks) {
  const auto reach_of = [&](std::uint32_t i) {
    return DiskWindows::at_most(kReach * windows.radius(i), kReachInLeaves * leaf.diagonal);
  };
  windows.gather_about(leaf, windows.count(), near);
  for (std::uint32_t first = leaf.begin; first < leaf.end; first += 4) {
    DiskInBall four[4];
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t i = std::min(first + k, leaf.end - 1);
      four[k] = {windows.disk(i), reach_of(i)};
    }
    const std::array<double, 4> areas = areas_of(four, near);
    for (std::uint32_t k = 0; k < 4 && first + k < leaf.end; ++k) {
      const double area = four[k].reach > 0 ? areas[k] : 0;
      disks[first + k] = {narrow(four[k].disk.place), static_cast<float>(area / kPi),
                          narrow(area * four[k].disk.normal)};
    }
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
  std::vector<WindingNode> nodes(tree.nodes());
  std::vector<DiskGroup> groups((disks.size() + PointTree::kLeafSize - 1) / PointTree::kLeafSize);
  for_leaves(tree.count, [&](std::uint32_t begin, std::uint32_t end) {
    const std::uint32_t leaf = begin / PointTree::kLeafSize;
    for (std::uint32_t i = begin; i < end; ++i) groups[leaf].add(group_of(disks[i]));
    nodes[tree.leaves + leaf] = node_of(groups[leaf], tree.box_of(tree.leaves + leaf));
  });
  // Joins the groups of a level to those of the level above, whose first node is `first`.
  for (std::uint32_t first = tree.leaves / 2; first > 0; first /= 2) {
    groups.resize((groups.size() + 1) / 2 * 2);
    for (std::uint32_t k = 0; k < groups.size() / 2; ++k) {
      DiskGroup both = groups[2 * k];
      both.add(groups[2 * k + 1]);
      nodes[first + k] = node_of(both, tree.box_of(first + k));
      groups[k] = both;
    }
    groups.resize(groups.size() / 2);
  }
  return nodes;
}

}  // namespace

DiskDipoles::DiskDipoles(const DiskWindows& windows)
    : disks_(windows.count()), count_(windows.count()), leaves_(windows.disks().feet.leaves) {
  const PointTree& tree = windows.disks().feet;
  for_leaves(tree.count, [&](std::uint32_t begin, std::uint32_t) {
    thread_local std::vector<Disk> near;
    measure_leaf(windows, windows.leaf_of(begin), near, disks_);
  });
  nodes_ = nodes_of(tree, disks_);
  find_sides(tree);
}

void DiskDipoles::find_sides(const PointTree& tree) {
  // On the surface of one solid the mean of both sides is 1/2, on an inner face 3/2, before a wide
  // wall, of which one side was seen, 0, and on the walls about a room -1/2.
  constexpr double kInner = 1, kMaybeInner = 0.75, kMayEnclose = DiskWinding::kMayBeInside;
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
  may_surround_ = std::ranges::any_of(of_leaf, [](double n) { return n < -kMayEnclose; });
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
