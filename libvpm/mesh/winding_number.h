// Generalised winding numbers: how often a mesh encloses a point.
//
// Distant groups of triangles count as one dipole each (Barill, Dickson, Schmidt, Levin, Jacobson
// 2018, "Fast winding numbers for soups and clouds", section 3), near triangles exactly. For a
// closed mesh, self-intersecting or not, the number is an integer up to that approximation, so
// half-integers separate inside from outside.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/mesh/triangle_bvh.h"

namespace vpm {

class WindingNumber {
 public:
  // Keeps a reference to `bvh`.
  explicit WindingNumber(const TriangleBvh& bvh);

  // Returns the winding number: +1 inside an outward-oriented closed mesh, 0 outside. Thread-safe.
  double at(Vec3 x) const;

  // Returns the winding number without some triangles, on which x may lie: the mean of the numbers
  // on their two sides.
  double at(Vec3 x, std::span<const std::uint32_t> without) const;

  // True if x is enclosed at least once.
  bool inside(Vec3 x) const { return at(x) > 0.5; }

 private:
  struct Dipole {
    Vec3 area;  // area-weighted normal of all triangles below
    Vec3 center;
    // Squared distance from the centre beyond which the dipole represents all triangles.
    double far2 = 0;
  };

  template <class Counts>
  double enclosures(Vec3 x, Counts counts) const;

  const TriangleBvh& bvh_;
  std::vector<Dipole> dipoles_;  // four per node
};

}  // namespace vpm
