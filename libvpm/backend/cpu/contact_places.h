// Which cells of a level hang together in a contact: those that have places behind the surface in
// neighbouring cubes of a grid about the tool.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/backend/cpu/spatial_level.h"

namespace vpm {

// Number of a cube: the grid divides the cube about the ball of the tool radius. Its cubes have an
// edge of an eighth of that radius, so places that are nearer lie in the same cube or in
// neighbours, and places that are a quarter apart along an axis do not.
using ContactPlace = std::uint16_t;
inline constexpr std::uint32_t kPlacesPerEdge = 16;
inline constexpr std::uint32_t kContactPlaces = kPlacesPerEdge * kPlacesPerEdge * kPlacesPerEdge;

// Sets of cubes in which a cell has samples: bit k of a set, in words of 64, stands for places[k].
struct CellPlaces {
  static constexpr std::uint32_t kBits = 64;  // of a word

  std::span<const ContactPlace> places;  // each once
  const std::uint64_t* sets = nullptr;   // of each block, then of each sample, in their order
  std::uint32_t blocks = 0, words = 0;   // of sets before those of samples; words of each set

  ContactPlace place(std::uint32_t word, int bit) const {
    return places[std::size_t{word} * kBits + static_cast<std::size_t>(bit)];
  }
  // Return the set of a block or sample, by its place in the cell.
  std::span<const std::uint64_t> of_block(std::uint32_t k) const {
    return {sets + std::size_t{k} * words, words};
  }
  std::span<const std::uint64_t> of_sample(std::uint32_t k) const { return of_block(blocks + k); }
};

// Where the cells of a level lie. A sample lies in the cube of its centre, and a large one in those
// with their middle in its ball, too, so that neighbouring samples have neighbouring cubes at
// coarse levels. Immutable.
class LevelPlaces {
 public:
  LevelPlaces(const SpatialLevel& level, double tool_radius);

  // Returns the cube of the grid that holds a place, which is given from the tool's centre of
  // mass, m.
  ContactPlace at(Vec3 place) const;
  CellPlaces of_cell(std::uint32_t row) const {
    const Cell& cell = cells_[row];
    const std::size_t count = cells_[row + 1].place - cell.place;
    return {{places_.data() + cell.place, count},
            sets_.data() + cell.set,
            cell.blocks,
            words_for(count)};
  }

 private:
  static constexpr std::uint32_t kBits = CellPlaces::kBits;

  // Where the places and sets of a cell begin.
  struct Cell {
    std::size_t place = 0, set = 0;
    std::uint32_t blocks = 0;
  };

  static std::uint32_t words_for(std::size_t places) {
    return static_cast<std::uint32_t>((places + kBits - 1) / kBits);
  }
  void add_cell(const CellView& cell, std::span<const ContactPlace> of_samples,
                std::span<const std::size_t> end_of_sample);
  void append_places_of(const ToolPiece& sample, std::vector<ContactPlace>& places) const;

  double edge_;                  // m
  std::vector<Cell> cells_{{}};  // and one past the last
  std::vector<ContactPlace> places_;
  std::vector<std::uint64_t> sets_;
};

// Finds which marked places hang together, by union-find. Belongs to one thread.
class ContactRegions {
 public:
  void start() { rows_.fill(0); }
  void mark(ContactPlace place) {
    rows_[place / kPlacesPerEdge] |= static_cast<Row>(1U << place % kPlacesPerEdge);
  }
  // Joins marked places in neighbouring cubes, after all are marked and before others are joined.
  void join_neighbors();
  void join(ContactPlace a, ContactPlace b) {
    const ContactPlace x = region_of(a), y = region_of(b);
    x < y ? parent_[y] = x : parent_[x] = y;
  }
  // Returns the place that stands for all that one is joined with.
  ContactPlace region_of(ContactPlace place) {
    while (parent_[place] != place) place = parent_[place] = parent_[parent_[place]];
    return place;
  }

 private:
  using Row = std::uint16_t;  // of cubes along z, a bit each
  static_assert(kPlacesPerEdge == 16);

  void join_in_row(std::uint32_t row);
  void join_rows(std::uint32_t row, std::uint32_t other);

  std::array<Row, kPlacesPerEdge * kPlacesPerEdge> rows_{};  // of marked places, by x and y
  std::array<ContactPlace, kContactPlaces> parent_{};
};

}  // namespace vpm
