#include "libvpm/backend/cpu/contact_places.h"

#include <algorithm>

namespace vpm {

LevelPlaces::LevelPlaces(const SpatialLevel& level, double tool_radius)
    : edge_(2 * tool_radius / kPlacesPerEdge) {
  std::vector<ContactPlace> of_block;
  for (std::uint32_t row = 0; row < level.size(); ++row) {
    const CellView cell = level.cell(row);
    for (std::uint32_t b = cell.begin; b < cell.end; ++b) {  // all in their order
      const auto first = static_cast<std::ptrdiff_t>(of_samples_.size());
      for (std::uint32_t k = cell.blocks[b].begin; k < cell.blocks[b].end; ++k)
        add_sample(piece_of(cell.samples[k], cell.faces));
      of_block.assign(of_samples_.begin() + first, of_samples_.end());
      std::sort(of_block.begin(), of_block.end());
      const auto end = std::unique(of_block.begin(), of_block.end());
      of_blocks_.insert(of_blocks_.end(), of_block.begin(), end);
      begin_of_block_.push_back(static_cast<std::uint32_t>(of_blocks_.size()));
    }
  }
}

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

void LevelPlaces::add_sample(const ToolPiece& sample) {
  const Vec3 center = 1 / edge_ * sample.at;
  const double radius = sample.extent / edge_;
  of_samples_.push_back(at(sample.at));
  const auto for_cubes = [&](double x, const auto& visit) {
    for (int k = cube_index(x - radius); k <= cube_index(x + radius); ++k)
      visit(k, k + 0.5 - kPlacesPerEdge / 2);
  };
  if (radius > 0.5)
    for_cubes(center.x, [&](int i, double x) {
      for_cubes(center.y, [&](int j, double y) {
        for_cubes(center.z, [&](int k, double z) {
          if (squared_norm(Vec3{x, y, z} - center) < radius * radius)
            of_samples_.push_back(number_of(i, j, k));
        });
      });
    });
  begin_of_sample_.push_back(static_cast<std::uint32_t>(of_samples_.size()));
}

void ContactRegions::join_neighbors() {
  constexpr int kEdge = kPlacesPerEdge;
  for (const ContactPlace place : marked_) {
    const int x = place / (kEdge * kEdge), y = place / kEdge % kEdge, z = place % kEdge;
    for (int i = std::max(x - 1, 0); i <= x; ++i)  // half of them: each pair is met once or twice
      for (int j = std::max(y - 1, 0); j <= std::min(y + 1, kEdge - 1); ++j)
        for (int k = std::max(z - 1, 0); k <= std::min(z + 1, kEdge - 1); ++k) {
          const int other = (i * kEdge + j) * kEdge + k;
          if (is_marked_[static_cast<std::size_t>(other)])
            join(place, static_cast<std::uint32_t>(other));
        }
  }
}

}  // namespace vpm
