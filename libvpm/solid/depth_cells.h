// Cuts the part of a large triangle that lies inside the other solid into cells, so small that the
// other's depth may be taken for linear over each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Segment of the boundary of the part inside, which lies to its left seen from outside.
struct CutSegment {
  Vec3 start, end;
  std::uint32_t other;        // number of the other's triangle in which it lies
  std::uint32_t segment = 0;  // number among all of the pair, for contacts
};

// Point where an edge of a triangle, from corner `edge` to the next, passes through the other's
// surface: a segment that ends there lets the edge in (sign +1), one that starts there out (-1).
struct CutPoint {
  Vec3 place;
  int sign;
  std::size_t edge;
  std::uint32_t segment = 0;  // of a triangle that is not cut into cells: as CutSegment::segment
};

// Triangle of a cell, and what cuts it.
struct DepthCell {
  std::array<Vec3, 3> corner;
  std::array<int, 3> is_inside;  // 1 for corners inside the other solid, else 0
  std::span<const CutSegment> segments;
  std::span<const CutPoint> points;
  bool is_whole() const { return segments.empty() && points.empty(); }
  double longest_edge2() const {
    const auto& [a, b, c] = corner;
    return std::max({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)});
  }
};

class DepthCells {
 public:
  // Integrates over the part of a cell inside by halving cells across their longest edges:
  // a cell for which visitor.is_too_large(cell) holds is halved in any case. Of any other one
  // visitor.take_if_small(cell, weight) adds as much as it is small and returns the weight that is
  // left. If that is any, visitor.value(cell) is computed. The visitor adds it by
  // take(cell, value, weight) if is_negligible(value, weight), or with the share of the weight that
  // agreement(value, first, second, weight) returns, as far as the values of both halves confirm
  // it, which leaves the better one in `value`. For the rest of the weight the same is done with
  // each half. They share the bits of the points where segments cross from one to the other, and
  // which corners lie inside follows from these points: so parts add up to the whole. `normal`
  // points out of the triangle, of any length.
  template <class Visitor>
  void run(const DepthCell& cell, Vec3 normal, double weight, Visitor& visitor) {
    segments_.assign(cell.segments.begin(), cell.segments.end());
    points_.assign(cell.points.begin(), cell.points.end());
    normal_ = normal;
    cut(Part{cell.corner, cell.is_inside, 0, 0, segments_.size(), points_.size()},
        std::optional<typename Visitor::Value>(), weight, visitor);
  }

 private:
  // Cell with its segments and points in the lists, from the first to before the end.
  struct Part {
    std::array<Vec3, 3> corner;
    std::array<int, 3> is_inside;
    std::size_t first_segment, first_point, end_segment, end_point;
  };

  // Valid until something is appended to the lists.
  DepthCell cell_of(const Part& part) const {
    const auto of = [](const auto& list, std::size_t first, std::size_t end) {
      return std::span(list).subspan(first, end - first);
    };
    return {part.corner, part.is_inside, of(segments_, part.first_segment, part.end_segment),
            of(points_, part.first_point, part.end_point)};
  }
  static bool is_outside(const DepthCell& cell) {
    return cell.is_whole() && cell.is_inside[0] == 0;
  }

  template <class Value, class Visitor>
  void cut(const Part& part, std::optional<Value> value, double weight, Visitor& visitor) {
    const DepthCell cell = cell_of(part);
    if (is_outside(cell)) return;
    const bool is_too_large = visitor.is_too_large(cell);
    if (!is_too_large) {
      weight = visitor.take_if_small(cell, weight);
      if (!(weight > 0)) return;
      if (!value) value = visitor.value(cell);
      if (visitor.is_negligible(*value, weight)) return visitor.take(cell, *value, weight);
    }
    const std::size_t segments = segments_.size(), points = points_.size();
    const std::array<Part, 2> half = halves(part);
    std::array<std::optional<Value>, 2> values;
    if (!is_too_large) {
      const std::array<DepthCell, 2> cells{cell_of(half[0]), cell_of(half[1])};
      if (is_outside(cells[0]) || is_outside(cells[1])) {
        values = {value, value};  // what lies in one half alone is what it was
      } else {
        values = {visitor.value(cells[0]), visitor.value(cells[1])};
        const double taken = weight * visitor.agreement(*value, *values[0], *values[1], weight);
        if (taken > 0) visitor.take(cell_of(part), *value, taken);
        weight -= taken;
      }
    }
    if (weight > 0)
      for (std::size_t k = 0; k < 2; ++k) cut(half[k], values[k], weight, visitor);
    segments_.resize(segments);
    points_.resize(points);
  }

  // Appends what cuts the two halves of a part.
  std::array<Part, 2> halves(const Part& part);
  static std::size_t longest_edge(const Part& part);
  // Returns a number that is not negative on the first half's side of the cut from the middle of an
  // edge to the corner opposite.
  double side(Vec3 x, Vec3 middle, Vec3 apex) const {
    return dot(cross(apex - middle, x - middle), normal_);
  }
  int inside_at(Vec3 middle, std::size_t edge, const Part& part) const;
  Part half(const Part& part, std::size_t edge, Vec3 middle, int is_inside, bool is_first);

  std::vector<CutSegment> segments_;
  std::vector<CutPoint> points_;
  Vec3 normal_;
};

}  // namespace vpm
