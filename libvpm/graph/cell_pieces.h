// Cuts the Voronoi cells of a level into compact samples, grouped into blocks.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "libvpm/graph/solid_faces.h"
#include "libvpm/graph/voronoi_cells.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Compact piece of a cell, in normalised coordinates about the sphere's centre.
struct CellPiece {
  Vec3 centroid;
  double volume = 0;
  // Radius of the ball with the same second moment.
  double moment_radius = 0;
  double bounding_radius = 0;        // largest distance of its points from the centroid
  Moment moment;                     // second moment about the centroid, per volume
  std::optional<SampleFace> face{};  // beside which it lies; its `sample` is not set
};

// Appends pieces of a ball, about size^3 in volume each; their volumes sum to the ball's and their
// common centroid is its centre. Pieces are cells of a body-centred cubic lattice, rotated so that
// no common plane is parallel to its layers. A ball of a few sizes stays whole, since caps of balls
// are exact.
void cut_ball(double radius, double size, std::vector<CellPiece>& pieces);

// Appends pieces of the gap part of a cell, halved until the moment radius fits `size`. Sorts the
// cell's segments by piece.
void cut_gap(VoronoiCells& cells, std::size_t sphere, Vec3 center, double size,
             std::vector<CellPiece>& pieces);

struct CutCells {
  std::vector<std::uint32_t> block_begin;
  std::vector<CellBlock> blocks;
  std::vector<CellSample> samples;
  std::vector<SampleFace> faces;
};

// Cuts all cells, and sorts their segments by piece. Pieces beside one of the solid's `faces` get
// its shape. Coordinates are stored relative to `origin`, times `unit`; weights relative to
// `volume`.
CutCells cut_cells(std::span<const Sphere> spheres, VoronoiCells& cells, const SolidFaces& faces,
                   double size, Vec3 origin, double unit, double volume);

}  // namespace vpm
