#include "libvpm/solid/inside_index.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Cells along the longest side: columns of a few triangles each, up to half a megabyte of states.
constexpr double kLeastCells = 16, kMostCells = 128, kCellsPerRootOfTriangles = 0.6;
// Widening of triangles, in cells, before they are given to cells.
constexpr double kMargin = 1e-5;
// Steps of heights along z, over the whole surface.
constexpr double kSteps = 65000;

// Returns on which side of the line from a to b, seen along z, x lies. Both triangles of an edge
// are told the same, also of places on it, since the lower index comes first.
bool is_left(std::uint32_t i, Vec3 a, std::uint32_t j, Vec3 b, Vec3 x) {
  const auto left_of = [&](Vec3 p, Vec3 q) {
    return (q.x - p.x) * (x.y - p.y) - (q.y - p.y) * (x.x - p.x) >= 0;
  };
  return i < j ? left_of(a, b) : !left_of(b, a);
}

}  // namespace

InsideIndex::InsideIndex(const std::vector<Vec3>& vertices,
                         const std::vector<Triangle>& triangles) {
  Box box;
  for (const Vec3& v : vertices) box.add(v);
  const Vec3 size = box.size();
  const double root = std::sqrt(static_cast<double>(triangles.size()));
  const double along = std::clamp(kCellsPerRootOfTriangles * root, kLeastCells, kMostCells);
  per_cell_ = along / std::max({size.x, size.y, size.z});
  const double margin = 0.01 / per_cell_;
  low_ = box.low - Vec3{margin, margin, margin};
  middle_z_ = 0.5 * (box.low.z + box.high.z);
  per_step_ = kSteps / (box.high.z - low_.z);
  for (std::size_t k = 0; k < 3; ++k) {
    const double cells = coordinate(box.high - low_, static_cast<int>(k)) * per_cell_ + 0.01;
    cells_[k] = static_cast<std::uint32_t>(cells) + 1;
  }
  state_.assign(cell_of({0, 0, cells_[2]}) / kCellsPerByte + 1, 0);  // outside
  list_columns(vertices, triangles);
  find_states(vertices, triangles);
}

InsideIndex::Span InsideIndex::span_of(const std::array<Vec3, 3>& corners) const {
  Box bounds;
  for (const Vec3& v : corners) bounds.add(per_cell_ * (v - low_));
  Span span{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const auto cell = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(x, 0.0, cells_[k] - 1.0));
    };
    span.low[k] = cell(coordinate(bounds.low, axis) - kMargin);
    span.high[k] = cell(coordinate(bounds.high, axis) + kMargin);
  }
  return span;
}

// Lists the triangles over each column, and marks the cells that they cut.
void InsideIndex::list_columns(const std::vector<Vec3>& vertices,
                               const std::vector<Triangle>& triangles) {
  std::vector<Span> spans;
  begin_.assign(std::size_t{cells_[0]} * cells_[1] + 1, 0);
  const auto for_columns = [&](const Span& span, const auto& take) {
    for (std::uint32_t y = span.low[1]; y <= span.high[1]; ++y)
      for (std::uint32_t x = span.low[0]; x <= span.high[0]; ++x) take(column_of({x, y, 0}));
  };
  for (const auto& [i, j, k] : triangles) {
    const std::array<Vec3, 3> corners{vertices[i], vertices[j], vertices[k]};
    spans.push_back(span_of(corners));
    mark_cut_cells(corners, spans.back());
    for_columns(spans.back(), [&](std::size_t column) { ++begin_[column + 1]; });
  }
  for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  entries_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [i, j, k] = triangles[t];
    const double a = vertices[i].z, b = vertices[j].z, c = vertices[k].z;
    const Entry entry{t, static_cast<std::uint16_t>(steps(std::min({a, b, c}) - low_.z)),
                      static_cast<std::uint16_t>(steps(std::max({a, b, c}) - low_.z) + 1)};
    for_columns(spans[t], [&](std::size_t column) { entries_[next[column]++] = entry; });
  }
}

// Decides the cells that no triangle cuts, by their centres.
void InsideIndex::find_states(const std::vector<Vec3>& vertices,
                              const std::vector<Triangle>& triangles) {
  for (std::uint32_t z = 0; z < cells_[2]; ++z)
    for (std::uint32_t y = 0; y < cells_[1]; ++y)
      for (std::uint32_t x = 0; x < cells_[0]; ++x) {
        const std::size_t cell = cell_of({x, y, z});
        if (state(cell) == Cell::cut) continue;
        const Vec3 center = low_ + (1 / per_cell_) * Vec3{x + 0.5, y + 0.5, z + 0.5};
        const bool in = holds_by_column(center, column_of({x, y, 0}), vertices, triangles);
        set_state(cell, in ? Cell::inside : Cell::outside);
      }
}

// Marks cells of the range that the triangle's plane passes through.
void InsideIndex::mark_cut_cells(const std::array<Vec3, 3>& corners, const Span& span) {
  const Vec3 normal = normalized_or_zero(cross(corners[1] - corners[0], corners[2] - corners[0]));
  const Vec3 on = per_cell_ * (corners[0] - low_);
  const double reach =
      0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)) + kMargin;
  for (std::uint32_t z = span.low[2]; z <= span.high[2]; ++z)
    for (std::uint32_t y = span.low[1]; y <= span.high[1]; ++y)
      for (std::uint32_t x = span.low[0]; x <= span.high[0]; ++x)
        if (std::abs(dot(normal, Vec3{x + 0.5, y + 0.5, z + 0.5} - on)) <= reach)
          set_state(cell_of({x, y, z}), Cell::cut);
}

bool InsideIndex::holds(Vec3 x, const std::vector<Vec3>& vertices,
                        const std::vector<Triangle>& triangles) const {
  const Vec3 at = per_cell_ * (x - low_);
  if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < cells_[0] && at.y < cells_[1] &&
        at.z < cells_[2]))
    return false;
  const Place place{static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y),
                    static_cast<std::uint32_t>(at.z)};
  const Cell found = state(cell_of(place));
  if (found != Cell::cut) return found == Cell::inside;
  return holds_by_column(x, column_of(place), vertices, triangles);
}

// Counts the crossings of the ray from x along z, away from the middle, by their directions.
bool InsideIndex::holds_by_column(Vec3 x, std::size_t column, const std::vector<Vec3>& vertices,
                                  const std::vector<Triangle>& triangles) const {
  const bool upward = x.z > middle_z_;
  const double at = steps(x.z - low_.z);
  int winding = 0;
  for (std::uint32_t e = begin_[column]; e < begin_[column + 1]; ++e) {
    const Entry& entry = entries_[e];
    if (upward ? entry.high < at : entry.low > at) continue;
    const auto& [i, j, k] = triangles[entry.triangle];
    const Vec3 &a = vertices[i], &b = vertices[j], &c = vertices[k];
    const bool left = is_left(i, a, j, b, x);
    if (is_left(j, b, k, c, x) != left || is_left(k, c, i, a, x) != left) continue;
    const Vec3 normal = cross(b - a, c - a);
    const double height = (left ? 1 : -1) * dot(normal, x - a);  // > 0: x lies above the triangle
    if (upward ? height < 0 : height > 0) winding += left ? 1 : -1;
  }
  return upward ? winding > 0 : winding < 0;
}

std::size_t InsideIndex::bytes() const {
  return state_.size() + begin_.size() * sizeof begin_[0] + entries_.size() * sizeof entries_[0];
}

}  // namespace vpm
