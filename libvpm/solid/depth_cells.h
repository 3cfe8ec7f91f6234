// Cuts the part of a large triangle that lies inside the other solid into cells, so small that the
// other's depth may be taken for linear over each.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
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
  // Calls visit(part, state) for the cell, then for its halves, quarters and so on, across their
  // longest edges, as long as visit returns false; passes over parts that hold nothing inside.
  // Halves start from the state in which their whole left it. Halves share the bits of the points
  // where segments cross from one to the other, and which corners lie inside follows from these
  // points: so parts add up to the whole. `normal` points out of the triangle, of any length.
  template <class State, class Visit>
  void run(const DepthCell& cell, Vec3 normal, const State& state, const Visit& visit) {
    segments_.assign(cell.segments.begin(), cell.segments.end());
    points_.assign(cell.points.begin(), cell.points.end());
    normal_ = normal;
    cut(Part{cell.corner, cell.is_inside, 0, 0}, state, visit);
  }

 private:
  // Cell whose segments and points are the last of the lists, from here on.
  struct Part {
    std::array<Vec3, 3> corner;
    std::array<int, 3> is_inside;
    std::size_t first_segment, first_point;
  };

  template <class State, class Visit>
  void cut(const Part& part, State state, const Visit& visit) {
    const std::size_t segments = segments_.size(), points = points_.size();
    const DepthCell cell{part.corner, part.is_inside,
                         std::span(segments_).subspan(part.first_segment),
                         std::span(points_).subspan(part.first_point)};
    if (cell.is_whole() && part.is_inside[0] == 0) return;
    if (visit(cell, state)) return;
    const std::size_t edge = longest_edge(part);
    const Vec3 middle = 0.5 * (part.corner[edge] + part.corner[(edge + 1) % 3]);
    const int is_inside = inside_at(middle, edge, part, points);
    for (const bool is_first : {true, false}) {
      cut(half(part, edge, middle, is_inside, is_first, segments, points), state, visit);
      segments_.resize(segments);
      points_.resize(points);
    }
  }

  static std::size_t longest_edge(const Part& part);
  // Returns a number that is not negative on the first half's side of the cut from the middle of an
  // edge to the corner opposite.
  double side(Vec3 x, Vec3 middle, Vec3 apex) const {
    return dot(cross(apex - middle, x - middle), normal_);
  }
  int inside_at(Vec3 middle, std::size_t edge, const Part& part, std::size_t points) const;
  // Appends what cuts a half of the part, whose lists end at `segments` and `points`.
  Part half(const Part& part, std::size_t edge, Vec3 middle, int is_inside, bool is_first,
            std::size_t segments, std::size_t points);

  std::vector<CutSegment> segments_;
  std::vector<CutPoint> points_;
  Vec3 normal_;
};

}  // namespace vpm
