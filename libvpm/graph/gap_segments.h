// The gap of a packing: what lies in the solid and in none of its spheres, as short pieces of
// lines.
//
// A lattice of parallel lines crosses the solid along the axis that shows it largest. On each line
// the solid and the spheres are intervals, found exactly; what the spheres leave of the solid's is
// cut into pieces of about the lattice's spacing. The only error is that of summing over lines
// instead of integrating; every second coordinate is shifted by the golden ratio from row to row,
// so that faces along the axes do no harm.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/graph/sphere_bvh.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct GapSegment {
  Vec3 center;  // midpoint of the piece
  float length = 0;
  std::uint32_t sphere = 0;  // whose surface is nearest
};

struct GapSegments {
  int axis = 2;                // direction of the lines
  double row = 0, column = 0;  // spacing of the lines along axis + 2 and axis + 1 (modulo 3)
  std::vector<GapSegment> segments;

  // Half the edges of the prism that a piece stands for.
  Vec3 half_extent(const GapSegment& segment) const;
  double volume(const GapSegment& segment) const { return row * column * double{segment.length}; }
};

// Inside is where the winding number is positive, so that self-intersecting and nested shells
// count once. `spacing` is the largest distance of lines and length of pieces. Coordinates of
// magnitude 1.
GapSegments find_gap_segments(const Solid& solid, const SphereBvh& bvh, double spacing);

}  // namespace vpm
