// Finds second planes close to disks, for the leaves of a cloud in parallel.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/scene/points/denoised_disks.h"
#include "libvpm/scene/points/disk_windows.h"

namespace vpm {

// Holds the mean of several planes, through `foot`; `place` is the mean of their disks.
struct MeanPlane {
  Vec3 normal, foot, place;

  MeanPlane(const PlaneSum& sum, Vec3 above)
      : normal(normalized_or_zero(sum.normal)),
        foot(above - sum.height / sum.count * normal),
        place(1.0 / sum.count * sum.place) {}
};

// Bounds a sheet's thickness, as a part of the sideways distance between its sides' disks.
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

// Holds scratch and results of a thread that goes over leaves.
struct LeafWork {
  struct Found {
    std::uint32_t disk;
    SecondPlane second;
  };
  std::vector<Disk> near;
  std::vector<Found> found;
};

// Calls pass(leaf, work) for all leaves in parallel. Numbers what they find in the disks' order.
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
