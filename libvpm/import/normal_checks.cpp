#include "libvpm/import/normal_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "libvpm/cloud/covariance_fit.h"
#include "libvpm/cloud/orientation.h"
#include "libvpm/core/error.h"

namespace vpm {
namespace {

constexpr double kNearlyAll = 0.9;  // share of normals
// Share of normals that may contradict those about them. With 2 % turned at random the volume
// behind a wall and in a box is wrong by 5 % of the tool on average and 15 % at worst, with 5 % by
// up to all.
constexpr double kMostContradicting = 0.02;

std::string percent_text(std::size_t part, std::size_t whole) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3g %%",
                100 * static_cast<double>(part) / static_cast<double>(whole));
  return text;
}

// Sorts the points of a cloud into cubes of one size.
class Cubes {
 public:
  Cubes(const Cloud& cloud, double side) {
    const auto number = [&](float coordinate) {
      return static_cast<std::int64_t>(std::floor(coordinate / side));
    };
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      const Vec3f& p = cloud.positions[k];
      places_.push_back({{number(p.x), number(p.y), number(p.z)}, k});
    }
    std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) {
      return std::tie(a.cube, a.point) < std::tie(b.cube, b.point);
    });
  }

  // Calls use(points) with the numbers of the points of each cube.
  template <class Use>
  void for_each(const Use& use) const {
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      points.push_back(places_[k].point);
      if (k + 1 < places_.size() && places_[k + 1].cube == places_[k].cube) continue;
      use(std::span<const std::size_t>(points));
      points.clear();
    }
  }

 private:
  struct Place {
    std::array<std::int64_t, 3> cube;
    std::size_t point;
  };
  std::vector<Place> places_;
};

// Appends the cosines of the angles between the normals of a cube's points and that of their plane,
// if they form one.
void compare_with_plane(const Cloud& cloud, std::span<const std::size_t> points,
                        std::vector<float>& cosines) {
  constexpr std::size_t kFewest = 6;
  constexpr float kFlat = 0.01F, kWide = 0.1F;  // eigenvalues sum to 1
  if (points.size() < kFewest) return;
  Vec3 mean;
  for (const std::size_t k : points) mean = mean + widen(cloud.positions[k]);
  mean = mean / static_cast<double>(points.size());
  Symmetric3<double> sums{};
  for (const std::size_t k : points) {
    const Vec3 d = widen(cloud.positions[k]) - mean;
    sums.xx += d.x * d.x, sums.xy += d.x * d.y, sums.xz += d.x * d.z;
    sums.yy += d.y * d.y, sums.yz += d.y * d.z, sums.zz += d.z * d.z;
  }
  const Symmetric3<float> covariance = over_trace(sums);
  const Characteristic polynomial = characteristic_of(covariance);
  const float minors[1] = {polynomial.minors}, determinants[1] = {polynomial.determinant};
  float roots[1];
  find_smallest_roots(minors, determinants, roots);
  if (roots[0] > kFlat || minors[0] < kWide) return;
  const Vec3f plane = normal_of_covariance(covariance, minors[0], roots[0], 0, 0);
  if (plane == Vec3f{}) return;
  for (const std::size_t k : points)
    cosines.push_back(static_cast<float>(std::abs(dot(widen(plane), widen(cloud.normals[k])))));
}

// Returns how far normals lie off the planes that the points in a cube form: the median, in
// degrees; empty if too few points form planes.
std::optional<double> degrees_off_planes(const Cloud& cloud, const Cubes& cubes) {
  constexpr std::size_t kFewest = 20, kPart = 10;  // 20 points, and one in ten, must be judged
  std::vector<float> cosines;
  cubes.for_each(
      [&](std::span<const std::size_t> points) { compare_with_plane(cloud, points, cosines); });
  if (cosines.size() < kFewest || kPart * cosines.size() < cloud.size()) return std::nullopt;
  const auto middle = cosines.begin() + static_cast<std::ptrdiff_t>(cosines.size() / 2);
  std::nth_element(cosines.begin(), middle, cosines.end());
  return std::acos(std::min(*middle, 1.0F)) * 180 / std::numbers::pi;
}

// Returns a warning if normals lie off the surfaces that the points form. Quantised depths form
// flat steps that are several points wide, and a few noisy points form planes by chance, so that
// right normals may lie off the planes in small cubes. They agree with those in larger cubes, where
// the surface is flat; wrong ones lie off the planes of every size.
Remarks off_the_surface(const Cloud& cloud, double side, const Cubes& smallest) {
  constexpr double kMostDegrees = 25;
  constexpr int kSizes = 5;  // each twice as large as the one before
  std::optional<double> least = degrees_off_planes(cloud, smallest);
  for (int k = 1; k < kSizes && least.value_or(HUGE_VAL) > kMostDegrees; ++k) {
    side *= 2;
    const std::optional<double> degrees = degrees_off_planes(cloud, Cubes(cloud, side));
    if (degrees) least = std::min(*degrees, least.value_or(HUGE_VAL));
  }
  if (!least || *least <= kMostDegrees) return {};
  return {{true, "its normals lie " + std::to_string(static_cast<int>(*least)) +
                     " degrees off those of the surfaces that its points form (median): were the "
                     "points turned without their normals, or are the normals coded, as 0 to 1 or "
                     "as colours? Give them in the frame of the points, as -1 to 1"}};
}

// Returns where the first of some points are, in the world.
std::string places_text(const Cloud& cloud, std::span<const std::uint32_t> points) {
  constexpr std::size_t kMost = 3;
  std::string text = points.size() > kMost ? "the first at " : "at ";
  for (std::size_t k = 0; k < std::min(points.size(), kMost); ++k) {
    const double rounding = 1e-3 * cloud.radii[points[k]];
    Vec3 at = cloud.origin + widen(cloud.positions[points[k]]);
    for (double* const c : {&at.x, &at.y, &at.z})
      if (std::fabs(*c) < rounding) *c = 0;
    char place[96];
    std::snprintf(place, sizeof place, "%s(%.4g, %.4g, %.4g)", k == 0 ? "" : ", ", at.x, at.y,
                  at.z);
    text += place;
  }
  return text;
}

// Returns a warning if normals contradict those about them, or refuses the cloud.
Remarks contradictions(const Cloud& cloud, const std::string& name) {
  constexpr std::size_t kFew = 8, kPart = 500;  // 8 points, or one in 500, are no mistake
  const std::vector<std::uint32_t> found = contradicting_normals(cloud);
  if (found.size() < kFew || kPart * found.size() < cloud.size()) return {};
  const std::string what = std::to_string(found.size()) + " of its " +
                           std::to_string(cloud.size()) + " normals (" +
                           percent_text(found.size(), cloud.size()) +
                           ") face opposite ways to those about them, " + places_text(cloud, found);
  const std::string cure = "turn them by `orient` neighbours, or by the place of the sensor";
  if (static_cast<double>(found.size()) > kMostContradicting * static_cast<double>(cloud.size()))
    refuse(what, name, cure);
  return {{true, what + "; " + cure}};
}

// Counts the normals that face a place, and those that face away from it.
struct Facing {
  std::size_t towards = 0, away = 0;
};

// Returns how normals face `place`. Judges the nearest point in each direction only, since the far
// side of a solid rightly faces away.
Facing facing(const PointSet& points, const Vec3& place) {
  constexpr double kDirections = 64;  // squares of directions per unit of slope
  struct Seen {
    double distance;
    std::size_t point;
  };
  std::unordered_map<std::uint64_t, Seen> seen;
  for (std::size_t i = 0; i < points.normals.size(); ++i) {
    const Vec3 to = points.positions[i] - place;
    const double distance = norm(to), along = dot(to, points.normals[i]);
    if (!(distance > 0 && distance < HUGE_VAL) || !std::isfinite(along) || along == 0) continue;
    std::uint64_t direction = 0;
    for (const double c : {to.x, to.y, to.z})
      direction = direction << 8 | static_cast<std::uint64_t>((c / distance + 1) * kDirections);
    const auto [found, is_new] = seen.try_emplace(direction, Seen{distance, i});
    if (!is_new && distance < found->second.distance) found->second = {distance, i};
  }
  Facing facing;
  for (const auto& [direction, nearest] : seen) {
    const Vec3 to = points.positions[nearest.point] - place;
    ++(dot(to, points.normals[nearest.point]) < 0 ? facing.towards : facing.away);
  }
  return facing;
}

// True if all points lie before a camera at the origin, within 60 degrees of its axis.
bool are_as_of_a_camera(const PointSet& points) {
  constexpr double kSlowest = 0.5;
  return std::all_of(points.positions.begin(), points.positions.end(),
                     [](const Vec3& p) { return !is_finite(p) || p.z >= kSlowest * norm(p); });
}

}  // namespace

double median_radius(const Cloud& cloud) {
  std::vector<float> radii = cloud.radii;
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return *middle;
}

Remarks improbable_normals(const Cloud& cloud, const std::string& name) {
  constexpr double kSideOfRadius = 3;  // a cube is about three spacings of points wide
  const double side = kSideOfRadius * median_radius(cloud);
  const Remarks off = side > 0 ? off_the_surface(cloud, side, Cubes(cloud, side)) : Remarks();
  return off.empty() ? contradictions(cloud, name) : off;  // of two causes one is said
}

bool are_in_world(const PointSet& points, bool are_flipped) {
  const auto share = [&](const Vec3& place) {
    const auto [towards, away] = facing(points, place);
    return static_cast<double>(are_flipped ? away : towards) /
           static_cast<double>(std::max<std::size_t>(towards + away, 1));
  };
  return points.viewpoint && !points.normals.empty() &&
         share(points.viewpoint->translation) >= kNearlyAll && share({}) <= 1 - kNearlyAll;
}

Remarks facing_away(const PointSet& points, bool are_flipped) {
  if (!points.viewpoint && !are_as_of_a_camera(points)) return {};
  const auto [towards, away] = facing(points, {});
  const std::size_t all = towards + away;
  if (all == 0 || static_cast<double>(away) < kNearlyAll * static_cast<double>(all)) return {};
  const std::string sensor = points.viewpoint
                                 ? "its VIEWPOINT, and so from the sensor"
                                 : "the origin, before which all points lie as before a camera";
  return {{true, percent_text(away, all) + " of its normals face away from " + sensor +
                     "; normals must point into free space: " +
                     (are_flipped ? "leave `flip` out" : "give `flip` to turn them")}};
}

}  // namespace vpm
