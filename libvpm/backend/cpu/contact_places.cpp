#include "libvpm/backend/cpu/contact_places.h"

#include <algorithm>
#include <bit>

namespace vpm {

namespace {

// Returns the index along an axis of the cube that holds a place, which is given in edges of cubes
// from the middle of the grid; the outermost cube takes what is beyond.
int cube_index(double edges) {
  constexpr double kHalf = kPlacesPerEdge / 2;
  return static_cast<int>(std::clamp(edges + kHalf, 0.0, kPlacesPerEdge - 1.0));
}
ContactPlace number_of(int x, int y, int z) {
  constexpr int kEdge = kPlacesPerEdge;
  return static_cast<ContactPlace>((x * kEdge + y) * kEdge + z);
}

}  // namespace

ContactPlace LevelPlaces::at(Vec3 place) const {
  const Vec3 edges = 1 / edge_ * place;
  return number_of(cube_index(edges.x), cube_index(edges.y), cube_index(edges.z));
}

void LevelPlaces::append_places_of(const ToolPiece& sample,
                                   std::vector<ContactPlace>& places) const {
  const Vec3 center = 1 / edge_ * sample.at;
  const double radius = sample.extent / edge_;
  places.push_back(at(sample.at));
  const auto for_cubes = [&](double x, const auto& visit) {
    for (int k = cube_index(x - radius); k <= cube_index(x + radius); ++k)
      visit(k, k + 0.5 - kPlacesPerEdge / 2);
  };
  if (radius > 0.5)
    for_cubes(center.x, [&](int i, double x) {
      for_cubes(center.y, [&](int j, double y) {
        for_cubes(center.z, [&](int k, double z) {
          if (squared_norm(Vec3{x, y, z} - center) < radius * radius)
            places.push_back(number_of(i, j, k));
        });
      });
    });
}

LevelPlaces::LevelPlaces(const SpatialLevel& level, double tool_radius)
    : edge_(2 * tool_radius / kPlacesPerEdge) {
  cells_.reserve(level.size() + std::size_t{1});
  std::vector<ContactPlace> of_samples;    // of a cell, those of each sample in turn
  std::vector<std::size_t> end_of_sample;  // in of_samples
  for (std::uint32_t row = 0; row < level.size(); ++row) {
    const CellView cell = level.cell(row);
    of_samples.clear(), end_of_sample.clear();
    for (std::uint32_t b = cell.begin; b < cell.end; ++b)
      for (std::uint32_t k = cell.blocks[b].begin; k < cell.blocks[b].end; ++k) {
        append_places_of(piece_of(cell.samples[k], cell.faces), of_samples);
        end_of_sample.push_back(of_samples.size());
      }
    add_cell(cell, of_samples, end_of_sample);
  }
}

void LevelPlaces::add_cell(const CellView& cell, std::span<const ContactPlace> of_samples,
                           std::span<const std::size_t> end_of_sample) {
  constexpr std::uint16_t kNone = UINT16_MAX;
  std::array<std::uint16_t, kContactPlaces> bits;
  bits.fill(kNone);
  const std::size_t first_place = cells_.back().place, first_set = cells_.back().set;
  for (const ContactPlace place : of_samples)
    if (bits[place] == kNone) {
      bits[place] = static_cast<std::uint16_t>(places_.size() - first_place);
      places_.push_back(place);
    }
  const std::uint32_t blocks = cell.end - cell.begin,
                      words = words_for(places_.size() - first_place);
  sets_.resize(first_set + (blocks + end_of_sample.size()) * words);
  std::size_t sample = 0, next = 0;
  for (std::uint32_t b = 0; b < blocks; ++b) {
    const CellBlock& block = cell.blocks[cell.begin + b];
    for (std::uint32_t k = block.begin; k < block.end; ++k, ++sample)
      for (; next < end_of_sample[sample]; ++next)
        for (const std::size_t set : {std::size_t{b}, blocks + sample})
          sets_[first_set + set * words + bits[of_samples[next]] / kBits] |=
              std::uint64_t{1} << bits[of_samples[next]] % kBits;
  }
  cells_.back().blocks = blocks;
  cells_.push_back({places_.size(), sets_.size(), 0});
}

namespace {

// Calls visit(k) for each bit k of a row that is 1.
template <class Visit>
void for_bits(std::uint32_t row, const Visit& visit) {
  for (; row != 0; row &= row - 1) visit(static_cast<std::uint32_t>(std::countr_zero(row)));
}
ContactPlace place_of(std::uint32_t row, std::uint32_t z) {
  return static_cast<ContactPlace>(row * kPlacesPerEdge + z);
}

}  // namespace

void ContactRegions::join_in_row(std::uint32_t row) {
  const std::uint32_t marked = rows_[row], follows = marked & marked << 1;
  for_bits(marked, [&](std::uint32_t z) {
    parent_[place_of(row, z)] = follows >> z & 1 ? parent_[place_of(row, z - 1)] : place_of(row, z);
  });
}

// Joins the marked places of two rows that lie beside each other. Those within each row are joined,
// so one pair of places will do for each two runs that touch.
void ContactRegions::join_rows(std::uint32_t row, std::uint32_t other) {
  const std::uint32_t a = rows_[row], b = rows_[other], facing = a & b;
  const auto join_first = [&](std::uint32_t pairs, std::uint32_t shift) {
    for_bits(pairs & ~(pairs << 1),
             [&](std::uint32_t z) { join(place_of(row, z), place_of(other, z + shift - 1)); });
  };
  join_first(facing, 1);
  join_first(a & b << 1 & ~(facing | facing << 1), 0);
  join_first(a & b >> 1 & ~(facing | facing >> 1), 2);
}

void ContactRegions::join_neighbors() {
  constexpr std::uint32_t kEdge = kPlacesPerEdge;
  for (std::uint32_t row = 0; row < rows_.size(); ++row) {
    if (rows_[row] == 0) continue;
    join_in_row(row);
    const std::uint32_t x = row / kEdge, y = row % kEdge;
    if (y > 0) join_rows(row, row - 1);
    if (x == 0) continue;
    if (y > 0) join_rows(row, row - kEdge - 1);
    join_rows(row, row - kEdge);
    if (y + 1 < kEdge) join_rows(row, row - kEdge + 1);
  }
}

}  // namespace vpm
