// Tells inside from outside of a closed surface: cells that the surface misses hold the answer,
// the others hold the triangles of their column.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

class InsideIndex {
 public:
  // Needs a closed, consistently oriented surface, whose winding number is 0 or 1 off the surface.
  // Vertices and triangles must be those given here at each question.
  InsideIndex(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);

  // True if x lies inside. Exact but for places within rounding of the surface. Thread-safe.
  bool holds(Vec3 x, const std::vector<Vec3>& vertices,
             const std::vector<Triangle>& triangles) const;

  std::size_t bytes() const;

 private:
  enum class Cell : std::uint8_t { outside, inside, cut };
  static constexpr std::size_t kCellsPerByte = 4;
  // A triangle over a column, with its lowest and highest z in steps from the lowest place.
  struct Entry {
    std::uint32_t triangle;
    std::uint16_t low, high;
  };
  using Place = std::array<std::uint32_t, 3>;
  // Cells of a triangle's box, the last included.
  struct Span {
    Place low, high;
  };

  std::size_t column_of(const Place& p) const { return p[0] + std::size_t{cells_[0]} * p[1]; }
  std::size_t cell_of(const Place& p) const {
    return column_of(p) + std::size_t{cells_[0]} * cells_[1] * p[2];
  }
  Cell state(std::size_t cell) const {
    return static_cast<Cell>(state_[cell / kCellsPerByte] >> shift(cell) & 3);
  }
  void set_state(std::size_t cell, Cell state) {
    std::uint8_t& byte = state_[cell / kCellsPerByte];
    byte = static_cast<std::uint8_t>((byte & ~(3 << shift(cell))) | static_cast<int>(state)
                                                                        << shift(cell));
  }
  static int shift(std::size_t cell) { return static_cast<int>(2 * (cell % kCellsPerByte)); }
  bool holds_by_column(Vec3 x, std::size_t column, const std::vector<Vec3>& vertices,
                       const std::vector<Triangle>& triangles) const;
  double steps(double height) const { return per_step_ * height; }  // above the lowest place
  Span span_of(const std::array<Vec3, 3>& corners) const;
  void list_columns(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);
  void find_states(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles);
  void mark_cut_cells(const std::array<Vec3, 3>& corners, const Span& span);

  Vec3 low_;
  double per_cell_ = 0;  // cells per metre
  double middle_z_ = 0;
  Place cells_{};
  double per_step_ = 0;               // steps of entries per metre
  std::vector<std::uint8_t> state_;   // two bits for each cell
  std::vector<std::uint32_t> begin_;  // of the columns' entries, and the end of the last
  std::vector<Entry> entries_;
};

}  // namespace vpm
