#include "libvpm/packing/grow.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/fill_band.h"
#include "libvpm/packing/linear_programme.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/solid_distance.h"
#include "libvpm/packing/space.h"

namespace vpm {
namespace {

// Largest motion and growth of a sphere per step and axis, in radii. Its centre stays within its
// old self, hence on its side of the mesh. Larger steps meet more obstacles and converge no faster.
constexpr double kTrust = 0.2;
// Steps shorten when they gain less than kSlow of what they may, and end at kMinTrust.
constexpr double kSlow = 1e-4, kMinTrust = 0.01;
// Largest decrease of a gap by a full step, per radius: 1 + sqrt(3), rounded up.
constexpr double kApproachOfStep = 2.75;
// Unforeseen triangles shorten a step. It is then solved again, at most kRounds times, until it
// keeps this part of its gain.
constexpr double kKept = 0.9;
constexpr int kRounds = 4;
// Number of nearest triangles that a sphere remembers: four can hold it, the others foresee.
constexpr std::size_t kMaxTriangles = 20;

// Factor by which a sphere must be larger elsewhere to be moved there.
constexpr double kMoreRoom = 1.01;
// Limits of Space and width of radius bands, as in pack().
constexpr std::size_t kRoomBlocks = std::size_t{1} << 16, kRoomBlocksPerSphere = 32;
constexpr double kBand = 0.99;

// Factor by which rounding of a linear programme may push radii below their limit.
constexpr double kShrunk = 1 - 1e-9;

using Programme = LinearProgramme;
using Group = std::vector<std::uint32_t>;

double cubed(double v) {
  return v * v * v;
}

double sum_of_cubes(const std::vector<Sphere>& spheres) {
  double sum = 0;
  for (const Sphere& s : spheres) sum += cubed(s.radius);
  return sum;
}

// Divides the spheres in `from` at a plane across an axis, recursively, into groups of neighbours.
void divide(const std::vector<Sphere>& spheres, std::span<std::uint32_t> from, int turn,
            std::vector<Group>& groups) {
  if (from.size() <= kGrownTogether) {
    groups.emplace_back(from.begin(), from.end());
    return;
  }
  const auto along = [&](std::uint32_t i) {
    const Vec3 c = spheres[i].center;
    return turn % 3 == 0 ? c.x : turn % 3 == 1 ? c.y : c.z;
  };
  // Cuts between one and two thirds, by the golden ratio, so that planes differ from step to step.
  const double fraction = (1 + std::fmod(0.618 * (turn + 1), 1.0)) / 3;
  const auto first = static_cast<std::size_t>(fraction * static_cast<double>(from.size()));
  std::nth_element(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(first), from.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     return along(a) != along(b) ? along(a) < along(b) : a < b;
                   });
  divide(spheres, from.first(first), turn + 1, groups);
  divide(spheres, from.subspan(first), turn + 1, groups);
}

class Growth {
 public:
  Growth(const Solid& solid, const std::vector<Sphere>& spheres, const GrowOptions& options)
      : distance_(solid, options.enclosure),
        frame_(distance_.frame()),
        least_(std::max(options.min_radius / frame_.scale, kNumericalFloor)),
        most_(options.max_radius / frame_.scale),
        members_(spheres.size()) {
    for (const Sphere& s : spheres)
      spheres_.push_back({frame_.to_unit(s.center), s.radius / frame_.scale});
  }

  void run(const GrowOptions& options) {
    for (int i = 0; i < options.steps && trust_ > kMinTrust; ++i) {
      const double gain = step(i);
      if (gain < kSlow * trust_) trust_ /= 2;
      if (!(trust_ > kMinTrust) && relocate()) trust_ = kTrust;
      if (options.progress) options.progress(static_cast<double>(i + 1) / options.steps);
    }
  }

  std::vector<Sphere> in_metres() const {
    std::vector<Sphere> all;
    for (const Sphere& s : spheres_) all.push_back(frame_.to_solid(s));
    std::sort(all.begin(), all.end(), largest_first);
    return all;
  }

 private:
  struct Neighbour {
    std::uint32_t sphere;
    double gap;
  };
  struct Member {
    std::vector<std::uint32_t> triangles;  // triangles met by the sphere and still near
    std::vector<Neighbour> near;           // spheres that may be met in this step
    std::uint32_t group = 0, place = 0;    // place is the index in the group
  };

  // Moves the smallest spheres to where there is more room by now. Returns false if there is no
  // such place.
  bool relocate() {
    const std::size_t count = spheres_.size();
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return largest_first(spheres_[a], spheres_[b]);
    });
    const double least = kMoreRoom * spheres_[order.back()].radius;
    const std::size_t most = count + (count + 1) / 2;
    Space space(distance_, least, kRoomBlocks + kRoomBlocksPerSphere * count);
    std::vector<Sphere> placed;
    for (const std::uint32_t i : order) placed.push_back(spheres_[i]);
    space.place(placed);
    space.update({0});
    for (double radius = std::min<double>(space.bound(), most_);
         space.spheres().size() < most && radius > least;) {
      radius = std::max(least, kBand * std::min<double>(radius, space.bound()));
      fill_band(space, radius, most_, most);
    }
    std::vector<Sphere> found(space.spheres().begin() + static_cast<std::ptrdiff_t>(count),
                              space.spheres().end());
    std::sort(found.begin(), found.end(), largest_first);
    std::size_t moved = 0;
    for (; moved < std::min(found.size(), count); ++moved) {
      const std::uint32_t i = order[count - 1 - moved];
      if (!(found[moved].radius > kMoreRoom * spheres_[i].radius)) break;
      spheres_[i] = found[moved];
      members_[i] = {};
    }
    return moved > 0;
  }

  // Makes a step and returns the relative gain of volume.
  double step(int number) {
    find_neighbours();
    Group all(spheres_.size());
    std::iota(all.begin(), all.end(), 0u);
    std::vector<Group> groups;
    divide(spheres_, all, number, groups);
    for (std::uint32_t g = 0; g < groups.size(); ++g)
      for (const std::uint32_t i : groups[g]) members_[i].group = g;
    std::vector<Sphere> next = spheres_;
    parallel_for(groups.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g) move(groups[g], next);
    });
    separate(next);
    const bool sound = std::all_of(next.begin(), next.end(),
                                   [&](const Sphere& s) { return s.radius >= kShrunk * least_; });
    const double gain = sound ? sum_of_cubes(next) / sum_of_cubes(spheres_) - 1 : 0;
    if (gain > 0) spheres_ = std::move(next);
    return gain;
  }

  // Lists the pairs of spheres that a step can bring together, by a sweep along x.
  void find_neighbours() {
    const double half_width = 1 + kApproachOfStep * trust_;
    std::vector<double> low;
    for (const Sphere& s : spheres_) low.push_back(s.center.x - half_width * s.radius);
    Group order(spheres_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return low[a] != low[b] ? low[a] < low[b] : a < b;
    });
    for (Member& m : members_) m.near.clear();
    for (std::size_t a = 0; a < order.size(); ++a) {
      const std::uint32_t i = order[a];
      const Sphere& s = spheres_[i];
      for (std::size_t b = a + 1; b < order.size(); ++b) {
        const std::uint32_t j = order[b];
        if (low[j] > s.center.x + half_width * s.radius) break;
        const Sphere& t = spheres_[j];
        const double gap = norm(s.center - t.center) - s.radius - t.radius;
        if (gap > kApproachOfStep * trust_ * (s.radius + t.radius)) continue;
        members_[i].near.push_back({j, gap});
        members_[j].near.push_back({i, gap});
      }
    }
  }

  // Moves the spheres of a group together into `next`; other groups stay unchanged.
  void move(Group& group, std::vector<Sphere>& next) {
    // Eliminates smallest spheres first: those placed late touch few larger ones, so little fills
    // in.
    std::sort(group.begin(), group.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double r = spheres_[a].radius, s = spheres_[b].radius;
      return r != s ? r < s : a < b;
    });
    double before = 0;
    for (std::uint32_t k = 0; k < group.size(); ++k) {
      members_[group[k]].place = k;
      before += cubed(spheres_[group[k]].radius);
    }
    double best = before;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Programme::Four> steps = solve(programme(group, before));
      std::vector<Sphere> there;
      double promised = 0;
      for (std::size_t k = 0; k < group.size(); ++k) {
        const Sphere& s = spheres_[group[k]];
        const auto& [x, y, z, wider] = steps[k];
        const double unit = trust_ * s.radius;
        const Sphere moved{s.center + unit * Vec3{x, y, z}, s.radius + unit * wider};
        promised += cubed(moved.radius);
        there.push_back({moved.center, std::min(most_, room(group[k], moved))});
      }
      const double after = sum_of_cubes(there);
      if (after > best) {
        best = after;
        for (std::size_t k = 0; k < group.size(); ++k) next[group[k]] = there[k];
      }
      if (after - before >= kKept * (promised - before)) break;
    }
  }

  // Returns the sphere's radius, reduced as the mesh requires, and remembers the triangle.
  double room(std::uint32_t i, const Sphere& s) {
    const SurfacePoint p = distance_.closest(s.center, s.radius);
    if (p.triangle == SurfacePoint::kNone) return s.radius;
    std::vector<std::uint32_t>& known = members_[i].triangles;
    if (std::find(known.begin(), known.end(), p.triangle) == known.end())
      known.push_back(p.triangle);
    return p.distance;
  }

  // Builds the programme. Unknowns per sphere are the motion of its centre and the growth of its
  // radius, in units of trust * radius.
  Programme programme(const Group& group, double cubes) {
    Programme programme;
    for (const std::uint32_t i : group) {
      programme.gain.push_back({0, 0, 0, cubed(spheres_[i].radius) / cubes});
      keep_from_spheres(i, programme);
      keep_from_triangles(i, programme);
      keep_in_limits(i, programme);
    }
    return programme;
  }

  // Limits growth plus motion against `away` to `room`.
  void keep_away(std::uint32_t i, Vec3 away, double room, Programme& programme) const {
    programme.rows.push_back({members_[i].place,
                              Programme::kNone,
                              {-away.x, -away.y, -away.z, 1},
                              {},
                              std::max(room, 0.0) / (trust_ * spheres_[i].radius)});
  }

  void keep_from_spheres(std::uint32_t i, Programme& programme) const {
    const Sphere& s = spheres_[i];
    const Member& m = members_[i];
    for (const auto [j, gap] : m.near) {
      const Sphere& t = spheres_[j];
      const Vec3 u = normalized_or_zero(s.center - t.center);
      if (members_[j].group != m.group) {  // each of the two groups may use half the gap
        if (gap < 2 * kApproachOfStep * trust_ * s.radius) keep_away(i, u, gap / 2, programme);
      } else if (i < j) {
        const double unit = std::max(s.radius, t.radius);
        const double f = s.radius / unit, g = t.radius / unit;
        programme.rows.push_back({m.place,
                                  members_[j].place,
                                  {-f * u.x, -f * u.y, -f * u.z, f},
                                  {g * u.x, g * u.y, g * u.z, g},
                                  std::max(gap, 0.0) / (trust_ * unit)});
      }
    }
  }

  // Adds rows for known triangles, and drops those that this step cannot meet.
  void keep_from_triangles(std::uint32_t i, Programme& programme) {
    const Sphere& s = spheres_[i];
    std::vector<std::uint32_t>& known = members_[i].triangles;
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const std::uint32_t t : known) {
      const double room = norm(s.center - distance_.closest_on(t, s.center)) - s.radius;
      if (room < kApproachOfStep * trust_ * s.radius) near.push_back({room, t});
    }
    std::sort(near.begin(), near.end());
    if (near.size() > kMaxTriangles) near.resize(kMaxTriangles);
    known.clear();
    for (const auto& [room, t] : near) {
      known.push_back(t);
      const Vec3 away = normalized_or_zero(s.center - distance_.closest_on(t, s.center));
      keep_away(i, away, room, programme);
    }
  }

  void keep_in_limits(std::uint32_t i, Programme& programme) const {
    const double r = spheres_[i].radius, unit = trust_ * r;
    if (most_ - r < unit) keep_away(i, {}, most_ - r, programme);
    if (r - least_ < unit) {
      programme.rows.push_back({members_[i].place,
                                Programme::kNone,
                                {0, 0, 0, -1},
                                {},
                                std::max(r - least_, 0.0) / unit});
    }
  }

  // Shrinks both spheres of each pair that rounding lets overlap.
  void separate(std::vector<Sphere>& next) const {
    std::vector<double> less(next.size());
    for (std::size_t i = 0; i < next.size(); ++i) {
      for (const Neighbour& n : members_[i].near) {
        const Sphere& t = next[n.sphere];
        const double over = next[i].radius + t.radius - norm(next[i].center - t.center);
        less[i] = std::max(less[i], over / 2);
      }
    }
    for (std::size_t i = 0; i < next.size(); ++i) next[i].radius -= less[i];
  }

  SolidDistance distance_;
  UnitFrame frame_;
  double least_, most_;  // radii in the unit frame
  double trust_ = kTrust;
  std::vector<Sphere> spheres_;
  std::vector<Member> members_;
};

}  // namespace

std::vector<Sphere> grow(const Solid& solid, const std::vector<Sphere>& spheres,
                         const GrowOptions& options) {
  if (!(options.min_radius >= 0) || !(options.max_radius > 0)) {
    throw Error(ErrorKind::invalid_argument, "the limits of radii must be positive numbers");
  }
  if (spheres.empty()) return spheres;
  Growth growth(solid, spheres, options);
  growth.run(options);
  std::vector<Sphere> grown = growth.in_metres();
  const bool better = grown.back().radius > 0 && sum_of_cubes(grown) > sum_of_cubes(spheres);
  return better ? grown : spheres;
}

}  // namespace vpm
