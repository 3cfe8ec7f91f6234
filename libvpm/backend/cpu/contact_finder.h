// Groups the cells of a level that count at a pose into contacts with one body.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/backend/cpu/cell_states.h"
#include "libvpm/backend/cpu/contact_places.h"
#include "libvpm/measure/contact_patch.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Copies share what is immutable. Belongs to one thread.
class ContactFinder {
 public:
  ContactFinder(const ToolModel& tool, const SpatialLevel& level)
      : tool_(tool), places_(std::make_shared<const LevelPlaces>(level, tool.radius)) {}

  // Forgets the contacts of the body before.
  void start() { found_.clear(); }
  // Finds those of the cells that count; CellStates::results holds the sum of each. Cells are taken
  // in the order of rows, so that the number of threads changes no bit.
  template <class Surface>
  void run(const PoseWork<Surface>& work) {
    cells_.clear(), places_of_cells_.clear(), regions_.start();
    const CellStates& states = work.states;
    const std::uint32_t end = work.level.size();
    for (std::uint32_t i = next_busy(states.cells, 0, end); i < end;
         i = next_busy(states.cells, i + 1, end))
      if (states.counts(i) && counts(states.results[i].sum)) add_cell(work, i);
    join_places();
    number_.fill(kNone);
    for (Cell& cell : cells_) {
      cell.contact = contact_of(regions_.region_of(places_of_cells_[cell.place]));
      CellContact& contact = found_[cell.contact];
      contact.add(states.results[cell.row].sum, cell.centroid);
      contact.section += cell.section;
    }
    add_depths(work);
  }

  std::span<const CellContact> found() const { return found_; }

 private:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  // A cell that counts.
  struct Cell {
    std::uint32_t row;
    std::size_t place;  // where its places begin in places_of_cells_
    Vec3 centroid;      // of what is behind the surface, about the tool's centre of mass, m
    Vec3 section;       // as CellContact::section
    std::uint32_t contact = kNone;  // in found_
  };

  template <class Surface>
  void add_cell(const PoseWork<Surface>& work, std::uint32_t row) {
    Cell cell{row, places_of_cells_.size(), work.level.mass(row).centroid, {}, kNone};
    const CellPlaces at = places_->of_cell(row);
    if (work.states.cells[row] == CellClass::cut)
      cut(work, at, cell);
    else
      places_of_cells_.insert(places_of_cells_.end(), at.places.begin(), at.places.end());
    if (places_of_cells_.size() == cell.place)
      places_of_cells_.push_back(places_->at(cell.centroid));
    cells_.push_back(cell);
  }

  // Joins the places of each cell, and those that are neighbours.
  void join_places() {
    for (const ContactPlace place : places_of_cells_) regions_.mark(place);
    regions_.join_neighbors();
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const std::size_t end = k + 1 < cells_.size() ? cells_[k + 1].place : places_of_cells_.size();
      for (std::size_t place = cells_[k].place + 1; place < end; ++place)
        regions_.join(places_of_cells_[place - 1], places_of_cells_[place]);
    }
  }

  void note_behind(std::span<const std::uint64_t> places) {
    for (std::size_t word = 0; word < places.size(); ++word) behind_[word] |= places[word];
  }

  // Finds what the mean plane of a cut cell leaves behind it, and notes where that is.
  template <class Surface>
  void cut(const PoseWork<Surface>& work, const CellPlaces& places, Cell& cell) {
    const CellView view = work.level.cell(cell.row);
    const CutCell at{work.states.results[cell.row].plane, work.center(cell.row), view.radius};
    const ClipPlane plane = mean_plane_of(at, work.to_surface);
    CellSection behind;
    behind_.assign(places.words, 0);
    for (std::uint32_t b = view.begin; b < view.end; ++b) {
      const CellBlock& block = view.blocks[b];
      const PlaneSide side =
          side_of_plane(plane.distance(widen(block.center)), double{block.radius});
      if (side == PlaneSide::before) continue;
      if (side == PlaneSide::behind) {
        behind.add(view.masses[b]);
        note_behind(places.of_block(b - view.begin));
        continue;
      }
      for (std::uint32_t first = block.begin; first < block.end; first += kAtOnce) {
        const std::uint32_t some = std::min(block.end - first, kAtOnce);
        std::uint32_t bits = add_section(plane, {view.samples + first, some}, view.faces, behind);
        for (; bits != 0; bits &= bits - 1)
          note_behind(places.of_sample(first - view.blocks[view.begin].begin +
                                       static_cast<std::uint32_t>(std::countr_zero(bits))));
      }
    }
    for (std::uint32_t word = 0; word < places.words; ++word)
      for (std::uint64_t bits = behind_[word]; bits != 0; bits &= bits - 1)
        places_of_cells_.push_back(places.place(word, std::countr_zero(bits)));
    if (behind.weight == 0) return;
    cell.centroid = behind.centroid(plane);
    // The surface may end within the cell, which then has less behind it than behind the plane.
    const double counted = work.states.results[cell.row].sum.volume.real() / behind.weight;
    cell.section = std::min(counted, 1.0) * behind.section * plane.normal;
  }

  // Returns the index of a region's contact, which is new if it has none.
  std::uint32_t contact_of(ContactPlace region) {
    if (number_[region] == kNone) {
      number_[region] = static_cast<std::uint32_t>(found_.size());
      found_.emplace_back();
    }
    return number_[region];
  }

  // Samples the surface at the centres of spheres, several together.
  template <class Surface>
  void add_depths(const PoseWork<Surface>& work) {
    Vec3 centers[kAtOnce];
    PlaceSample sampled[kAtOnce];
    for (std::size_t first = 0; first < cells_.size(); first += kAtOnce) {
      const std::size_t some = std::min<std::size_t>(cells_.size() - first, kAtOnce);
      for (std::size_t k = 0; k < some; ++k) centers[k] = work.center(cells_[first + k].row);
      sample_places(work.surface, {centers, some}, sampled);
      for (std::size_t k = 0; k < some; ++k) {
        const Cell& cell = cells_[first + k];
        found_[cell.contact].note_depth(sampled[k].on_surface,
                                        tool_.spheres[work.level.sphere(cell.row)].radius);
      }
    }
  }

  const ToolModel& tool_;
  std::shared_ptr<const LevelPlaces> places_;
  ContactRegions regions_;
  std::vector<Cell> cells_;
  std::vector<ContactPlace> places_of_cells_;
  std::vector<std::uint64_t>
      behind_;  // what lies behind the surface of a cell, as CellPlaces::sets
  std::array<std::uint32_t, kContactPlaces> number_{};  // of a contact, by its region
  std::vector<CellContact> found_;
};

}  // namespace vpm
