#include "libvpm/solid/depth_fan.h"

#include <algorithm>
#include <array>

namespace vpm {
namespace {

// Slope where the plane is not known, in the unit that no coordinate exceeds.
constexpr double kSteep = 1e3;

// A depth d(t) on the way from the border, t = 0, to a place of known depth, t = 1: it grows from 0
// by `slope` and bends evenly to be `height` there. If it were more in between, it bends before, to
// go on from what is foretold at the border, `level`, to the height. Its means are those of
// d and of t d, along the way and over a triangle with the border as its base.
struct Rise {
  std::array<double, 4> means;  // ∫ f t^k dt, with the depth (first + more t) f
  double first, more;

  Rise(double slope, double height, double level) {
    if (slope <= 2 * height) {  // slope t + (height - slope) t t
      first = slope, more = height - slope;
      means = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5};
      return;
    }
    first = std::clamp(level, height, slope / 2), more = height - first;
    // f is 2 u - u^2 and then 1, evenly bent, or u and then 1, with a crease, the steeper the more.
    const double t = 2 * first / slope, creased = std::min(1 / t - 1, 1.0);
    double bend = t, crease = t / 2;  // powers of where f becomes 1
    for (std::size_t k = 0; k < means.size(); ++k) {
      const auto n = static_cast<double>(k);
      const double bent = bend * (2 / (n + 2) - 1 / (n + 3)) + (1 - bend) / (n + 1);
      const double sharp = crease / (n + 2) + (1 - crease) / (n + 1);
      means[k] = bent + creased * (sharp - bent);
      bend *= t, crease *= t / 2;
    }
  }
  double along() const { return first * means[0] + more * means[1]; }
  std::pair<double, double> over_triangle() const {
    const auto weighted = [&](std::size_t k) {
      return 2 * (first * means[k] + (more - first) * means[k + 1] - more * means[k + 2]);
    };
    return {weighted(0), weighted(1)};
  }
};

double depth_below(const DepthFan::Plane& plane, Vec3 x) {
  return std::max(plane.offset - dot(plane.normal, x), 0.0);
}

}  // namespace

DepthIntegral DepthFan::integral(const DepthCell& cell, Vec3 normal, std::span<const Plane> planes,
                                 Vec3 center, const Depth& depth) {
  normal_ = normal, center_ = center, depth_ = depth;
  depth_.value = std::max(depth.value, 0.0);
  volume_ = {}, moment_ = {};
  for (std::size_t k = 0; k < planes.size(); ++k) add_segment(cell.segments[k], planes[k]);
  for (std::size_t edge = 0; edge < 3; ++edge) add_edge(cell, planes, edge);
  return {volume_.real(), moment_.real()};
}

// Adds the triangle from the centre over p and q, in which the depth depends on the distance from p
// and q only, with these means.
void DepthFan::add(Vec3 p, Vec3 q, std::pair<double, double> means) {
  const double area = 0.5 * dot(cross(p - center_, q - center_), normal_);
  const auto [depth, product] = means;
  volume_.add(area * depth);
  moment_.add(area * (0.5 * (depth - product) * (p + q) + product * center_));
}

void DepthFan::add_segment(const CutSegment& segment, const Plane& plane) {
  const double level = foretold(0.5 * (segment.start + segment.end));
  add(segment.start, segment.end,
      Rise(depth_below(plane, center_), depth_.value, level).over_triangle());
}

// Adds the parts of an edge that lie inside.
void DepthFan::add_edge(const DepthCell& cell, std::span<const Plane> planes, std::size_t edge) {
  const Vec3 a = cell.corner[edge], b = cell.corner[(edge + 1) % 3];
  along_.clear();
  for (const CutPoint& point : cell.points)
    if (point.edge == edge) along_.push_back({dot(point.place - a, b - a), &point});
  std::ranges::sort(along_, {}, [](const auto& p) { return std::pair(p.first, p.second->sign); });
  const auto stop_at = [&](const CutPoint& point) {
    Stop stop{point.place};
    for (std::size_t k = 0; k < planes.size(); ++k)
      if (point.place == (point.sign > 0 ? cell.segments[k].end : cell.segments[k].start))
        stop.plane = &planes[k];
    return stop;
  };
  bool is_inside = cell.is_inside[edge] != 0;
  Stop from{a, nullptr, true};
  for (const auto& [at, point] : along_) {
    const Stop stop = stop_at(*point);
    if (is_inside && point->sign < 0) add_interval(from, stop);
    is_inside = point->sign > 0;
    from = stop;
  }
  if (is_inside) add_interval(from, {b, nullptr, true});
}

void DepthFan::add_interval(const Stop& from, const Stop& to) {
  const double mean = mean_between(from, to), more = depth_.value - mean;
  add(from.place, to.place, {mean + more / 3, mean / 3 + more / 6});
  // How much deeper it is where it starts than where it ends, if it is linear there, by half.
  const double first = foretold(from.place), last = foretold(to.place);
  const double slope = from.is_corner && to.is_corner ? 0.5 * (first - last)
                       : from.is_corner               ? first - mean
                       : to.is_corner                 ? mean - last
                                                      : 0;
  const double area = 0.5 * dot(cross(from.place - center_, to.place - center_), normal_);
  moment_.add(area * slope / 12 * (from.place - to.place));
}

// Returns the sample's depth, continued linearly.
double DepthFan::foretold(Vec3 x) const {
  return std::max(depth_.value + dot(depth_.gradient, x - center_), 0.0);
}

// Returns the mean depth along a part of an edge.
double DepthFan::mean_between(const Stop& from, const Stop& to) const {
  // Returns how deep one end is below the plane at the other.
  const auto slope = [&](const Stop& end, const Stop& other) {
    return end.plane != nullptr ? depth_below(*end.plane, other.place) : kSteep;
  };
  const double first = foretold(from.place), last = foretold(to.place);
  if (from.is_corner && to.is_corner) return 0.5 * (first + last);
  if (to.is_corner) return Rise(slope(from, to), last, first).along();
  if (from.is_corner) return Rise(slope(to, from), first, last).along();
  const double up = slope(from, to), down = slope(to, from);
  if (!(up > 0) || !(down > 0)) return 0;
  // The least of what rises, what falls and what is foretold.
  const double t = first / (up + first - last), u = (down - first) / (down - first + last);
  if (!(t >= 0 && t < u && u <= 1)) return 0.5 * up * down / (up + down);
  return 0.5 * (up * t * u + down * (1 - u) * (1 - t));
}

}  // namespace vpm
