#include "libvpm/scene/points/smoothed_disks.h"

#include <optional>

#include "libvpm/scene/points/second_planes.h"

namespace vpm {
namespace {

constexpr std::uint32_t kFewOpposite = 5;
constexpr double kStandsOff = 2;  // radii, from the disks about it
// Fewer alike disks, also within twice the distance, make a stray; fewer than kFewAlike an outlier,
// if others are unlike it.
constexpr std::uint32_t kFewTogether = 4, kFewAlike = 10;
// Bounds the parts of unlike disks, relative to the alike ones.
constexpr double kUnlikeOfSmooth = 0.1;
constexpr double kUnlikeOfCalm = 0.02;  // few enough to be noise

bool is_among_its_like(const Neighborhood& around) {
  return around.unlike <= kUnlikeOfSmooth * around.alike;
}

DiskKind kind_of(const Neighborhood& around) {
  const bool is_smooth = is_among_its_like(around);
  if (around.alike < kFewTogether) return DiskKind::stray;
  if (is_smooth) return DiskKind::smooth;
  return around.alike < kFewAlike ? DiskKind::outlier : DiskKind::bent;
}

class Smoothing {
 public:
  Smoothing(const DiskWindows& windows, DenoisedDisks& result)
      : windows_(windows),
        result_(result),
        kinds_(windows.count()),
        is_calm_(leaf_count()),
        is_beside_(leaf_count()) {}

  // Runs the passes. A pass reads no other disk that it writes.
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
  std::vector<char> is_calm_, is_beside_;  // one per leaf
  std::vector<Disk> before_;
};

}  // namespace

std::vector<DiskKind> smooth(const DiskWindows& windows, DenoisedDisks& result) {
  return Smoothing(windows, result).run();
}

}  // namespace vpm
