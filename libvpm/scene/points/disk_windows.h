// Sums up the disks of a cloud about one of them, within windows that follow its sampling radius,
// and finds second planes close to it, for the leaves of a cloud in parallel.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/core/vec3.h"
#include "libvpm/scene/points/disk_surface.h"

namespace vpm {

// A disk of the cloud as the sums below read it.
struct Disk {
  Vec3 place, normal;  // centre, about the cloud's origin, m; unit vector into free space
};

// Limits of the cosine between the normals of two disks.
inline constexpr double kAlike = 0.9;      // above: one surface; 25 degrees
inline constexpr double kOpposite = -0.8;  // below: two sides of a plate or slot; 143 degrees

// Largest height, as a part of the ball's radius, at which another disk shows the same surface.
inline constexpr double kOneSurface = 0.7;

// Sum of planes to be averaged, with the heights of a place above them.
struct PlaneSum {
  Vec3 normal, place;
  double height = 0;
  std::uint32_t count = 0;

  void add(const Disk& disk, Vec3 above) {
    normal += disk.normal;
    place += disk.place;
    height += dot(disk.normal, above - disk.place);
    ++count;
  }
  // Adds another sum, whose heights are those of a place that is `away` from the one of this sum.
  void add(const PlaneSum& other, Vec3 away) {
    normal += other.normal;
    place += other.place;
    height += other.height + dot(other.normal, away);
    count += other.count;
  }
};

// Sums over the disks in a ball about one disk.
struct Neighborhood {
  Vec3 normals;       // sum over alike disks on the same surface
  double height = 0;  // sum of the heights along the disk's normal at which these show it, m
  std::uint32_t alike = 0, unlike = 0;
  PlaneSum opposite;

  std::uint32_t count() const { return alike + unlike + opposite.count; }
};

// A disk, and the ball about it whose disks are summed up.
struct DiskInBall {
  Disk disk;
  double reach = 0;  // radius of the ball, m
};

// Sums up, for four disks at once by vectors, the disks in the ball about each. `near` holds all of
// these, and may hold others.
void look_around(std::span<const Disk> near, const DiskInBall (&disks)[4],
                 Neighborhood (&found)[4]);

// Radii of windows, in sampling radii: kWindow is a little wider than the 7 x 7 pixels by which
// normals are estimated, kWide reaches beyond windows that hold both sides of a crease.
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

// Holds the sampling radii of disks, m, and refers to these.
struct MeasuredDisks {
  PointTree feet;
  const Vec3f* normals = nullptr;
  std::vector<float> radii;
};

// Lists for each leaf of measured disks those near it, once for all that asks. Thread-safe.
class DiskWindows {
 public:
  explicit DiskWindows(MeasuredDisks measured);

  const MeasuredDisks& disks() const { return measured_; }
  std::uint32_t count() const { return measured_.feet.count; }
  std::uint32_t leaf_count() const {
    return (count() + PointTree::kLeafSize - 1) / PointTree::kLeafSize;
  }
  Disk disk(std::uint32_t i) const {
    return {widen(measured_.feet.points[i]), widen(measured_.normals[i])};
  }
  double radius(std::uint32_t i) const { return measured_.radii[i]; }

  DiskLeaf leaf_of(std::uint32_t i) const {
    const PointBox box = measured_.feet.leaf_of(i);
    const Vec3 low = widen(box.low), high = widen(box.high);
    const std::uint32_t begin = i / PointTree::kLeafSize * PointTree::kLeafSize;
    return {begin, measured_.feet.end_of_leaf(begin), 0.5 * (low + high), norm(high - low)};
  }
  // Returns the radius of a disk's window, m; that of wide_window() reaches beyond a crease.
  double window(std::uint32_t i, const DiskLeaf& leaf) const {
    return at_most(kWindow * measured_.radii[i], kLeavesInWindow * leaf.diagonal);
  }
  double wide_window(std::uint32_t i, const DiskLeaf& leaf) const {
    return at_most(kWide * measured_.radii[i], kLeavesInWide * leaf.diagonal);
  }
  // Returns the lesser of a radius and a limit, m. A limit of 0 bounds nothing: it comes from a
  // leaf without extent, whose disks are all at one place.
  static double at_most(double radius, double limit) {
    return limit > 0 ? std::min(radius, limit) : radius;
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
  // Calls visit(leaf) for each leaf that the ball about one with its disks' windows touches, until
  // it returns false. Returns the last value.
  template <class Visit>
  bool for_leaves_about(const DiskLeaf& leaf, const Visit& visit) const {
    const std::span<const std::uint32_t> listed = near_leaves(leaf);
    if (!listed.empty()) return std::ranges::all_of(listed, visit);
    const double reach = this->reach(leaf);
    return measured_.feet.for_leaves_in_ball(
        leaf.center, reach * reach,
        [&](std::uint32_t begin, std::uint32_t) { return visit(begin / PointTree::kLeafSize); });
  }
  // Calls visit(j) for the disks in that ball. Stops and returns false after more than `most`.
  template <class Visit>
  bool for_disks_about(const DiskLeaf& leaf, std::uint32_t most, const Visit& visit) const {
    const double reach = this->reach(leaf);
    const std::span<const std::uint32_t> leaves = near_leaves(leaf);
    if (leaves.empty()) return for_disks_near(leaf.center, reach, most, visit);
    std::uint32_t listed[kMostNear * PointTree::kLeafSize];
    const std::uint32_t size =
        measured_.feet.list_points(leaves, leaf.center, reach * reach, listed);
    for (std::uint32_t k = 0; k < size; ++k) visit(listed[k]);
    return true;
  }
  // Returns the disk nearest to x with a mark above 0, or kNoPoint.
  std::uint32_t nearest_marked(Vec3 x, const PointNumbers& marks) const {
    return measured_.feet.nearest_marked(x, marks);
  }
  // Fills `disks` with those in a ball. Returns false, with a part of them, if they are more than
  // `most`.
  bool gather(Vec3 center, double reach, std::uint32_t most, std::vector<Disk>& disks) const {
    disks.clear();
    return for_disks_near(center, reach, most, [&](std::uint32_t j) { disks.push_back(disk(j)); });
  }
  bool gather_about(const DiskLeaf& leaf, std::uint32_t most, std::vector<Disk>& disks) const {
    disks.clear();
    return for_disks_about(leaf, most, [&](std::uint32_t j) { disks.push_back(disk(j)); });
  }
  // Calls gathers(reach), and halves `reach`, m, as long as it returns false, kHalvings times at
  // most. Returns the last answer.
  template <class Gathers>
  static bool halve_until(double& reach, const Gathers& gathers) {
    bool all = gathers(reach);
    for (int k = 0; !all && reach > 0 && k < kHalvings; ++k) all = gathers(reach *= 0.5);
    return all;
  }

 private:
  // Leaves whose lists are made by one search, and kept together; more are not listed for a leaf.
  static constexpr std::uint32_t kLeavesOfBlock = 8, kLeavesOfRun = 128, kMostNear = 64;
  static constexpr double kSlack = 1 + 1e-9;  // more than distances are rounded by

  // Lists the leaves near those of a run; none where they are more than kMostNear.
  struct NearLeaves {
    struct Range {
      std::uint32_t begin, size;
    };
    std::vector<std::uint32_t> leaves;
    Range ranges[kLeavesOfRun];
  };

  // Lists the leaves near those of a block; `quads` is a buffer.
  void list_near(std::uint32_t first, std::uint32_t end, std::vector<std::uint32_t>& quads,
                 NearLeaves& near) const;
  std::span<const std::uint32_t> near_leaves(const DiskLeaf& leaf) const {
    const std::uint32_t k = leaf.begin / PointTree::kLeafSize;
    const NearLeaves& near = near_[k / kLeavesOfRun];
    const auto [begin, size] = near.ranges[k % kLeavesOfRun];
    return std::span(near.leaves).subspan(begin, size);
  }

  MeasuredDisks measured_;
  std::vector<NearLeaves> near_;
};

// Holds the mean of several disks: the plane with their mean normal at their mean height, through
// `foot`, and the mean `place` of their centres, m.
struct MeanPlane {
  Vec3 normal, foot, place;

  MeanPlane(const PlaneSum& sum, Vec3 above)
      : normal(normalized_or_zero(sum.normal)),
        foot(above - sum.height / sum.count * normal),
        place(1.0 / sum.count * sum.place) {}
};

// Largest thickness of a sheet, as a part of the sideways distance between the disks of its two
// sides.
inline constexpr double kNoThickness = 1e-6;

// Returns the second plane if each plane's disks lie behind the other, or in front of it, by at
// least `apart`, m. Planes on one another, back to back, are a sheet with two free sides, which is
// convex.
inline std::optional<SecondPlane> second_plane(const Disk& first, const MeanPlane& second,
                                               double apart) {
  const Vec3 across = second.place - first.place;
  const double ahead = dot(first.normal, across), back = -dot(second.normal, across);
  const double none = kNoThickness * norm(across);
  const bool is_sheet = apart == 0 && std::max(std::fabs(ahead), std::fabs(back)) <= none;
  if (is_sheet) return SecondPlane{narrow(second.normal), narrow(second.foot), true};
  if (!(ahead * back > 0 && std::min(std::fabs(ahead), std::fabs(back)) >= apart))
    return std::nullopt;
  return SecondPlane{narrow(second.normal), narrow(second.foot), ahead < 0};
}

// Holds what a thread that goes over leaves writes: buffers of disks and cells near the leaf, and
// the second planes that it found.
struct LeafWork {
  struct Found {
    std::uint32_t disk;
    SecondPlane second;
  };
  std::vector<Disk> near;
  std::vector<Found> found;
};

// Calls pass(leaf, work) for all leaves in parallel. Second planes are appended to the result in
// the order of their disks, whatever the threads' order was.
template <class Pass>
void for_leaves(const DiskWindows& windows, DenoisedDisks& result, const Pass& pass) {
  constexpr std::uint32_t kGrain = 128 * PointTree::kLeafSize;
  const std::uint32_t count = windows.count();
  std::vector<std::vector<LeafWork::Found>> found((count + kGrain - 1) / kGrain);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    LeafWork work;
    for (std::size_t run = begin; run < end; ++run) {
      const auto first = static_cast<std::uint32_t>(run) * kGrain;
      const std::uint32_t last = std::min(first + kGrain, count);
      for (std::uint32_t i = first; i < last; i += PointTree::kLeafSize)
        pass(windows.leaf_of(i), work);
      found[run].swap(work.found);
    }
  });
  for (const auto& of_run : found) {
    for (const LeafWork::Found& f : of_run) {
      result.second_of[f.disk] = static_cast<std::uint32_t>(result.seconds.size());
      result.seconds.push_back(f.second);
    }
  }
}

}  // namespace vpm
