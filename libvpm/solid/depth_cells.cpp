#include "libvpm/solid/depth_cells.h"

#include <algorithm>

namespace vpm {

std::size_t DepthCells::longest_edge(const Part& part) {
  const auto& [a, b, c] = part.corner;
  const double ab = squared_norm(b - a), bc = squared_norm(c - b), ca = squared_norm(a - c);
  if (ab >= bc && ab >= ca) return 0;
  return bc >= ca ? 1 : 2;
}

// Counts how often the edge passes through the other's surface before its middle.
int DepthCells::inside_at(Vec3 middle, std::size_t edge, const Part& part) const {
  const Vec3 apex = part.corner[(edge + 2) % 3];
  int is_inside = part.is_inside[edge];
  for (std::size_t k = part.first_point; k < part.end_point; ++k)
    if (points_[k].edge == edge && side(points_[k].place, middle, apex) >= 0)
      is_inside += points_[k].sign;
  return std::clamp(is_inside, 0, 1);
}

std::array<DepthCells::Part, 2> DepthCells::halves(const Part& part) {
  const std::size_t edge = longest_edge(part);
  const Vec3 middle = 0.5 * (part.corner[edge] + part.corner[(edge + 1) % 3]);
  const int is_inside = inside_at(middle, edge, part);
  const Part first = half(part, edge, middle, is_inside, true);
  return {first, half(part, edge, middle, is_inside, false)};
}

// The part's edge runs from u to v, with the middle m, and its third corner is the apex. The first
// half is the triangle u, m, apex, the second m, v, apex; so the edge 0 of both is half of that
// edge.
DepthCells::Part DepthCells::half(const Part& part, std::size_t edge, Vec3 middle, int is_inside,
                                  bool is_first) {
  const std::size_t first_segment = segments_.size(), first_point = points_.size();
  const std::size_t next = (edge + 1) % 3, opposite = (edge + 2) % 3;
  const Vec3 apex = part.corner[opposite];
  const std::size_t cut_edge = is_first ? 1 : 2;  // of the half, from m to apex or back
  for (std::size_t k = part.first_point; k < part.end_point; ++k) {
    CutPoint point = points_[k];
    if (point.edge == edge) {
      if ((side(point.place, middle, apex) >= 0) != is_first) continue;
      point.edge = 0;
    } else {
      if ((point.edge == opposite) != is_first) continue;
      point.edge = is_first ? 2 : 1;
    }
    points_.push_back(point);
  }
  for (std::size_t k = part.first_segment; k < part.end_segment; ++k) {
    CutSegment segment = segments_[k];
    const double at_start = side(segment.start, middle, apex),
                 at_end = side(segment.end, middle, apex);
    const bool starts_here = (at_start >= 0) == is_first, ends_here = (at_end >= 0) == is_first;
    if (!starts_here && !ends_here) continue;
    if (starts_here != ends_here) {
      const Vec3 place =
          segment.start + at_start / (at_start - at_end) * (segment.end - segment.start);
      (starts_here ? segment.end : segment.start) = place;
      points_.push_back({place, starts_here ? 1 : -1, cut_edge});
    }
    segments_.push_back(segment);
  }
  const auto& c = part.corner;
  const auto& in = part.is_inside;
  const auto made = [&](const std::array<Vec3, 3>& corner, const std::array<int, 3>& inside) {
    return Part{corner, inside, first_segment, first_point, segments_.size(), points_.size()};
  };
  if (is_first) return made({c[edge], middle, apex}, {in[edge], is_inside, in[opposite]});
  return made({middle, c[next], apex}, {is_inside, in[next], in[opposite]});
}

}  // namespace vpm
