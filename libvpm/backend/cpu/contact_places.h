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

// Where samples and blocks of a level lie. Immutable.
class LevelPlaces {
 public:
  LevelPlaces(const SpatialLevel& level, double tool_radius);

  // Returns the cube of the grid that holds a place, which is given from the tool's centre of
  // mass, m.
  ContactPlace at(Vec3 place) const;
  // Returns the cube of a sample's centre, and of large samples those with their middle in its
  // ball, so that neighbouring samples have neighbouring cubes at coarse levels, too.
  std::span<const ContactPlace> of_sample(std::uint32_t sample) const {
    return {of_samples_.data() + begin_of_sample_[sample],
            of_samples_.data() + begin_of_sample_[sample + 1]};
  }
  // Returns those of a block's samples, each once.
  std::span<const ContactPlace> of_block(std::uint32_t block) const {
    return {of_blocks_.data() + begin_of_block_[block],
            of_blocks_.data() + begin_of_block_[block + 1]};
  }

 private:
  void add_sample(const ToolPiece& sample);

  double edge_;  // m
  std::vector<ContactPlace> of_samples_, of_blocks_;
  // Where the places of each sample and block begin, and one past the last.
  std::vector<std::uint32_t> begin_of_sample_{0}, begin_of_block_{0};
};

// Joins places by union-find. Belongs to one thread.
class ContactRegions {
 public:
  void start() {
    for (const ContactPlace place : marked_) is_marked_[place] = false;
    marked_.clear();
  }
  // Begins a cell: all places that are marked until the next one hang together.
  void begin_cell() { of_cell_ = last_ = kNone; }
  void mark(std::span<const ContactPlace> places) {
    for (const ContactPlace place : places) mark(place);
  }
  void mark(ContactPlace place) {
    if (place == of_cell_ || place == last_) return;
    if (!is_marked_[place]) {
      is_marked_[place] = true;
      parent_[place] = place;
      marked_.push_back(place);
    }
    if (of_cell_ == kNone) of_cell_ = place;
    join(of_cell_, place);
    last_ = place;
  }
  // Returns a place of the last cell, kNone if it has none.
  std::uint32_t of_cell() const { return of_cell_; }
  // Joins marked places in neighbouring cubes, after all cells.
  void join_neighbors();
  // Returns the place that stands for all that one is joined with.
  ContactPlace region_of(ContactPlace place) {
    while (parent_[place] != place) place = parent_[place] = parent_[parent_[place]];
    return place;
  }

  static constexpr std::uint32_t kNone = UINT32_MAX;

 private:
  void join(std::uint32_t a, std::uint32_t b) {
    const ContactPlace x = region_of(static_cast<ContactPlace>(a)),
                       y = region_of(static_cast<ContactPlace>(b));
    x < y ? parent_[y] = x : parent_[x] = y;
  }

  std::array<bool, kContactPlaces> is_marked_{};
  std::array<ContactPlace, kContactPlaces> parent_{};
  std::vector<ContactPlace> marked_;
  std::uint32_t of_cell_ = kNone, last_ = kNone;
};

}  // namespace vpm
