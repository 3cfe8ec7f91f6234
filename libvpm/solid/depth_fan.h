// Integral of the depth over the part of a cell inside, from one sample.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/solid/depth_cells.h"
#include "libvpm/solid/depth_grid.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

// ∫ depth dA and ∫ depth x dA over a flat piece.
struct DepthIntegral {
  double volume = 0;
  Vec3 moment;
};

class DepthFan {
 public:
  // All x with normal.x = offset.
  struct Plane {
    Vec3 normal;
    double offset;
  };

  // Takes the part inside for a fan of triangles from `center`, where the depth is known. At the
  // segments it is 0 and grows as that below the planes in which they lie, one for each, outward
  // and of unit length: so much that a fan over a pyramid, a cap or a box is right. Along edges of
  // the cell the depth is that below the planes at both ends, but no more than the sample
  // foretells. `normal` is that of the cell, of unit length. The order of segments and points
  // changes no bit.
  DepthIntegral integral(const DepthCell& cell, Vec3 normal, std::span<const Plane> planes,
                         Vec3 center, const Depth& depth);

 private:
  // Place on an edge of the cell: a corner, or where the part inside begins or ends.
  struct Stop {
    Vec3 place;
    const Plane* plane = nullptr;  // in which the segment there lies; null at corners
    bool is_corner = false;
  };

  void add(Vec3 p, Vec3 q, std::pair<double, double> weights);
  void add_segment(const CutSegment& segment, const Plane& plane);
  void add_edge(const DepthCell& cell, std::span<const Plane> planes, std::size_t edge);
  void add_interval(const Stop& from, const Stop& to);
  double foretold(Vec3 x) const;
  double mean_between(const Stop& from, const Stop& to) const;

  Vec3 normal_, center_;
  Depth depth_;
  WideSum volume_;
  WideVec3 moment_;
  std::vector<std::pair<double, const CutPoint*>> along_;
};

}  // namespace vpm
