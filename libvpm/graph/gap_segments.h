// Gap of a packing: the part of the solid in none of its spheres, as short segments of lines.
//
// A lattice of parallel lines crosses the solid along the axis of its largest projection. On each
// line the solid and the spheres are exact intervals; what spheres leave of the solid is cut into
// segments about as long as the lattice's spacing. The only error is that a sum over lines replaces
// an integral. Rows are shifted by the golden ratio, so that faces along the axes do not bias it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/graph/sphere_bvh.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct GapSegment {
  Vec3 center;  // midpoint
  float length = 0;
  std::uint32_t sphere = 0;  // the sphere whose surface is nearest
};

struct GapSegments {
  int axis = 2;                // direction of the lines
  double row = 0, column = 0;  // spacing of the lines along axis + 2 and axis + 1 (modulo 3)
  std::vector<GapSegment> segments;

  // Returns half the edge lengths of the prism that a segment stands for.
  Vec3 half_extent(const GapSegment& segment) const;
  double volume(const GapSegment& segment) const { return row * column * double{segment.length}; }
};

// Returns the gap's segments, by row of lines. Inside is where the winding number is positive, so
// that self-intersecting and nested shells count once. `spacing` is the largest distance of lines
// and length of segments. Coordinates must be of magnitude 1.
GapSegments find_gap_segments(const Solid& solid, const SphereBvh& bvh, double spacing);

}  // namespace vpm
