#include <algorithm>
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
        is_calm_(windows.leaf_count()),
        is_beside_(windows.leaf_count()) {}

  // Runs the passes and returns the kinds of the disks. The work for a disk writes that disk alone
  // and reads of others only what the pass does not write, so that the order of threads does not
  // matter.
  std::vector<DiskKind> run() {
    pass([&](const DiskLeaf& leaf, LeafWork& work) { denoise_among_alike(leaf, work); });
    pass([&](const DiskLeaf& leaf, LeafWork& work) { find_clear(leaf, work); });
    pass([&](const DiskLeaf& leaf, LeafWork& work) { denoise_beside_creases(leaf, work); });
    feet_before_ = result_.feet;
    normals_before_ = result_.normals;
    pass([&](const DiskLeaf& leaf, LeafWork& work) { denoise_among_denoised(leaf, work); });
    return std::move(kinds_);
  }

 private:
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

  // Calls take(i, disk, neighborhood) for the disks of a leaf that wants(i) is true for, each given
  // by disk_of(i). `near` holds the disks in all their windows.
  template <class Wants, class DiskOf, class Take>
  void look_around_each(const DiskLeaf& leaf, std::span<const Disk> near, const Wants& wants,
                        const DiskOf& disk_of, const Take& take) const {
    std::uint32_t wanted[PointTree::kLeafSize], size = 0;
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
      if (wants(i)) wanted[size++] = i;
    }
    for (std::uint32_t first = 0; first < size; first += 4) {
      DiskInBall four[4];
      Neighborhood found[4];
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t i = wanted[std::min(first + k, size - 1)];
        four[k] = {disk_of(i), windows_.window(i, leaf)};
      }
      look_around(near, four, found);
      for (std::uint32_t k = 0; k < 4 && first + k < size; ++k)
        take(wanted[first + k], four[k], found[k]);
    }
  }
  bool has_smooth(const DiskLeaf& leaf) const {
    return std::any_of(kinds_.begin() + leaf.begin, kinds_.begin() + leaf.end, is_smooth);
  }

  void denoise_among_alike(const DiskLeaf& leaf, LeafWork& work) {
    if (!windows_.gather_about(leaf, kMostInWide, work.near)) work.near.clear();
    bool is_calm = true;
    look_around_each(
        leaf, work.near, [](std::uint32_t) { return true; },
        [&](std::uint32_t i) { return windows_.disk(i); },
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
    return windows_.for_leaves_about(leaf, [&](std::uint32_t k) { return is_calm_[k] != 0; });
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
    if (!has_smooth(leaf) || !windows_.gather_about(leaf, kMostInWide, work.near)) return;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return is_smooth(kinds_[i]); },
        [&](std::uint32_t i) { return turned(i); },
        [&](std::uint32_t i, const DiskInBall&, const Neighborhood& around) {
          if (is_among_its_like(around)) kinds_[i] = DiskKind::clear;
        });
  }

  // Denoises disks beside creases by clear ones only, since other windows may cross the crease.
  void denoise_beside_creases(const DiskLeaf& leaf, LeafWork& work) {
    if (is_beside_[leaf.begin / PointTree::kLeafSize] == 0 || !has_smooth(leaf)) return;
    work.near.clear();
    const auto take_clear = [&](std::uint32_t j) {
      if (kinds_[j] == DiskKind::clear) work.near.push_back(windows_.disk(j));
    };
    if (!windows_.for_disks_about(leaf, kMostInWide, take_clear)) return;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return is_smooth(kinds_[i]); },
        [&](std::uint32_t i) { return turned(i); },
        [&](std::uint32_t i, const DiskInBall& own, const Neighborhood& around) {
          if (around.alike >= kFewAlike) set(i, own.disk, around);
        });
  }

  // Averages the means again, to even out noise on the scale of the windows, whose most displaced
  // disks would be the nearest. Opposite sides are found here, where both are denoised.
  void denoise_among_denoised(const DiskLeaf& leaf, LeafWork& work) {
    if (!has_smooth(leaf)) return;
    work.near.clear();
    const auto take_smooth = [&](std::uint32_t j) {
      if (is_smooth(kinds_[j]))
        work.near.push_back({widen(feet_before_[j]), widen(normals_before_[j])});
    };
    if (!windows_.for_disks_about(leaf, kMostInWide, take_smooth)) return;
    look_around_each(
        leaf, work.near, [&](std::uint32_t i) { return is_smooth(kinds_[i]); },
        [&](std::uint32_t i) { return denoised(i); },
        [&](std::uint32_t i, const DiskInBall& own, const Neighborhood& around) {
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
  // Per leaf: hardly any disks about its disks face
  // elsewhere; a leaf near it is not calm.
  std::vector<char> is_calm_, is_beside_;
  std::vector<Vec3f> feet_before_, normals_before_;  // the disks before the last pass
};

constexpr double kOnePlane = 2;  // radii: largest distance of a plane's disks from it
constexpr double kApart = 2;  // radii: least distance of one side's middle from the other's plane
constexpr std::size_t kMostCells = 4096;  // about a leaf; more are of disks far too wide
constexpr double kFurther = 2;            // factor by which windows grow that hold no smooth disk
constexpr double kExplained = 0.85;       // part of the points about a crease that must lie on it

// Describes smooth disks of a leaf that are alike to its first one: their mean, and their sum about
// their mean place.
struct SmoothCell {
  Disk disk;
  PlaneSum sum;

  SmoothCell() = default;
  explicit SmoothCell(const PlaneSum& about_origin)
      : disk{1.0 / about_origin.count * about_origin.place,
             normalized_or_zero(about_origin.normal)},
        sum(about_origin) {
    sum.height += dot(sum.normal, disk.place);
  }
};

// Denoises disks whose normals were estimated across a crease. Disks on no pair of planes that
// smooth disks show stay as they are, since they may be small and no crease.
class CreaseDenoising {
 public:
  CreaseDenoising(const DiskWindows& windows, const std::vector<DiskKind>& kinds,
                  DenoisedDisks& result)
      : windows_(windows), kinds_(kinds), result_(result), cells_(windows.leaf_count()) {
    smooth_.reserve(kinds.size());
    for (const DiskKind kind : kinds) smooth_.push_back(is_smooth(kind) ? 1.0F : 0.0F);
    nodes_with_smooth_ = largest_in_nodes(smooth_);
    for_leaves(windows, result, [&](const DiskLeaf& leaf, LeafWork&) { set_cell(leaf); });
  }

  // Reads denoised smooth disks, and writes only others.
  void run() {
    if (std::ranges::none_of(kinds_, is_smooth)) return;
    for_leaves(windows_, result_, [&](const DiskLeaf& leaf, LeafWork& work) {
      bool is_bent = false;
      for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
        is_bent |= kinds_[i] == DiskKind::bent;
        if (kinds_[i] != DiskKind::stray && kinds_[i] != DiskKind::outlier) continue;
        const std::uint32_t nearest = windows_.nearest_marked(
            windows_.disk(i).place, {smooth_.data(), nodes_with_smooth_.data()});
        if (kinds_[i] == DiskKind::stray || is_near(nearest, i)) join(nearest, i);
      }
      if (is_bent) denoise_at_crease(leaf, work);
    });
  }

 private:
  // Describes a cell near a place.
  struct NearCell {
    const SmoothCell* cell;
    double height;  // height of the place above the cell's plane, m
  };

  void set_cell(const DiskLeaf& leaf) {
    PlaneSum sum;
    Vec3 first;
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
      if (!is_smooth(kinds_[i])) continue;
      const Disk disk{widen(result_.feet[i]), widen(result_.normals[i])};
      if (sum.count == 0) first = disk.normal;
      if (dot(disk.normal, first) >= kAlike) sum.add(disk, {});
    }
    if (sum.count > 0) cells_[leaf.begin / PointTree::kLeafSize] = SmoothCell(sum);
  }

  void denoise_at_crease(const DiskLeaf& leaf, LeafWork& work) const {
    double widest = 0;
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i)
      widest = std::max(widest, windows_.wide_window(i, leaf));
    const std::vector<const SmoothCell*> about =
        cells_about(leaf.center, 0.5 * leaf.diagonal + kFurther * widest);
    if (about.empty()) return;
    std::vector<NearCell> near;
    for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) {
      if (kinds_[i] != DiskKind::bent) continue;
      const double reach = windows_.wide_window(i, leaf);
      take_near(windows_.disk(i).place, reach, about, near);
      if (near.empty()) take_near(windows_.disk(i).place, kFurther * reach, about, near);
      if (!near.empty()) denoise_at_crease(i, leaf, near, work);
    }
  }
  void denoise_at_crease(std::uint32_t i, const DiskLeaf& leaf, const std::vector<NearCell>& cells,
                         LeafWork& work) const {
    const Vec3 place = windows_.disk(i).place;
    const NearCell* const own = best_of(cells, nullptr);
    const NearCell* const other = best_of(cells, own);
    if (other == nullptr || std::fabs(own->height) > kWindow * windows_.radius(i)) return;
    const double tolerance = kOnePlane * windows_.radius(i);
    const MeanPlane first = mean_about(own->cell->disk, cells, place, tolerance);
    const auto second = second_plane({first.place, first.normal},
                                     mean_about(other->cell->disk, cells, place, tolerance),
                                     kApart * windows_.radius(i));
    if (!second || !explains(first, *second, i, leaf)) return;
    result_.feet[i] = narrow(first.foot);
    result_.normals[i] = narrow(first.normal);
    work.found.push_back({i, *second});
  }

  // Makes an outlier a copy of the nearest smooth disk. Its own plane would continue a wall into
  // nothing.
  void join(std::uint32_t nearest, std::uint32_t i) const {
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

  // Returns the cells of leaves in a ball; none if they are more than kMostCells.
  std::vector<const SmoothCell*> cells_about(Vec3 center, double reach) const {
    std::vector<const SmoothCell*> cells;
    const bool all = windows_.disks().feet.for_leaves_in_ball<PointTree::OneByOne>(
        center, reach * reach, [&](std::uint32_t node) { return nodes_with_smooth_[node] > 0; },
        [&](std::uint32_t begin, std::uint32_t) {
          const SmoothCell& cell = cells_[begin / PointTree::kLeafSize];
          if (cell.sum.count > 0) cells.push_back(&cell);
          return cells.size() <= kMostCells;
        });
    if (!all) cells.clear();
    return cells;
  }
  // Fills `near` with the cells in a ball.
  static void take_near(Vec3 center, double reach, const std::vector<const SmoothCell*>& cells,
                        std::vector<NearCell>& near) {
    near.clear();
    for (const SmoothCell* cell : cells) {
      const Vec3 away = center - cell->disk.place;
      if (squared_norm(away) <= reach * reach) near.push_back({cell, dot(cell->disk.normal, away)});
    }
  }

  // Returns the cell on whose plane the place lies best; with `other`, among those that face
  // elsewhere. The first of equal ones.
  static const NearCell* best_of(const std::vector<NearCell>& cells, const NearCell* other) {
    const NearCell* best = nullptr;
    for (const NearCell& c : cells) {
      if (other != nullptr) {
        const double cosine = dot(c.cell->disk.normal, other->cell->disk.normal);
        if (cosine >= kAlike || cosine <= kOpposite) continue;
      }
      if (best == nullptr || std::fabs(c.height) < std::fabs(best->height)) best = &c;
    }
    return best;
  }
  // Returns the mean of the cells on the same plane as one of them.
  static MeanPlane mean_about(const Disk& one, const std::vector<NearCell>& cells, Vec3 place,
                              double tolerance) {
    PlaneSum sum;
    for (const NearCell& c : cells) {
      const Disk& disk = c.cell->disk;
      if (dot(disk.normal, one.normal) >= kAlike &&
          std::fabs(dot(one.normal, disk.place - one.place)) <= tolerance)
        sum.add(c.cell->sum, place - disk.place);
    }
    return {sum, place};
  }

  // True if most points about a disk lie on the surface that two planes enclose.
  bool explains(const MeanPlane& first, const SecondPlane& second, std::uint32_t i,
                const DiskLeaf& leaf) const {
    const Vec3 normal = widen(second.normal), foot = widen(second.foot);
    const double near = kOnePlane * windows_.radius(i);
    std::uint32_t on = 0, all = 0;
    const Vec3 place = windows_.disk(i).place;
    const double reach = windows_.window(i, leaf);
    windows_.for_disks_about(leaf, kMostInWide, [&](std::uint32_t j) {
      const Vec3 other = windows_.disk(j).place;
      if (squared_norm(other - place) > reach * reach) return;
      const double a = dot(first.normal, other - first.foot), b = dot(normal, other - foot);
      ++all;
      on += std::fabs(second.is_convex ? std::max(a, b) : std::min(a, b)) <= near;
    });
    return on >= kExplained * all;
  }

  const DiskWindows& windows_;
  const std::vector<DiskKind>& kinds_;
  DenoisedDisks& result_;
  std::vector<float> smooth_, nodes_with_smooth_;  // PointNumbers: 1 for smooth disks, 0 for others
  std::vector<SmoothCell> cells_;                  // per leaf
};

}  // namespace

DenoisedDisks as_measured(const DiskWindows& measured) {
  const auto& [feet, normals, radii] = measured.disks();
  const std::uint32_t count = measured.count();
  return {{feet.points, feet.points + count},
          {normals, normals + count},
          std::vector<std::uint32_t>(count, kNoPoint),
          radii,
          {}};
}

DenoisedDisks denoised(const DiskWindows& measured) {
  DenoisedDisks result = as_measured(measured);
  const std::vector<DiskKind> kinds = Smoothing(measured, result).run();
  CreaseDenoising(measured, kinds, result).run();
  return result;
}

}  // namespace vpm
