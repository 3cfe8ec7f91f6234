#include "libvpm/cloud/orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "libvpm/cloud/kd_tree.h"
#include "libvpm/core/error.h"
#include "libvpm/core/number_list.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/solid_angle.h"

namespace vpm {
namespace {

constexpr int kNeighbors = 8;  // nearest points, apart from the point itself
constexpr std::size_t kGrain = 1024;
constexpr double kLevel = 0.3;  // sine of the angle between a surface and the way to a point of it

void turn(Vec3f& normal) {
  normal = {-normal.x, -normal.y, -normal.z};
}

using NearestPoints = std::array<std::uint32_t, kNeighbors>;

// Returns the nearest points of each; where there are fewer, the point itself instead.
std::vector<NearestPoints> nearest_points(const Cloud& cloud) {
  const KdTree tree(cloud.positions);
  std::vector<NearestPoints> nearest(cloud.size());
  parallel_for(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> found;
    for (std::size_t i = begin; i < end; ++i) {
      const auto self = static_cast<std::uint32_t>(i);
      tree.nearest(cloud.positions[i], kNeighbors + 1, found);
      std::erase(found, self);
      found.resize(kNeighbors, self);
      std::ranges::copy(found, nearest[i].begin());
    }
  });
  return nearest;
}

// Compares the normals of two points.
struct Pair {
  Vec3 one, other, along;  // both normals, and the unit vector from one point to the other
  double cosine;

  Pair(const Cloud& cloud, std::uint32_t i, std::uint32_t k)
      : one(widen(cloud.normals[i])),
        other(widen(cloud.normals[k])),
        along(normalized_or_zero(widen(cloud.positions[k]) - widen(cloud.positions[i]))),
        cosine(dot(one, other)) {}

  // True if the points are beside each other on one surface, whichever way its normals face. Points
  // on the other side of a sheet lie behind the first one.
  bool are_level() const {
    return std::fabs(dot(one, along)) <= kLevel && std::fabs(dot(other, along)) <= kLevel;
  }
  // Returns the cosine between the normals of the sides on which one lies if a circle goes through
  // both points, normal to it at each, as across an edge: negative if one of them is turned.
  double bent_cosine() const { return dot(one, other - 2 * dot(other, along) * along); }
};

// Finds groups of points whose normals depend on each other. Each member knows if it is to be
// turned against the first of its group.
class TurnedGroups {
 public:
  explicit TurnedGroups(std::size_t count) : parents_(count), sizes_(count, 1), turned_(count) {
    std::iota(parents_.begin(), parents_.end(), 0U);
  }

  struct Place {
    std::uint32_t root;
    bool is_turned;  // against the root
  };
  Place find(std::uint32_t i) {
    Place place{i, false};
    while (parents_[place.root] != place.root) {
      const std::uint32_t parent = parents_[place.root];
      turned_[place.root] = turned_[place.root] != turned_[parent];  // halves the path
      parents_[place.root] = parents_[parent];
      place.is_turned = place.is_turned != (turned_[place.root] != 0);
      place.root = parents_[place.root];
    }
    return place;
  }
  // Returns the number of points in the group of one.
  std::uint32_t size_about(std::uint32_t i) { return sizes_[find(i).root]; }
  // Joins the groups of two points, one of which is turned against the other or not. Leaves points
  // of one group as they are.
  void join(std::uint32_t i, std::uint32_t k, bool is_turned) {
    const Place a = find(i), b = find(k);
    if (a.root == b.root) return;
    const auto [low, high] = std::minmax(a.root, b.root);
    parents_[high] = low;
    sizes_[low] += sizes_[high];
    turned_[high] = (a.is_turned != b.is_turned) != is_turned;
  }

 private:
  std::vector<std::uint32_t> parents_, sizes_;  // sizes: of roots
  std::vector<char> turned_;                    // against the parent
};

// Joins neighbours on one surface, those that are most alike first.
void join_on_surfaces(const Cloud& cloud, const std::vector<NearestPoints>& nearest,
                      TurnedGroups& groups) {
  for (const double least : {0.98, 0.9, 0.7}) {
    for (std::uint32_t i = 0; i < nearest.size(); ++i) {
      for (const std::uint32_t k : nearest[i]) {
        if (k == i) continue;
        const Pair pair(cloud, i, k);
        if (std::fabs(pair.cosine) >= least && pair.are_level()) groups.join(i, k, pair.cosine < 0);
      }
    }
  }
}

// Joins surfaces that meet at an edge, where most of the neighbours across it tell the same, which
// those of surfaces that cross do not. An edge has as many of them as the smaller surface is wide,
// so that stray points between two large surfaces join neither with the other.
void join_across_edges(const Cloud& cloud, const std::vector<NearestPoints>& nearest,
                       TurnedGroups& groups) {
  constexpr double kBent = 0.5, kMost = 0.5;
  struct Votes {
    std::int64_t agree = 0, all = 0;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, Votes> votes;
  for (std::uint32_t i = 0; i < nearest.size(); ++i) {
    for (const std::uint32_t k : nearest[i]) {
      const auto a = groups.find(i), b = groups.find(k);
      if (a.root >= b.root) continue;
      const double cosine = Pair(cloud, i, k).bent_cosine();
      if (std::fabs(cosine) < kBent) continue;
      Votes& of_both = votes[{a.root, b.root}];
      of_both.agree += (cosine < 0) == (a.is_turned != b.is_turned) ? 1 : -1;
      ++of_both.all;
    }
  }
  std::vector<std::pair<std::pair<std::uint32_t, std::uint32_t>, Votes>> sorted(votes.begin(),
                                                                                votes.end());
  std::ranges::stable_sort(sorted, [](const auto& a, const auto& b) {
    return std::abs(a.second.agree) > std::abs(b.second.agree);
  });
  for (const auto& [both, of_both] : sorted) {
    const auto agree = static_cast<double>(std::abs(of_both.agree));
    const double size = std::min(groups.size_about(both.first), groups.size_about(both.second));
    if (agree > kMost * static_cast<double>(of_both.all) && agree > kMost * std::sqrt(size))
      groups.join(both.first, both.second, of_both.agree < 0);
  }
}

// Describes the points of one group, once they agree.
struct Surface {
  std::vector<std::uint32_t> points;
  Vec3 middle;
  double area = 0, volume = 0;  // m^2; m^3, of the cones from the middle to the disks, signed
  std::ptrdiff_t turned = 0;    // points that are turned, less those that are not
  bool is_turned = false;       // as a whole

  // True if it bounds a solid, or a part of one, so that it has an inner side.
  bool is_bent() const {
    constexpr double kFlat = 0.005;  // of a ball it is .094, of a plate of 20 : 20 : 1, .014
    return std::fabs(volume) > kFlat * area * std::sqrt(area);
  }
};

double area_of(const Cloud& cloud, std::uint32_t i) {
  return double{cloud.radii[i]} * cloud.radii[i];
}

// Returns the surfaces, ascending by their first point, whose points agree in `cloud`.
std::vector<Surface> surfaces_of(Cloud& cloud, TurnedGroups& groups) {
  std::map<std::uint32_t, Surface> surfaces;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const auto [root, is_turned] = groups.find(i);
    Surface& surface = surfaces[root];
    if (is_turned) turn(cloud.normals[i]);
    surface.turned += is_turned ? 1 : -1;
    surface.points.push_back(i);
    surface.area += area_of(cloud, i);
    surface.middle += area_of(cloud, i) * widen(cloud.positions[i]);
  }
  std::vector<Surface> list;
  for (auto& [root, surface] : surfaces) {
    if (surface.area > 0) surface.middle = surface.middle / surface.area;
    for (const std::uint32_t i : surface.points)
      surface.volume += area_of(cloud, i) / 3 *
                        dot(widen(cloud.positions[i]) - surface.middle, widen(cloud.normals[i]));
    surface.is_turned = surface.is_bent() ? surface.volume < 0 : surface.turned > 0;
    list.push_back(std::move(surface));
  }
  return list;
}

// Returns every n-th point of a surface, as many as enough.
std::vector<std::uint32_t> some_of(const Surface& surface, std::size_t enough) {
  std::vector<std::uint32_t> some;
  for (std::size_t k = 0; k < surface.points.size(); k += surface.points.size() / enough + 1)
    some.push_back(surface.points[k]);
  return some;
}

// True if a surface that faces out of what it encloses encloses most points of another one: its
// winding number there is not about 0.
bool encloses(const Cloud& cloud, const Surface& outer, const Surface& inner) {
  constexpr std::size_t kDipoles = 2000, kPlaces = 9;
  constexpr double kEnclosed =
      0.25;  // squared radii are half of the disks' areas, or a little more
  const std::vector<std::uint32_t> dipoles = some_of(outer, kDipoles);
  double all = 0;
  for (const std::uint32_t i : dipoles) all += area_of(cloud, i);
  std::size_t enclosed = 0;
  const std::vector<std::uint32_t> places = some_of(inner, kPlaces);
  for (const std::uint32_t at : places) {
    double sum = 0;
    for (const std::uint32_t i : dipoles) {
      const Vec3 to = widen(cloud.positions[i]) - widen(cloud.positions[at]);
      const double area = outer.area / all * area_of(cloud, i);
      sum += dipole_angle(area * widen(cloud.normals[i]), to, squared_norm(to) + area);
    }
    enclosed += std::fabs(sum) > kEnclosed * kFullSolidAngle;
  }
  return 2 * enclosed > places.size();
}

}  // namespace

Orientation orientation_from_text(const std::string& text) {
  if (text == "neighbours") return {};
  const std::vector<double> place = numbers_from_text(text);
  if (place.size() != 3)
    throw Error(ErrorKind::invalid_argument,
                "`orient` is neighbours, or the place of the sensor as x,y,z, not '" + text + "'");
  return {Vec3{place[0], place[1], place[2]}};
}

std::size_t orient(const Orientation& orientation, Cloud& cloud) {
  return orientation.sensor ? orient_towards(*orientation.sensor, cloud)
                            : orient_consistently(cloud);
}

std::vector<std::uint32_t> contradicting_normals(const Cloud& cloud) {
  constexpr double kAlike = 0.5;  // cosine; opposite below -kAlike
  const std::vector<NearestPoints> nearest = nearest_points(cloud);
  std::vector<char> contradicts(cloud.size());
  parallel_for(cloud.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      int against = 0, all = 0;
      for (const std::uint32_t k : nearest[i]) {
        const Pair pair(cloud, static_cast<std::uint32_t>(i), k);
        if (k == i || std::fabs(pair.cosine) <= kAlike || !pair.are_level()) continue;
        against += pair.cosine < 0 ? 1 : 0;
        ++all;
      }
      contradicts[i] = 3 * against > all;
    }
  });
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < cloud.size(); ++i)
    if (contradicts[i] != 0) found.push_back(i);
  return found;
}

std::size_t orient_towards(Vec3 sensor, Cloud& cloud) {
  const Vec3 place = sensor - cloud.origin;
  std::size_t turned = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!(dot(widen(cloud.normals[i]), place - widen(cloud.positions[i])) < 0)) continue;
    turn(cloud.normals[i]);
    ++turned;
  }
  return turned;
}

std::size_t orient_consistently(Cloud& cloud) {
  constexpr std::size_t kMostPairs = 64;  // larger surfaces, which are compared with each other
  const std::vector<Vec3f> before = cloud.normals;
  const std::vector<NearestPoints> nearest = nearest_points(cloud);
  TurnedGroups groups(cloud.size());
  join_on_surfaces(cloud, nearest, groups);
  join_across_edges(cloud, nearest, groups);
  std::vector<Surface> surfaces = surfaces_of(cloud, groups);
  std::ranges::stable_sort(surfaces,
                           [](const Surface& a, const Surface& b) { return a.area > b.area; });
  const std::size_t count = std::min(surfaces.size(), kMostPairs);
  for (std::size_t k = 0; k < count; ++k) {
    bool is_inner = false;
    for (std::size_t outer = 0; outer < k; ++outer)
      if (surfaces[k].is_bent() && surfaces[outer].is_bent())
        is_inner ^= encloses(cloud, surfaces[outer], surfaces[k]);
    surfaces[k].is_turned ^= is_inner;
  }
  for (const Surface& surface : surfaces)
    if (surface.is_turned)
      for (const std::uint32_t i : surface.points) turn(cloud.normals[i]);
  std::size_t turned = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) turned += cloud.normals[i] != before[i];
  return turned;
}

}  // namespace vpm
