// Finds the disks of a cloud about one of them, within windows that follow its sampling radius.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/scene/points/disk_neighborhood.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm {

// Sets the radii of windows in sampling radii: a little wider than the 7 x 7 pixels by which
// normals are estimated, and wide enough to reach beyond windows that hold both sides of a crease.
inline constexpr double kWindow = 6.3, kWide = 14;

// Limits of windows, since disks may be much wider than their spacing (seen at a grazing angle by
// one of several cameras): diagonals of leaves of eight disks, and numbers of disks, to which
// windows are halved.
inline constexpr double kLeavesInWindow = 2.5, kLeavesInWide = 5;
inline constexpr std::uint32_t kMostInWindow = 512, kMostInWide = 2048;
inline constexpr int kHalvings = 10;

// Describes a leaf of the tree of disks: eight neighbours.
struct DiskLeaf {
  std::uint32_t begin = 0, end = 0;
  Vec3 center;
  double diagonal = 0;
};

// Refers to the measured disks. Thread-safe.
class DiskWindows {
 public:
  DiskWindows(const DiskSurface& measured, std::span<const float> radii)
      : measured_(measured), radii_(radii) {}

  std::uint32_t count() const { return measured_.feet.count; }
  Disk disk(std::uint32_t i) const {
    return {widen(measured_.feet.points[i]), widen(measured_.normals[i])};
  }
  double radius(std::uint32_t i) const { return radii_[i]; }

  DiskLeaf leaf_of(std::uint32_t i) const {
    const PointBox box = measured_.feet.leaf_of(i);
    const Vec3 low = widen(box.low), high = widen(box.high);
    const std::uint32_t begin = i / PointTree::kLeafSize * PointTree::kLeafSize;
    return {begin, measured_.feet.end_of_leaf(begin), 0.5 * (low + high), norm(high - low)};
  }
  double window(std::uint32_t i, const DiskLeaf& leaf) const {
    return std::min(kWindow * radii_[i], kLeavesInWindow * leaf.diagonal);
  }
  double wide_window(std::uint32_t i) const {
    return std::min(kWide * radii_[i], kLeavesInWide * leaf_of(i).diagonal);
  }
  // Returns the radius about a leaf's centre that holds the windows of all its disks, m.
  double reach(const DiskLeaf& leaf) const {
    double widest = 0;
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i)
      widest = std::max(widest, window(i, leaf));
    return 0.5 * leaf.diagonal + widest;
  }

  // Calls visit(j) for the disks in a ball. Stops and returns false after more than `most`.
  template <class Visit>
  bool for_disks_near(Vec3 center, double reach, std::uint32_t most, const Visit& visit) const {
    std::uint32_t count = 0;
    return measured_.feet.for_points_in_ball(center, reach * reach, [&](std::uint32_t j) {
      visit(j);
      return ++count <= most;
    });
  }
  // Calls visit(first disk) for each leaf that a ball touches, until it returns false.
  template <class Visit>
  bool for_leaves_near(Vec3 center, double reach, const Visit& visit) const {
    return measured_.feet.for_leaves_in_ball(
        center, reach * reach, [&](std::uint32_t begin, std::uint32_t) { return visit(begin); });
  }
  std::uint32_t nearest_marked(Vec3 x, const PointNumbers& marks) const {
    return measured_.feet.nearest_marked(x, marks);
  }
  bool gather(Vec3 center, double reach, std::uint32_t most, std::vector<Disk>& disks) const {
    disks.clear();
    return for_disks_near(center, reach, most, [&](std::uint32_t j) { disks.push_back(disk(j)); });
  }
  // Calls gathers(reach) for a ball that is halved until it returns true, kHalvings times at most.
  template <class Gathers>
  static bool halve_until(double& reach, const Gathers& gathers) {
    bool all = gathers(reach);
    for (int k = 0; !all && reach > 0 && k < kHalvings; ++k) all = gathers(reach *= 0.5);
    return all;
  }

 private:
  const DiskSurface& measured_;
  std::span<const float> radii_;
};

}  // namespace vpm
