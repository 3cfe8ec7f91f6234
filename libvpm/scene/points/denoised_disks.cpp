#include <optional>
#include <utility>
#include <vector>

#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/points/disk_windows.h"

namespace vpm {
namespace {

// Kinds of a measured disk, by the disks about it; from `smooth` on, windows of alike disks serve.
enum class DiskKind : std::uint8_t {
  stray,    // hardly any disks about it are alike: on no surface of the cloud
  outlier,  // few disks about it are alike, and others face elsewhere
  bent,     // many disks about it face elsewhere: at a crease, or on something small
  smooth,   // few disks about it face elsewhere
  clear,    // few disks about it face elsewhere than their mean
};
inline bool is_smooth(DiskKind kind) {
  return kind >= DiskKind::smooth;
}

constexpr std::uint32_t kFewOpposite = 5;  // fewer disks that face back show no second side
// A disk with few alike neighbours stands off alone, so that it tells no surface, if it lies higher
// than this above them on average, in sampling radii.
constexpr double kStandsOff = 2;
// Neighbours are alike if their normals differ by less than 25 degrees (kAlike). A disk is a stray
// if fewer than kFewTogether neighbours are alike, even within twice the usual distance, and an
// outlier if fewer than kFewAlike are and too many others are not.
constexpr std::uint32_t kFewTogether = 4, kFewAlike = 10;
// Most unlike disks about a disk, as a part of the alike ones.
constexpr double kUnlikeOfSmooth = 0.1;
constexpr double kUnlikeOfCalm = 0.02;  // in a calm leaf: noise alone turns so few elsewhere

bool is_among_its_like(const Neighborhood& around) {
  return around.unlike <= kUnlikeOfSmooth * around.alike;
}

DiskKind kind_of(const Neighborhood& around) {
  const bool is_smooth = is_among_its_like(around);
  if (around.alike < kFewTogether) return DiskKind::stray;
  if (is_smooth) return DiskKind::smooth;
  return around.alike < kFewAlike ? DiskKind::outlier : DiskKind::bent;
}

// Takes the first step of denoising disks: each becomes the mean of those about it that face its
// way, except those whose normals were estimated across a crease. Disks on both sides of a plate or
// slot receive each other's plane as second plane.
class Smoothing {
 public:
  Smoothing(const DiskWindows& windows, DenoisedDisks& result)
      : windows_(windows),
        result_(result),
        kinds_(windows.count()),
        is_calm_(leaf_count()),
        is_beside_(leaf_count()) {}

  // Runs the passes and returns the kinds of the disks. The work for a disk writes that disk alone
  // and reads of others only what the pass does not write, so that the order of threads does not
  // matter.
  std::vector<DiskKind> run() {
    pass([&](const DiskLeaf& leaf, LeafWork& work) { denoise_among_alike(leaf, work); });
    pass([&](const DiskLeaf& leaf, LeafWork& work) { find_clear(leaf, work); });
    pass([&](const DiskLeaf& leaf, LeafWork& work) { denoise_beside_creases(leaf, work); });
    before_.reserve(windows_.count());
    for (std::uint32_t i = 0; i < windows_.count(); ++i) before_.push_back(denoised(i));
    pass([&](const DiskLeaf& leaf, LeafWork& work) { denoise_among_denoised(leaf, work); });
    return std::move(kinds_);
  }

 private:
  std::uint32_t leaf_count() const {
    return (windows_.count() + PointTree::kLeafSize - 1) / PointTree::kLeafSize;
  }
  template <class Pass>
  void pass(const Pass& pass) {
    for_leaves(windows_, result_, pass);
  }

  Disk denoised(std::uint32_t i) const {
    return {widen(result_.feet[i]), widen(result_.normals[i])};
  }
  // Returns the measured disk with the mean normal of those about it.
  Disk turned(std::uint32_t i) const { return {windows_.disk(i).place, widen(result_.normals[i])}; }
  // Moves a disk along its normal to the mean height of those about it, and gives it their normal.
  void set(std::uint32_t i, const Disk& disk, const Neighborhood& around) {
    result_.feet[i] = narrow(disk.place + around.height / around.alike * disk.normal);
    result_.normals[i] = narrow(normalized_or_zero(around.normals));
  }

  // Calls take(i, disk, neighborhood) for the disks of a leaf, each given by disk_of(i). `near`
  // holds the disks in all their windows.
  template <class DiskOf, class Take>
  void look_around_each(const DiskLeaf& leaf, std::span<const Disk> near, const DiskOf& disk_of,
                        const Take& take) const {
    for (std::uint32_t first = leaf.begin; first < leaf.end; first += 4) {
      DiskInBall four[4];
      Neighborhood found[4];
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t i = std::min(first + k, leaf.end - 1);
        four[k] = {disk_of(i), windows_.window(i, leaf)};
      }
      look_around(near, four, found);
      for (std::uint32_t k = 0; k < 4 && first + k < leaf.end; ++k)
        take(first + k, four[k], found[k]);
    }
  }

  void denoise_among_alike(const DiskLeaf& leaf, LeafWork& work) {
    if (!windows_.gather(leaf.center, windows_.reach(leaf), kMostInWide, work.near))
      work.near.clear();
    bool is_calm = true;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return windows_.disk(i); },
        [&](std::uint32_t i, const DiskInBall& own, const Neighborhood& around) {
          const bool is_usual = around.count() <= kMostInWindow && around.alike >= kFewAlike;
          const auto all = is_usual ? around : look_further(i, own);
          if (all && all->alike > 0) set(i, own.disk, *all);
          kinds_[i] = all ? kind_of(*all) : DiskKind::outlier;
          is_calm &= is_smooth(kinds_[i]) && all->unlike <= kUnlikeOfCalm * all->alike;
        });
    is_calm_[leaf.begin / PointTree::kLeafSize] = is_calm;
  }

  // Sums up the surroundings of a disk with few neighbours, or many. Returns nothing if there are
  // too many however small the window, and an empty sum for a disk that stands off alone.
  std::optional<Neighborhood> look_further(std::uint32_t i, const DiskInBall& one) const {
    std::vector<Disk> near;
    double reach = one.reach;
    const auto gathers = [&](double r) {
      return windows_.gather(one.disk.place, r, kMostInWindow, near);
    };
    if (!DiskWindows::halve_until(reach, gathers)) return std::nullopt;
    const Neighborhood around = look_around_one(near, {one.disk, reach});
    if (around.alike >= kFewAlike) return around;
    if (!windows_.gather(one.disk.place, 2 * reach, kMostInWide, near)) return around;
    const Neighborhood further = look_around_one(near, {one.disk, 2 * reach});
    const double furthest = kStandsOff * windows_.radius(i);
    return std::fabs(further.height) <= furthest * further.alike ? further : Neighborhood{};
  }
  static Neighborhood look_around_one(std::span<const Disk> near, const DiskInBall& one) {
    const DiskInBall four[4] = {one, one, one, one};
    Neighborhood found[4];
    look_around(near, four, found);
    return found[0];
  }

  // True if hardly any disks about a leaf face elsewhere.
  bool is_calm_about(const DiskLeaf& leaf) const {
    return windows_.for_leaves_near(leaf.center, windows_.reach(leaf), [&](std::uint32_t begin) {
      return is_calm_[begin / PointTree::kLeafSize] != 0;
    });
  }

  // Marks clear disks by the mean normal about them. Their own normals would not do: disks that
  // noise has turned toward the far side of a crease find fewer unlike ones, and their mean would
  // lean that way.
  void find_clear(const DiskLeaf& leaf, LeafWork& work) {
    if (is_calm_about(leaf)) {
      for (std::uint32_t i = leaf.begin; i < leaf.end; ++i)
        kinds_[i] = DiskKind::clear;  // all smooth
      return;
    }
    is_beside_[leaf.begin / PointTree::kLeafSize] = 1;
    if (!windows_.gather(leaf.center, windows_.reach(leaf), kMostInWide, work.near)) return;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return turned(i); },
        [&](std::uint32_t i, const DiskInBall&, const Neighborhood& around) {
          if (kinds_[i] == DiskKind::smooth && is_among_its_like(around))
            kinds_[i] = DiskKind::clear;
        });
  }

  // Denoises disks beside creases by clear ones only, since other windows may cross the crease.
  void denoise_beside_creases(const DiskLeaf& leaf, LeafWork& work) {
    if (is_beside_[leaf.begin / PointTree::kLeafSize] == 0) return;
    work.near.clear();
    const auto take_clear = [&](std::uint32_t j) {
      if (kinds_[j] == DiskKind::clear) work.near.push_back(windows_.disk(j));
    };
    if (!windows_.for_disks_near(leaf.center, windows_.reach(leaf), kMostInWide, take_clear))
      return;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return turned(i); },
        [&](std::uint32_t i, const DiskInBall& own, const Neighborhood& around) {
          if (is_smooth(kinds_[i]) && around.alike >= kFewAlike) set(i, own.disk, around);
        });
  }

  // Averages the means again, to even out noise on the scale of the windows, whose most displaced
  // disks would be the nearest. Opposite sides are found here, where both are denoised.
  void denoise_among_denoised(const DiskLeaf& leaf, LeafWork& work) {
    work.near.clear();
    const auto take_smooth = [&](std::uint32_t j) {
      if (is_smooth(kinds_[j])) work.near.push_back(before_[j]);
    };
    if (!windows_.for_disks_near(leaf.center, windows_.reach(leaf), kMostInWide, take_smooth))
      return;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return denoised(i); },
        [&](std::uint32_t i, const DiskInBall& own, const Neighborhood& around) {
          if (!is_smooth(kinds_[i])) return;
          if (around.alike >= kFewAlike) set(i, own.disk, around);
          if (around.opposite.count < kFewOpposite) return;
          const MeanPlane opposite(around.opposite, own.disk.place);
          if (const auto second = second_plane(denoised(i), opposite, 0))
            work.found.push_back({i, *second});
        });
  }

  const DiskWindows& windows_;
  DenoisedDisks& result_;
  std::vector<DiskKind> kinds_;
  // Per leaf: hardly any disks about its disks face elsewhere; a leaf near it is not calm.
  std::vector<char> is_calm_, is_beside_;
  std::vector<Disk> before_;  // the disks before the last pass
};

constexpr double kOnePlane = 2;  // radii: largest distance of a plane's disks from it
constexpr double kApart = 2;    // radii: least distance of one side's middle from the other's plane
constexpr double kFurther = 2;  // factor by which windows grow that hold no smooth disk
constexpr double kExplained = 0.85;  // part of the points about a crease that must lie on it

// Denoises disks whose normals were estimated across a crease. Disks on no pair of planes that
// smooth disks show stay as they are, since they may be small and no crease.
class CreaseDenoising {
 public:
  CreaseDenoising(const DiskWindows& windows, const std::vector<DiskKind>& kinds,
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

DenoisedDisks as_measured(const DiskSurface& measured, std::vector<float> radii) {
  const std::uint32_t count = measured.feet.count;
  return {{measured.feet.points, measured.feet.points + count},
          {measured.normals, measured.normals + count},
          std::vector<std::uint32_t>(count, kNoPoint),
          std::move(radii),
          {}};
}

DenoisedDisks denoised(const DiskSurface& measured, std::vector<float> radii) {
  const std::vector<float> as_given = radii;
  DenoisedDisks result = as_measured(measured, std::move(radii));
  const DiskWindows windows(measured, as_given);
  const std::vector<DiskKind> kinds = Smoothing(windows, result).run();
  CreaseDenoising(windows, kinds, result).run();
  return result;
}

}  // namespace vpm
