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

}  // namespace

InsideIndex::InsideIndex(const std::vector<Vec3>& vertices,
                         const std::vector<Triangle>& triangles) {
  Box box;
  for (const Vec3& v : vertices) box.add(v);
  const Vec3 size = box.size();
  const double root = std::sqrt(static_cast<double>(triangles.size()));
  const double along = std::clamp(kCellsPerRootOfTriangles * root, kLeastCells, kMostCells);
  view_.per_cell = along / std::max({size.x, size.y, size.z});
  const double margin = 0.01 / view_.per_cell;
  view_.low = box.low - Vec3{margin, margin, margin};
  view_.middle_z = 0.5 * (box.low.z + box.high.z);
  view_.per_step = kSteps / (box.high.z - view_.low.z);
  for (std::size_t k = 0; k < 3; ++k) {
    const double cells =
        coordinate(box.high - view_.low, static_cast<int>(k)) * view_.per_cell + 0.01;
    view_.cells[k] = static_cast<std::uint32_t>(cells) + 1;
  }
  state_.assign(view_.cell_of({0, 0, view_.cells[2]}) / InsideView::kCellsPerByte + 1,
                0);  // outside
  list_columns(vertices, triangles);
  find_states(vertices, triangles);
}

InsideIndex::Span InsideIndex::span_of(const std::array<Vec3, 3>& corners) const {
  Box bounds;
  for (const Vec3& v : corners) bounds.add(view_.per_cell * (v - view_.low));
  Span span{};
  for (std::size_t k = 0; k < 3; ++k) {
    const int axis = static_cast<int>(k);
    const auto cell = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(x, 0.0, view_.cells[k] - 1.0));
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
  begin_.assign(std::size_t{view_.cells[0]} * view_.cells[1] + 1, 0);
  const auto for_columns = [&](const Span& span, const auto& take) {
    for (std::uint32_t y = span.low[1]; y <= span.high[1]; ++y)
      for (std::uint32_t x = span.low[0]; x <= span.high[0]; ++x) take(view_.column_of({x, y, 0}));
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
    const Entry entry{t, static_cast<std::uint16_t>(steps(std::min({a, b, c}) - view_.low.z)),
                      static_cast<std::uint16_t>(steps(std::max({a, b, c}) - view_.low.z) + 1)};
    for_columns(spans[t], [&](std::size_t column) { entries_[next[column]++] = entry; });
  }
}

// Decides the cells that no triangle cuts, by their centres.
void InsideIndex::find_states(const std::vector<Vec3>& vertices,
                              const std::vector<Triangle>& triangles) {
  const InsideView index = view(vertices, triangles);
  for (std::uint32_t z = 0; z < index.cells[2]; ++z)
    for (std::uint32_t y = 0; y < index.cells[1]; ++y)
      for (std::uint32_t x = 0; x < index.cells[0]; ++x) {
        const std::size_t cell = index.cell_of({x, y, z});
        if (index.state_of(cell) == Cell::cut) continue;
        const Vec3 center = index.low + (1 / index.per_cell) * Vec3{x + 0.5, y + 0.5, z + 0.5};
        const bool in = index.winding(center, index.column_of({x, y, 0})) > 0;
        set_state(cell, in ? Cell::inside : Cell::outside);
      }
}

// Marks cells of the range that the triangle's plane passes through.
void InsideIndex::mark_cut_cells(const std::array<Vec3, 3>& corners, const Span& span) {
  const Vec3 normal = normalized_or_zero(cross(corners[1] - corners[0], corners[2] - corners[0]));
  const Vec3 on = view_.per_cell * (corners[0] - view_.low);
  const double reach =
      0.5 * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)) + kMargin;
  for (std::uint32_t z = span.low[2]; z <= span.high[2]; ++z)
    for (std::uint32_t y = span.low[1]; y <= span.high[1]; ++y)
      for (std::uint32_t x = span.low[0]; x <= span.high[0]; ++x)
        if (std::abs(dot(normal, Vec3{x + 0.5, y + 0.5, z + 0.5} - on)) <= reach)
          set_state(view_.cell_of({x, y, z}), Cell::cut);
}

std::size_t InsideIndex::bytes() const {
  return state_.size() + begin_.size() * sizeof begin_[0] + entries_.size() * sizeof entries_[0];
}

}  // namespace vpm
