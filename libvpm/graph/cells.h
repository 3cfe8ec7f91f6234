// The cells of a level: each sphere's share cut into compact samples, grouped into blocks.
#pragma once

#include <span>
#include <vector>

#include "libvpm/graph/shares.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// A compact piece of a share, in normalised coordinates about the sphere's centre.
struct CellPiece {
  Vec3 centroid;
  double volume = 0;
  double moment_radius = 0;  // of the ball with the piece's second moment
  double reach = 0;          // largest distance of its points from the centroid
};

// Cuts a ball into pieces of volume about size^3 that sum to its volume and have its centre as
// centroid: the cells of a body-centred cubic lattice, turned so that no common plane is parallel
// to its layers. A ball of a few sizes stays whole, since the cap of a ball is exact.
void cut_ball(double radius, double size, std::vector<CellPiece>& pieces);

// Cuts the gap part of a share likewise, by halving until the moment radius fits `size`.
void cut_gap(const Shares& shares, std::size_t sphere, Vec3 center, double size,
             std::vector<CellPiece>& pieces);

struct Cells {
  std::vector<std::uint32_t> block_begin;
  std::vector<CellBlock> blocks;
  std::vector<CellSample> samples;
};

// Coordinates relative to `origin`, multiplied by `unit`; weights relative to `volume`.
Cells build_cells(std::span<const Sphere> spheres, const Shares& shares, double size, Vec3 origin,
                  double unit, double volume);

}  // namespace vpm
