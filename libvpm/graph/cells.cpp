#include "libvpm/graph/cells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"
#include "libvpm/graph/enclosing_sphere.h"

namespace vpm {
namespace {

constexpr std::size_t kBlockSamples = 64;

// Sorts pieces into runs of `size` that are compact in space, and appends the ends of the runs. All
// runs but one of a split are full.
void group(std::span<CellPiece> pieces, std::size_t size, std::size_t offset,
           std::vector<std::size_t>& ends) {
  if (pieces.size() <= size) {
    ends.push_back(offset + pieces.size());
    return;
  }
  Box box;
  for (const CellPiece& p : pieces) box.add(p.centroid);
  const int axis = box.longest_axis();
  std::stable_sort(pieces.begin(), pieces.end(), [&](const CellPiece& a, const CellPiece& b) {
    return coordinate(a.centroid, axis) < coordinate(b.centroid, axis);
  });
  const std::size_t runs = (pieces.size() + size - 1) / size;
  const std::size_t middle = runs / 2 * size;
  group(pieces.first(middle), size, offset, ends);
  group(pieces.subspan(middle), size, offset + middle, ends);
}

float round_up(double value) {
  const float rounded = static_cast<float>(value);
  return double{rounded} < value ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                 : rounded;
}

// Maps pieces about a sphere's centre to stored coordinates.
struct Placement {
  Vec3 center;  // sphere's centre relative to the stored origin
  double unit = 1, volume = 1;

  Vec3f place(Vec3 p) const { return narrow(unit * (center + p)); }
  CellSample sample(const CellPiece& piece) const {
    return {place(piece.centroid), static_cast<float>(unit * piece.moment_radius),
            piece.volume / volume};
  }
  CellBlock block(std::span<const CellPiece> pieces) const {
    std::vector<Sphere> balls;
    for (const CellPiece& p : pieces) balls.push_back({p.centroid, p.reach});
    const Vec3f stored = place(enclosing_sphere(balls).center);
    const Vec3 at = widen(stored) / unit - center;
    return {stored, round_up(unit * enclosing_radius(at, balls)), 0, 0};
  }
};

struct SphereCell {
  std::vector<CellBlock> blocks;
  std::vector<CellSample> samples;
};

SphereCell build_cell(std::vector<CellPiece> pieces, const Placement& placement) {
  std::vector<std::size_t> ends, of_neighbors;
  group(pieces, kBlockSamples, 0, ends);
  SphereCell cell;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    const std::span<CellPiece> of_block = std::span(pieces).subspan(begin, end - begin);
    group(of_block, kNeighborSamples, 0, of_neighbors);
    CellBlock block = placement.block(of_block);
    block.begin = static_cast<std::uint32_t>(begin);
    block.end = static_cast<std::uint32_t>(end);
    cell.blocks.push_back(block);
    begin = end;
  }
  for (const CellPiece& piece : pieces) cell.samples.push_back(placement.sample(piece));
  return cell;
}

}  // namespace

Cells build_cells(std::span<const Sphere> spheres, const VoronoiCells& voronoi, double size,
                  Vec3 origin, double unit, double volume) {
  std::vector<SphereCell> of_sphere(spheres.size());
  parallel_for(spheres.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<CellPiece> pieces;
      cut_ball(spheres[i].radius, size, pieces);
      cut_gap(voronoi, i, spheres[i].center, size, pieces);
      of_sphere[i] = build_cell(std::move(pieces), {spheres[i].center - origin, unit, volume});
    }
  });
  Cells cells;
  for (const SphereCell& cell : of_sphere) {
    const std::uint32_t first = static_cast<std::uint32_t>(cells.samples.size());
    cells.block_begin.push_back(static_cast<std::uint32_t>(cells.blocks.size()));
    for (CellBlock block : cell.blocks) {
      block.begin += first;
      block.end += first;
      cells.blocks.push_back(block);
    }
    cells.samples.insert(cells.samples.end(), cell.samples.begin(), cell.samples.end());
  }
  cells.block_begin.push_back(static_cast<std::uint32_t>(cells.blocks.size()));
  return cells;
}

}  // namespace vpm
