#include "libvpm/query/settled_disks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "libvpm/core/parallel.h"
#include "libvpm/query/disk_neighborhood.h"

namespace vpm {
namespace {

// Radii of balls, in sampling radii: as wide as the window of 7 x 7 pixels by which normals are
// estimated; and beyond such windows, where these hold both sides of a crease.
constexpr double kWindow = 5.6, kWide = 14;
// Disks may be much wider than their spacing (seen at a grazing angle by one of several cameras).
// So no ball is wider than so many leaves of eight disks, and it is halved until it holds no more
// disks than this.
constexpr double kLeavesInWindow = 2.5, kLeavesInWide = 5;
constexpr std::uint32_t kMostInWindow = 256, kMostInWide = 2048;
constexpr int kHalvings = 10;
constexpr std::uint32_t kFewAlike = 10;  // fewer, twice as far too, are an outlier's
constexpr std::uint32_t kFewOpposite = 5;
constexpr double kUnlikeOfSmooth = 0.1;  // of those alike
constexpr double kOnePlane = 2;          // radii: disks of one plane are no further from it
constexpr double kApart = 2;             // radii: from either side's plane to the other's middle
constexpr double kExplained = 0.9;       // share of the points about a crease that lie on it

// A plane through `foot`, the mean of several; `place` is in their middle.
struct MeanPlane {
  Vec3 normal, foot, place;

  MeanPlane(const PlaneSum& sum, Vec3 above)
      : normal(normalized_or_zero(sum.normal)),
        foot(above - sum.height / sum.count * normal),
        place(1.0 / sum.count * sum.place) {}
};

// What two planes enclose, if each lies behind the other, or in front of it, by this much at least.
std::optional<SecondPlane> second_plane(const Disk& first, const MeanPlane& second, double apart) {
  const Vec3 across = second.place - first.place;
  const double ahead = dot(first.normal, across), back = -dot(second.normal, across);
  if (!(ahead * back > 0 && std::min(std::fabs(ahead), std::fabs(back)) >= apart))
    return std::nullopt;
  return SecondPlane{narrow(second.normal), narrow(second.foot), ahead < 0};
}

class Settling {
 public:
  Settling(const DiskSurface& measured, std::span<const float> radii)
      : measured_(measured),
        radii_(radii),
        kinds_(measured.feet.count),
        result_(as_measured(measured)) {}

  SettledDisks run() {
    // The second pass reads what the first one made of smooth disks, and writes only others.
    run(&Settling::settle_among_alike);
    run(&Settling::settle_at_creases);
    return std::move(result_);
  }

 private:
  static constexpr std::uint32_t kGrain = 1024;
  static_assert(kGrain % PointTree::kLeafSize == 0);
  struct Found {
    std::uint32_t disk;
    SecondPlane second;
  };
  enum class Kind : std::uint8_t {
    outlier,
    bent,  // others about it face elsewhere: at a crease, or on what is as small as the window
    smooth,
  };

  void run(void (Settling::*pass)(std::uint32_t, std::uint32_t, std::vector<Found>&)) {
    std::vector<std::vector<Found>> found((measured_.feet.count + kGrain - 1) / kGrain);
    parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t chunk = begin; chunk < end; ++chunk) {
        const auto first = static_cast<std::uint32_t>(chunk) * kGrain;
        (this->*pass)(first, std::min(first + kGrain, measured_.feet.count), found[chunk]);
      }
    });
    for (const std::vector<Found>& of_chunk : found) {
      for (const Found& f : of_chunk) {
        result_.second_of[f.disk] = static_cast<std::uint32_t>(result_.seconds.size());
        result_.seconds.push_back(f.second);
      }
    }
  }

  Disk disk(std::uint32_t i) const {
    return {widen(measured_.feet.points[i]), widen(measured_.normals[i])};
  }
  void set(std::uint32_t i, Vec3 foot, Vec3 normal) {
    result_.feet[i] = narrow(foot);
    result_.normals[i] = narrow(normal);
  }

  struct Leaf {
    Vec3 center;
    double diagonal;
  };
  Leaf leaf_of(std::uint32_t i) const {
    const PointBox box = measured_.feet.leaf_of(i);
    const Vec3 low = widen(box.low), high = widen(box.high);
    return {0.5 * (low + high), norm(high - low)};
  }
  double window(std::uint32_t i, const Leaf& leaf) const {
    return std::min(kWindow * radii_[i], kLeavesInWindow * leaf.diagonal);
  }

  // Calls visit(j) for the disks in a ball, until they are more than `most`: false then.
  template <class Visit>
  bool for_disks_near(Vec3 center, double reach, std::uint32_t most, const Visit& visit) const {
    std::uint32_t count = 0;
    return measured_.feet.for_points_in_ball(center, reach * reach, [&](std::uint32_t j) {
      visit(j);
      return ++count <= most;
    });
  }
  // Calls gathers(reach) for a ball that is halved until it says that its disks are not too many.
  template <class Gathers>
  static bool halve_until(double& reach, const Gathers& gathers) {
    bool all = gathers(reach);
    for (int k = 0; !all && k < kHalvings; ++k) all = gathers(reach *= 0.5);
    return all;
  }
  bool gather(Vec3 center, double reach, std::uint32_t most, std::vector<Disk>& disks) const {
    disks.clear();
    return for_disks_near(center, reach, most, [&](std::uint32_t j) { disks.push_back(disk(j)); });
  }

  void settle_among_alike(std::uint32_t begin, std::uint32_t end, std::vector<Found>& out) {
    std::vector<Disk> near;
    for (std::uint32_t first = begin; first < end; first += PointTree::kLeafSize)
      settle_leaf(first, std::min(first + PointTree::kLeafSize, end), near, out);
  }

  // The disks of a leaf have most neighbours in common.
  void settle_leaf(std::uint32_t begin, std::uint32_t end, std::vector<Disk>& near,
                   std::vector<Found>& out) {
    const Leaf leaf = leaf_of(begin);
    double widest = 0;
    for (std::uint32_t i = begin; i < end; ++i) widest = std::max(widest, window(i, leaf));
    const bool all = gather(leaf.center, 0.5 * leaf.diagonal + widest, kMostInWide, near);
    for (std::uint32_t first = begin; first < end; first += 4) {
      DiskInBall four[4];
      Neighborhood found[4];
      for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t i = std::min(first + k, end - 1);
        four[k] = {disk(i), window(i, leaf)};
      }
      if (all) look_around(near, four, found);
      for (std::uint32_t k = 0; k < 4 && first + k < end; ++k) {
        const bool is_usual = found[k].count() <= kMostInWindow && found[k].alike >= kFewAlike;
        settle(first + k, is_usual ? found[k] : look_further(four[k]), out);
      }
    }
  }

  // Of a disk that has few neighbours, or many.
  Neighborhood look_further(const DiskInBall& one) const {
    std::vector<Disk> near;
    Neighborhood found[4];
    DiskInBall four[4] = {one, one, one, one};
    const auto gathers = [&](double reach) {
      return gather(one.disk.place, reach, kMostInWindow, near);
    };
    if (!halve_until(four[0].reach, gathers)) return {};
    look_around(near, four, found);
    if (found[0].alike >= kFewAlike) return found[0];
    if (gather(one.disk.place, four[0].reach *= 2, kMostInWide, near))
      look_around(near, four, found);
    return found[0];
  }

  void settle(std::uint32_t i, const Neighborhood& around, std::vector<Found>& out) {
    if (around.alike == 0) return;
    const Disk own = disk(i);
    set(i, own.place + around.height / around.alike * own.normal,
        normalized_or_zero(around.normals));
    if (around.unlike > kUnlikeOfSmooth * around.alike) {
      kinds_[i] = around.alike < kFewAlike ? Kind::outlier : Kind::bent;
      return;
    }
    kinds_[i] = Kind::smooth;
    if (around.opposite.count < kFewOpposite) return;
    if (const auto second = second_plane(own, MeanPlane(around.opposite, own.place), 0))
      out.push_back({i, *second});
  }

  // A smooth disk near a place, as the first pass has left it.
  struct SmoothDisk {
    std::uint32_t index;
    Disk disk;
    double height;  // of the place above it
  };
  // Returns false if there are too many disks.
  bool gather_smooth(Vec3 center, double reach, std::uint32_t most,
                     std::vector<SmoothDisk>& disks) const {
    disks.clear();
    return for_disks_near(center, reach, most, [&](std::uint32_t j) {
      if (kinds_[j] != Kind::smooth) return;
      const Disk settled{widen(result_.feet[j]), widen(result_.normals[j])};
      disks.push_back({j, settled, dot(settled.normal, center - settled.place)});
    });
  }

  // The one on whose plane the place lies best; if `other` is given, of those that face elsewhere.
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
  // The mean of the disks that lie on the same plane as one of them.
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

  void settle_at_creases(std::uint32_t begin, std::uint32_t end, std::vector<Found>& out) {
    std::vector<SmoothDisk> disks;
    for (std::uint32_t i = begin; i < end; ++i) {
      if (kinds_[i] == Kind::smooth) continue;
      const Vec3 place = disk(i).place;
      double reach = std::min(kWide * radii_[i], kLeavesInWide * leaf_of(i).diagonal);
      halve_until(reach, [&](double r) { return gather_smooth(place, r, kMostInWide, disks); });
      if (disks.empty()) gather_smooth(place, 2 * reach, 4 * kMostInWide, disks);
      settle_at_crease(i, disks, out);
    }
  }

  // At a crease the normal was estimated across both its sides, and is that of neither. What is on
  // no plane of two that smooth disks show is left as it is: it may be small, and no crease.
  void settle_at_crease(std::uint32_t i, const std::vector<SmoothDisk>& disks,
                        std::vector<Found>& out) {
    const SmoothDisk* const own = best_of(disks, nullptr);
    if (own == nullptr) return;
    const SmoothDisk* const other = best_of(disks, own);
    if (kinds_[i] != Kind::outlier &&
        (other == nullptr || std::fabs(own->height) > kWindow * radii_[i]))
      return;
    const Vec3 place = disk(i).place;
    const double tolerance = kOnePlane * radii_[i];
    const MeanPlane first = mean_about(own->disk, disks, place, tolerance);
    if (other == nullptr) {  // an outlier
      set(i, first.foot, first.normal);
      return;
    }
    const auto second =
        second_plane({first.place, first.normal}, mean_about(other->disk, disks, place, tolerance),
                     kApart * radii_[i]);
    const bool shows = second && explains(first, *second, i);
    if (shows || kinds_[i] == Kind::outlier) set(i, first.foot, first.normal);
    if (shows) out.push_back({i, *second});
  }

  // Whether most points about a disk lie on what two planes enclose.
  bool explains(const MeanPlane& first, const SecondPlane& second, std::uint32_t i) const {
    const Vec3 normal = widen(second.normal), foot = widen(second.foot);
    const double near = kOnePlane * radii_[i];
    std::uint32_t on = 0, all = 0;
    for_disks_near(disk(i).place, window(i, leaf_of(i)), kMostInWide, [&](std::uint32_t j) {
      const Disk other = disk(j);
      const double a = dot(first.normal, other.place - first.foot),
                   b = dot(normal, other.place - foot);
      ++all;
      on += std::fabs(second.is_convex ? std::max(a, b) : std::min(a, b)) <= near;
    });
    return on >= kExplained * all;
  }

  const DiskSurface& measured_;
  std::span<const float> radii_;
  std::vector<Kind> kinds_;
  SettledDisks result_;
};

}  // namespace

SettledDisks as_measured(const DiskSurface& measured) {
  const std::uint32_t count = measured.feet.count;
  return {{measured.feet.points, measured.feet.points + count},
          {measured.normals, measured.normals + count},
          std::vector<std::uint32_t>(count, kNoPoint),
          {}};
}

SettledDisks settle(const DiskSurface& measured, std::span<const float> radii) {
  return Settling(measured, radii).run();
}

}  // namespace vpm
