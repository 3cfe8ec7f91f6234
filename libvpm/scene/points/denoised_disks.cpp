#include "libvpm/scene/points/denoised_disks.h"

#include <utility>

#include "libvpm/scene/points/second_planes.h"
#include "libvpm/scene/points/smoothed_disks.h"

namespace vpm {
namespace {

constexpr double kOnePlane = 2;      // radii: largest distance of a plane's disks from it
constexpr double kApart = 2;         // radii: from either side's plane to the other's middle
constexpr double kFurther = 2;       // widens windows that hold no smooth disk
constexpr double kExplained = 0.85;  // part of the points about a crease that must lie on it

// Denoises disks whose normals were estimated across a crease. Disks on no pair of planes that
// smooth disks show stay as they are, since they may be small and no crease.
class CreaseSettling {
 public:
  CreaseSettling(const DiskWindows& windows, const std::vector<DiskKind>& kinds,
                 DenoisedDisks& result)
      : windows_(windows), kinds_(kinds), result_(result) {
    smooth_.reserve(kinds.size());
    for (const DiskKind kind : kinds) smooth_.push_back(is_smooth(kind) ? 1.0F : 0.0F);
    nodes_with_smooth_ = largest_in_nodes(smooth_);
  }

  // Reads denoised smooth disks, and writes only others.
  void run() {
    for_leaves(windows_, result_, [&](const DiskLeaf& leaf, LeafWork& work) {
      std::vector<SmoothDisk> disks;
      for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
        if (is_smooth(kinds_[i])) continue;
        const std::uint32_t nearest = windows_.nearest_marked(
            windows_.disk(i).place, {smooth_.data(), nodes_with_smooth_.data()});
        if (nearest == kNoPoint) return;
        if (kinds_[i] == DiskKind::stray ||
            (kinds_[i] == DiskKind::outlier && is_near(nearest, i))) {
          join(nearest, i);
        } else if (kinds_[i] == DiskKind::bent && is_within_reach(nearest, i)) {
          gather_smooth_about(i, disks);
          if (!disks.empty()) denoise_at_crease(i, disks, work);
        }
      }
    });
  }

 private:
  // Describes a smooth disk near a place.
  struct SmoothDisk {
    std::uint32_t index;
    Disk disk;
    double height;  // height of the place above the disk's plane, m
  };

  void denoise_at_crease(std::uint32_t i, const std::vector<SmoothDisk>& disks, LeafWork& work) {
    const Vec3 place = windows_.disk(i).place;
    const SmoothDisk* const own = best_of(disks, nullptr);
    const SmoothDisk* const other = best_of(disks, own);
    if (other == nullptr || std::fabs(own->height) > kWindow * windows_.radius(i)) return;
    const double tolerance = kOnePlane * windows_.radius(i);
    const MeanPlane first = mean_about(own->disk, disks, place, tolerance);
    const auto second =
        second_plane({first.place, first.normal}, mean_about(other->disk, disks, place, tolerance),
                     kApart * windows_.radius(i));
    if (!second || !explains(first, *second, i)) return;
    set(i, first);
    work.found.push_back({i, *second});
  }
  void set(std::uint32_t i, const MeanPlane& plane) {
    result_.feet[i] = narrow(plane.foot);
    result_.normals[i] = narrow(plane.normal);
  }

  // Makes an outlier a copy of the nearest smooth disk. Its own plane would continue a wall into
  // nothing.
  void join(std::uint32_t nearest, std::uint32_t i) {
    result_.feet[i] = result_.feet[nearest];
    result_.normals[i] = result_.normals[nearest];
    result_.second_of[i] = result_.second_of[nearest];
    result_.radii[i] = result_.radii[nearest];
  }
  // True if a disk lies within the nearest smooth disk's windows; others may be something small.
  bool is_near(std::uint32_t nearest, std::uint32_t i) const {
    const double reach = kFurther * kWide * windows_.radius(nearest);
    const Vec3 away = widen(result_.feet[nearest]) - windows_.disk(i).place;
    return squared_norm(away) <= reach * reach;
  }

  // Gathers the smooth disks in a ball. Returns false if they are more than `most`.
  bool gather_smooth(Vec3 center, double reach, std::uint32_t most,
                     std::vector<SmoothDisk>& disks) const {
    disks.clear();
    return windows_.for_disks_near(center, reach, most, [&](std::uint32_t j) {
      if (!is_smooth(kinds_[j])) return;
      const Disk denoised{widen(result_.feet[j]), widen(result_.normals[j])};
      disks.push_back({j, denoised, dot(denoised.normal, center - denoised.place)});
    });
  }

  // False if gather_smooth_about() surely finds none, so that its search can be skipped.
  bool is_within_reach(std::uint32_t nearest, std::uint32_t i) const {
    const double reach = kFurther * windows_.wide_window(i);
    return squared_norm(windows_.disk(nearest).place - windows_.disk(i).place) <= reach * reach;
  }
  void gather_smooth_about(std::uint32_t i, std::vector<SmoothDisk>& disks) const {
    const Vec3 place = windows_.disk(i).place;
    double reach = windows_.wide_window(i);
    DiskWindows::halve_until(reach,
                             [&](double r) { return gather_smooth(place, r, kMostInWide, disks); });
    if (disks.empty()) gather_smooth(place, kFurther * reach, 4 * kMostInWide, disks);
  }

  // Returns the disk on whose plane the place lies best; with `other`, among those that face
  // elsewhere.
  static const SmoothDisk* best_of(const std::vector<SmoothDisk>& disks, const SmoothDisk* other) {
    const SmoothDisk* best = nullptr;
    for (const SmoothDisk& d : disks) {
      if (other != nullptr) {
        const double cosine = dot(d.disk.normal, other->disk.normal);
        if (cosine >= kAlike || cosine <= kOpposite) continue;
      }
      const double off = std::fabs(d.height);
      if (best == nullptr || off < std::fabs(best->height) ||
          (off == std::fabs(best->height) && d.index < best->index))
        best = &d;
    }
    return best;
  }
  // Returns the mean of the disks on the same plane as one of them.
  static MeanPlane mean_about(const Disk& one, const std::vector<SmoothDisk>& disks, Vec3 place,
                              double tolerance) {
    PlaneSum sum;
    for (const SmoothDisk& d : disks) {
      if (dot(d.disk.normal, one.normal) >= kAlike &&
          std::fabs(dot(one.normal, d.disk.place - one.place)) <= tolerance)
        sum.add(d.disk, place);
    }
    return {sum, place};
  }

  // True if most points about a disk lie on the surface that two planes enclose.
  bool explains(const MeanPlane& first, const SecondPlane& second, std::uint32_t i) const {
    const Vec3 normal = widen(second.normal), foot = widen(second.foot);
    const double near = kOnePlane * windows_.radius(i);
    std::uint32_t on = 0, all = 0;
    const auto count = [&](std::uint32_t j) {
      const Disk other = windows_.disk(j);
      const double a = dot(first.normal, other.place - first.foot),
                   b = dot(normal, other.place - foot);
      ++all;
      on += std::fabs(second.is_convex ? std::max(a, b) : std::min(a, b)) <= near;
    };
    windows_.for_disks_near(windows_.disk(i).place, windows_.window(i, windows_.leaf_of(i)),
                            kMostInWide, count);
    return on >= kExplained * all;
  }

  const DiskWindows& windows_;
  const std::vector<DiskKind>& kinds_;
  DenoisedDisks& result_;
  std::vector<float> smooth_, nodes_with_smooth_;  // PointNumbers: 1 for smooth disks, 0 for others
};

}  // namespace

DenoisedDisks off(const DiskSurface& measured, std::vector<float> radii) {
  const std::uint32_t count = measured.feet.count;
  return {{measured.feet.points, measured.feet.points + count},
          {measured.normals, measured.normals + count},
          std::vector<std::uint32_t>(count, kNoPoint),
          std::move(radii),
          {}};
}

DenoisedDisks settle(const DiskSurface& measured, std::vector<float> radii) {
  const std::vector<float> as_given = radii;
  DenoisedDisks result = off(measured, std::move(radii));
  const DiskWindows windows(measured, as_given);
  const std::vector<DiskKind> kinds = smooth(windows, result);
  CreaseSettling(windows, kinds, result).run();
  return result;
}

}  // namespace vpm
