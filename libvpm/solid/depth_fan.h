// Integral of the depth over the part of a cell inside, from one sample.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/solid/depth_cells.h"
#include "libvpm/solid/face_planes.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

class DepthFan {
 public:
  using Plane = FacePlanes::Plane;

  // Takes the part inside for a fan of triangles from `center`, where the depth is known. At the
  // segments it is 0 and grows as that below the planes in which they lie, one for each, outward
  // and of unit length: so much that a fan over a pyramid, a cap or a box is right. Along edges of
  // the cell the depth is that below the planes near both ends, but no more than the sample
  // foretells, which it is at an end without segments near: so it changes smoothly as they appear
  // or pass a corner. `normal` is that of the cell, of unit length. The order of segments and
  // points changes no bit.
  DepthIntegral integral(const DepthCell& cell, Vec3 normal, std::span<const Plane> planes,
                         Vec3 center, const Depth& depth);

 private:
  // End of what is inside of an edge of the cell: the place, the depth foretold there, how far
  // segments are near, and how deep the other end is below their planes.
  struct End {
    Vec3 place;
    double foretold = 0, share = 0, slope = 0;
  };

  void add(Vec3 p, Vec3 q, std::pair<double, double> weights);
  void add_segment(const CutSegment& segment, const Plane& plane);
  void add_edge(const DepthCell& cell, std::size_t edge);
  void add_interval(Vec3 from, Vec3 to);
  double foretold(Vec3 x) const;
  End end_at(Vec3 place, Vec3 other) const;
  static double mean_between(const End& from, const End& to);

  std::span<const CutSegment> segments_;
  std::span<const Plane> planes_;  // of the segments
  Vec3 normal_, center_;
  Depth depth_;
  WideSum volume_;
  WideVec3 moment_;
  std::vector<std::pair<double, const CutPoint*>> along_;
};

}  // namespace vpm
