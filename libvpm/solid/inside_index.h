// Tells inside from outside of a closed surface: cells that the surface misses hold the answer,
// the others hold the triangles of their column.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

// What a question to an index needs, also on a device: its lists where they lie.
struct InsideView {
  enum class Cell : std::uint8_t { outside, inside, cut };
  static constexpr std::size_t kCellsPerByte = 4;
  // A triangle over a column, with its lowest and highest z in steps from the lowest place.
  struct Entry {
    std::uint32_t triangle;
    std::uint16_t low, high;
  };
  using Place = std::array<std::uint32_t, 3>;

  Vec3 low;
  double per_cell = 0;  // cells per metre
  double middle_z = 0;
  double per_step = 0;  // steps of entries per metre
  Place cells{};
  const std::uint8_t* state = nullptr;   // two bits for each cell
  const std::uint32_t* begin = nullptr;  // of the columns' entries, and the end of the last
  const Entry* entries = nullptr;
  const Vec3* vertices = nullptr;
  const Triangle* triangles = nullptr;

  VPM_HD std::size_t column_of(const Place& p) const { return p[0] + std::size_t{cells[0]} * p[1]; }
  VPM_HD std::size_t cell_of(const Place& p) const {
    return column_of(p) + std::size_t{cells[0]} * cells[1] * p[2];
  }
  VPM_HD static int shift(std::size_t cell) { return static_cast<int>(2 * (cell % kCellsPerByte)); }
  VPM_HD Cell state_of(std::size_t cell) const {
    return static_cast<Cell>(state[cell / kCellsPerByte] >> shift(cell) & 3);
  }

  // True if x lies inside. Exact but for places within rounding of the surface.
  VPM_HD bool holds(Vec3 x) const {
    std::size_t column = 0;
    const Cell found = state_at(x, column);
    return found == Cell::cut ? winding(x, column) > 0 : found == Cell::inside;
  }
  // Returns the state of the cell that holds x, and its column.
  VPM_HD Cell state_at(Vec3 x, std::size_t& column) const {
    const Vec3 at = per_cell * (x - low);
    if (!(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < cells[0] && at.y < cells[1] &&
          at.z < cells[2]))
      return Cell::outside;
    const Place place{static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y),
                      static_cast<std::uint32_t>(at.z)};
    column = column_of(place);
    return state_of(cell_of(place));
  }
  // Returns how often the surface winds about x: counts the crossings of the ray from x along z,
  // away from the middle, by their directions. Takes every `step`-th entry of the column from
  // `first` on, so that several threads may share one.
  VPM_HD int winding(Vec3 x, std::size_t column, std::uint32_t first = 0,
                     std::uint32_t step = 1) const {
    const bool upward = x.z > middle_z;
    const double at = per_step * (x.z - low.z);
    int sum = 0;
    for (std::uint32_t e = begin[column] + first; e < begin[column + 1]; e += step) {
      const Entry& entry = entries[e];
      if (upward ? entry.high < at : entry.low > at) continue;
      const auto& [i, j, k] = triangles[entry.triangle];
      const Vec3 &a = vertices[i], &b = vertices[j], &c = vertices[k];
      const bool left = is_left(i, a, j, b, x);
      if (is_left(j, b, k, c, x) != left || is_left(k, c, i, a, x) != left) continue;
      const Vec3 normal = cross(b - a, c - a);
      const double height = (left ? 1 : -1) * dot(normal, x - a);  // > 0: x is above the triangle
      if (upward ? height < 0 : height > 0) sum += left == upward ? 1 : -1;
    }
    return sum;
  }

 private:
  // Returns on which side of the line from a to b, seen along z, x lies. Both triangles of an edge
  // are told the same, also of places on it, since the lower index comes first.
  VPM_HD static bool is_left(std::uint32_t i, Vec3 a, std::uint32_t j, Vec3 b, Vec3 x) {
    return i < j ? left_of(a, b, x) : !left_of(b, a, x);
  }
  VPM_HD static bool left_of(Vec3 p, Vec3 q, Vec3 x) {
    return (q.x - p.x) * (x.y - p.y) - (q.y - p.y) * (x.x - p.x) >= 0;
  }
};

class InsideIndex {
 public:
  // Needs a closed, consistently oriented surface, whose winding number is 0 or 1 off the surface.
  // Vertices and triangles must be those given here at each question.
  InsideIndex(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

  // Returns what a question needs. Valid as long as this and the lists given.
  InsideView view(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) const {
    InsideView v = view_;
    v.state = state_.data(), v.begin = begin_.data(), v.entries = entries_.data();
    v.vertices = vertices.data(), v.triangles = triangles.data();
    return v;
  }
  std::size_t states() const { return state_.size(); }
  std::size_t columns() const { return begin_.size() - 1; }
  std::size_t entries() const { return entries_.size(); }

  std::size_t bytes() const;

 private:
  using Cell = InsideView::Cell;
  using Entry = InsideView::Entry;
  using Place = InsideView::Place;
  // Cells of a triangle's box, the last included.
  struct Span {
    Place low, high;
  };

  void set_state(std::size_t cell, Cell state) {
    std::uint8_t& byte = state_[cell / InsideView::kCellsPerByte];
    const int shift = InsideView::shift(cell);
    byte = static_cast<std::uint8_t>((byte & ~(3 << shift)) | static_cast<int>(state) << shift);
  }
  double steps(double height) const { return view_.per_step * height; }  // above the lowest place
  Span span_of(const std::array<Vec3, 3>& corners) const;
  void list_columns(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);
  void find_states(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);
  void mark_cut_cells(const std::array<Vec3, 3>& corners, const Span& span);

  InsideView view_;  // without the lists
  std::vector<std::uint8_t> state_;
  std::vector<std::uint32_t> begin_;
  std::vector<Entry> entries_;
};

}  // namespace vpm
