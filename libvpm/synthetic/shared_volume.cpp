#include "libvpm/synthetic/shared_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "libvpm/core/box.h"

namespace vpm::synthetic {
namespace {

// Column below a triangle: its shadow in the plane z = 0, counter-clockwise, and its top.
struct Column {
  std::array<Vec3, 3> corner;
  double sign = 0;          // +1 if the triangle faces up, -1 if it faces down
  double slope_x, slope_y;  // of the top
  double low, high;         // of the top

  // Returns the height of the top above a place; steep triangles are kept between their corners.
  double top(Vec3 x) const {
    const double z = corner[0].z + slope_x * (x.x - corner[0].x) + slope_y * (x.y - corner[0].y);
    return std::clamp(z, low, high);
  }
};

// Returns the columns of all triangles that throw a shadow.
std::vector<Column> columns_of(const Solid& solid) {
  std::vector<Column> columns;
  for (const auto& [i, j, k] : solid.triangles) {
    Vec3 a = solid.vertices[i], b = solid.vertices[j], c = solid.vertices[k];
    const Vec3 n = cross(b - a, c - a);
    if (n.z == 0) continue;
    if (n.z < 0) std::swap(b, c);
    columns.push_back({{a, b, c},
                       n.z > 0 ? 1.0 : -1.0,
                       -n.x / n.z,
                       -n.y / n.z,
                       std::min({a.z, b.z, c.z}),
                       std::max({a.z, b.z, c.z})});
  }
  return columns;
}

using Polygon = std::vector<Vec3>;

// Keeps the part of a polygon where a function that is linear over it is not negative (Sutherland
// and Hodgman 1974).
template <class Function>
void keep(const Polygon& polygon, const Function& f, Polygon& kept) {
  kept.clear();
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 p = polygon[k], q = polygon[(k + 1) % polygon.size()];
    const double at_p = f(p), at_q = f(q);
    if (at_p >= 0) kept.push_back(p);
    if ((at_p >= 0) != (at_q >= 0)) kept.push_back(p + at_p / (at_p - at_q) * (q - p));
  }
}

// Integrates a function that is linear over a polygon.
template <class Function>
double prism(const Polygon& polygon, const Function& f) {
  double sum = 0;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3 p = polygon[0], q = polygon[k - 1], r = polygon[k];
    const double twice = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    sum += twice / 6 * (f(p) + f(q) + f(r));
  }
  return sum;
}

class SharedColumns {
 public:
  explicit SharedColumns(double base) : base_(base) {}

  // Returns the volume between the base and the lower of both tops, over the shadow that both
  // throw; negative for a column of a triangle that faces up with one that faces down.
  double volume(const Column& s, const Column& t) {
    shadow_.assign(s.corner.begin(), s.corner.end());
    for (std::size_t k = 0; k < 3 && !shadow_.empty(); ++k) {
      const Vec3 from = t.corner[k], along = t.corner[(k + 1) % 3] - from;
      keep(
          shadow_, [&](Vec3 x) { return along.x * (x.y - from.y) - along.y * (x.x - from.x); },
          part_);
      std::swap(shadow_, part_);
    }
    if (shadow_.size() < 3) return 0;
    const auto excess = [&](Vec3 x) { return s.top(x) - t.top(x); };
    double sum = prism(shadow_, [&](Vec3 x) { return s.top(x) - base_; });
    // Subtracts what is above the other's top, which is nothing where both agree but for rounding.
    keep(shadow_, excess, part_);
    sum -= prism(part_, excess);
    return s.sign * t.sign * sum;
  }

 private:
  double base_;
  Polygon shadow_, part_;
};

// Lists columns over the squares of a grid.
class ColumnGrid {
 public:
  explicit ColumnGrid(const std::vector<Column>& columns) : stamp_(columns.size(), 0) {
    for (const Column& column : columns)
      for (const Vec3& corner : column.corner) box_.add(corner);
    count_ = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(columns.size()))));
    lists_.resize(static_cast<std::size_t>(count_) * static_cast<std::size_t>(count_));
    for (std::uint32_t k = 0; k < columns.size(); ++k)
      for_squares(columns[k], [&](auto& list) { list.push_back(k); });
  }

  // Calls take(k) once for each column k of the grid in whose squares the shadow of `column` lies,
  // too; all others share nothing with it.
  template <class Take>
  void near(const Column& column, const Take& take) {
    ++asked_;
    for_squares(column, [&](auto& list) {
      for (const std::uint32_t k : list)
        if (stamp_[k] != asked_) stamp_[k] = asked_, take(k);
    });
  }

 private:
  template <class Take>
  void for_squares(const Column& column, const Take& take) {
    Box bounds;
    for (const Vec3& corner : column.corner) bounds.add(corner);
    const auto square = [&](double x, double low, double high) {
      return std::clamp(static_cast<int>(std::floor((x - low) / (high - low) * count_)), 0,
                        count_ - 1);
    };
    const Vec3 low = box_.low, high = box_.high;
    for (int y = square(bounds.low.y, low.y, high.y); y <= square(bounds.high.y, low.y, high.y);
         ++y)
      for (int x = square(bounds.low.x, low.x, high.x); x <= square(bounds.high.x, low.x, high.x);
           ++x)
        take(lists_[static_cast<std::size_t>(x) +
                    static_cast<std::size_t>(count_) * static_cast<std::size_t>(y)]);
  }

  Box box_;
  int count_ = 0;
  std::vector<std::vector<std::uint32_t>> lists_;
  std::vector<std::uint32_t> stamp_;
  std::uint32_t asked_ = 0;
};

}  // namespace

double shared_volume(const Solid& a, const Solid& b) {
  const std::vector<Column> first = columns_of(a), second = columns_of(b);
  if (first.empty() || second.empty()) return 0;
  ColumnGrid grid(second);
  // Heights are taken about the middle of the second, where their rounding is least.
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Column& t : second) low = std::min(low, t.low), high = std::max(high, t.high);
  SharedColumns shared(0.5 * (low + high));
  double sum = 0;
  for (const Column& s : first)
    grid.near(s, [&](std::uint32_t k) { sum += shared.volume(s, second[k]); });
  return sum;
}

}  // namespace vpm::synthetic
