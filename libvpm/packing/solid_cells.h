// Cells of a solid's bounding box, and what each holds of the solid: for proofs that spheres cover
// all of it.
#pragma once

#include <array>
#include <vector>

#include "libvpm/model/sphere.h"
#include "libvpm/packing/solid_distance.h"

namespace vpm {

// A box in the packer's frame (solid_distance.h).
struct Cell {
  Vec3 low, high;

  Vec3 center() const { return 0.5 * (low + high); }
  Vec3 corner(int k) const;  // k from 0 to 7
  double longest() const;
  double volume() const;
  // Returns the cell's halves across its longest side.
  std::array<Cell, 2> halves() const;
};

class SolidCells {
 public:
  // `enclosure` is that of the solid, or null to compute it. Throws as SolidDistance does.
  SolidCells(const Solid& solid, const Enclosure* enclosure);

  const SolidDistance& distance() const { return distance_; }
  // Returns the bounding box of the solid's boundary.
  const Cell& box() const { return box_; }
  // Returns a bound on the rounding of all places here: 1e-9 of the longest side, or more if the
  // solid is so far from the origin that its coordinates resolve less.
  double tolerance() const { return tolerance_; }

  enum class Place { outside, inside, cut };
  // Returns where a cell lies; `cut` also if the surface is only near.
  Place place(const Cell& cell) const;

  // Returns balls whose convex hull holds all that a cell has of the solid, however the surface
  // cuts it: corners of the cell that are not outside, and corners of what it has of the triangles,
  // each a ball of radius `slack`, at least the tolerance. A convex body, such as a sphere, that
  // holds all of the balls therefore holds that part of the solid. Many balls are joined to fewer,
  // larger ones. None are returned of a cell without any of the solid.
  std::vector<Sphere> hull(const Cell& cell, double slack) const;

 private:
  bool is_outside(Vec3 corner) const;

  SolidDistance distance_;
  Cell box_;
  double tolerance_;
};

}  // namespace vpm
