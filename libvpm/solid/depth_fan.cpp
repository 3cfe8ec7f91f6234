#include "libvpm/solid/depth_fan.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vpm {
namespace {

// A part of a cell's edge that lies inside the other solid begins and ends at a corner or at a cut.
// Cuts (segments) tell the depth at such an end if they are no further from it than this, relative
// to the length of the part.
constexpr double kNear = 0.25;
// Least product of a length and a depth to divide by, in the unit that no coordinate exceeds.
constexpr double kNothing = 1e-15;

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
  return std::max(plane.depth(x), 0.0);
}

}  // namespace

DepthIntegral DepthFan::integral(const DepthCell& cell, Vec3 normal, std::span<const Plane> planes,
                                 Vec3 center, const Depth& depth) {
  normal_ = normal, center_ = center, depth_ = depth;
  depth_.value = std::max(depth.value, 0.0);
  volume_ = {}, moment_ = {};
  segments_ = cell.segments, planes_ = planes;
  for (std::size_t k = 0; k < planes.size(); ++k) add_segment(cell.segments[k], planes[k]);
  for (std::size_t edge = 0; edge < 3; ++edge) add_edge(cell, edge);
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
void DepthFan::add_edge(const DepthCell& cell, std::size_t edge) {
  const Vec3 a = cell.corner[edge], b = cell.corner[(edge + 1) % 3];
  along_.clear();
  for (const CutPoint& point : cell.points)
    if (point.edge == edge) along_.push_back({dot(point.place - a, b - a), &point});
  std::ranges::sort(along_, {}, [](const auto& p) { return std::pair(p.first, p.second->sign); });
  bool is_inside = cell.is_inside[edge] != 0;
  Vec3 from = a;
  for (const auto& [at, point] : along_) {
    if (is_inside && point->sign < 0) add_interval(from, point->place);
    is_inside = point->sign > 0;
    from = point->place;
  }
  if (is_inside) add_interval(from, b);
}

// Adds the triangle from the centre over a part of an edge. As far as segments are near an end, the
// depth is 0 there and rises as below their planes, else it is what is foretold.
void DepthFan::add_interval(Vec3 p, Vec3 q) {
  const End from = end_at(p, q), to = end_at(q, p);
  const double first = from.foretold, last = to.foretold;
  double mean = 0, slope = 0;  // how much deeper it is at p than at q, if it is linear there
  const auto take = [&](double share, const auto& mean_and_slope) {
    if (!(share > 0)) return;
    const auto [m, s] = mean_and_slope();
    mean += share * m, slope += share * s;
  };
  take((1 - from.share) * (1 - to.share),
       [&] { return std::pair(0.5 * (first + last), 0.5 * (first - last)); });
  take(from.share * (1 - to.share), [&] {
    const double m = Rise(from.slope, last, first).along();
    return std::pair(m, m - last);
  });
  take((1 - from.share) * to.share, [&] {
    const double m = Rise(to.slope, first, last).along();
    return std::pair(m, first - m);
  });
  take(from.share * to.share, [&] { return std::pair(mean_between(from, to), 0.0); });
  const double more = depth_.value - mean;
  add(p, q, {mean + more / 3, mean / 3 + more / 6});
  const double area = 0.5 * dot(cross(p - center_, q - center_), normal_);
  moment_.add(area * slope / 12 * (p - q));
}

// Returns the sample's depth, continued linearly.
double DepthFan::foretold(Vec3 x) const {
  return std::max(depth_.value + dot(depth_.gradient, x - center_), 0.0);
}

// Takes segments the more the nearer and longer they are, up to the distance that counts as near,
// and the less the deeper the place is below their planes, where what is foretold is right.
DepthFan::End DepthFan::end_at(Vec3 place, Vec3 other) const {
  const double near2 = kNear * kNear * squared_norm(other - place), near = std::sqrt(near2);
  End end{place, foretold(place)};
  WideSum lengths, slopes, levels;
  for (std::size_t k = 0; k < segments_.size(); ++k) {
    const Vec3 along = segments_[k].end - segments_[k].start, to_place = place - segments_[k].start;
    const double length2 = squared_norm(along), t = std::max(dot(to_place, along), 0.0);
    const double gap2 = t < length2 ? squared_norm(to_place) - t * t / length2
                                    : squared_norm(place - segments_[k].end);
    if (!(gap2 < near2)) continue;
    const double gap = std::sqrt(std::max(gap2, 0.0));
    const double length = std::sqrt(std::min(length2, near2)) * (1 - gap / near);
    lengths.add(length);
    slopes.add(length * depth_below(planes_[k], other));
    levels.add(length * depth_below(planes_[k], place));
  }
  const double sum = lengths.real();
  if (!(sum > 0)) return end;
  const double level = levels.real() / std::max(sum * end.foretold, kNothing);
  end.share = std::min(sum / near, 1.0) * std::max(1 - level, 0.0);
  end.slope = slopes.real() / sum;
  return end;
}

// Returns the mean along a part of an edge between cuts: of the least of what rises, what falls and
// what is foretold.
double DepthFan::mean_between(const End& from, const End& to) {
  const double first = from.foretold, last = to.foretold, up = from.slope, down = to.slope;
  if (!(up > 0) || !(down > 0)) return 0;
  const double t = first / (up + first - last), u = (down - first) / (down - first + last);
  if (!(t >= 0 && t < u && u <= 1)) return 0.5 * up * down / (up + down);
  return 0.5 * (up * t * u + down * (1 - u) * (1 - t));
}

}  // namespace vpm
