// Adds cells that are wholly behind the surface, several together.
#pragma once

#include <optional>
#include <utility>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/backend/cpu/cell_states.h"

namespace vpm {

// Collects the pieces of such cells, of which `Inside` supports the far ones. A cell without a
// piece that counts becomes free: it was hidden, not inside.
template <class Surface, class Inside>
class WholeCells {
 public:
  // Adds to `sum`, and to `unseen` what does not count.
  WholeCells(const PoseWork<Surface>& work, const Inside& inside, ToolSum& sum, UnseenSum& unseen)
      : work_(work),
        inside_(inside),
        measure_(work.measure_of(work.level.cell(0))),
        sum_(sum),
        unseen_(unseen) {}

  void add(std::uint32_t row) {
    const CellView cell = work_.level.cell(row);
    const bool compact = is_compact(cell.radius, work_.tool_radius.length);
    const CellClass found = std::exchange(work_.states.cells[row], CellClass::free);
    if (work_.states.keeps_sums) work_.states.results[row].sum = {};
    if (whole_part(compact, true, false) == WholePart::cell)
      return add({row, found}, piece_of(work_.level.mass(row), cell));
    for (std::uint32_t b = cell.begin; b < cell.end; ++b) {
      if (whole_part(compact, b == cell.begin, true) == WholePart::block)
        add({row, found}, piece_of(cell.masses[b], cell.blocks[b]));
    }
  }
  // Adds what is left; returns how many cells count.
  std::uint32_t finish() {
    push();
    return count_;
  }

 private:
  struct Origin {
    std::uint32_t row = kNoRow;
    CellClass found = CellClass::free;  // of the row
  };

  void add(const Origin& origin, const ToolPiece& piece) {
    origins_[size_++] = origin;
    pieces_.add(piece);
    if (pieces_.is_full()) push();
  }
  void push() {
    const auto takes = [&](const ToolPiece& piece, std::uint32_t k, const auto& sampled) {
      if (sampled.is_inside && (!sampled.is_far || supports(origins_[k].row, sampled))) return true;
      measure_.add_unseen(piece, sampled, unseen_);
      return false;
    };
    pieces_.push(measure_, takes, [&](std::uint32_t k, const ToolSum& part) {
      sum_.add(part);
      if (work_.states.keeps_sums) work_.states.results[origins_[k].row].sum.add(part);
      CellClass& cell = work_.states.cells[origins_[k].row];
      if (!counts(part) || cell != CellClass::free) return;
      cell = origins_[k].found;
      ++count_;
    });
    size_ = 0;
  }
  template <class PieceSample>
  bool supports(std::uint32_t row, const PieceSample& sampled) {
    if (row != supported_row_) {
      supported_row_ = row;
      support_.emplace(inside_.support(row, last_cut_));
    }
    return (*support_)(sampled.x, sampled.on_surface.foot);
  }

  using Support = decltype(std::declval<const Inside&>().support(std::uint32_t{},
                                                                 std::declval<std::uint32_t&>()));

  const PoseWork<Surface>& work_;
  const Inside& inside_;
  CellMeasure<Surface> measure_;  // serves all cells: their pieces name samples of the level
  ToolSum& sum_;
  UnseenSum& unseen_;
  PiecesTogether<Surface> pieces_;
  Origin origins_[kAtOnce];  // of the pieces
  std::uint32_t size_ = 0, count_ = 0;
  std::uint32_t supported_row_ = kNoRow, last_cut_ = kNoRow;
  std::optional<Support> support_;
};

}  // namespace vpm
