// Generalised winding numbers: how often a mesh encloses a point.
//
// Far groups of triangles count as one dipole each (Barill, Dickson, Schmidt, Levin, Jacobson 2018,
// "Fast winding numbers for soups and clouds", section 3), near triangles exactly. For a closed
// mesh the number is an integer up to that approximation, so that half-way between integers
// decides, whether or not the mesh intersects itself.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/mesh/triangle_bvh.h"

namespace vpm {

class WindingNumber {
 public:
  // Keeps a reference: `bvh` must outlive it.
  explicit WindingNumber(const TriangleBvh& bvh);

  // +1 inside of an outward oriented closed mesh, 0 outside. Thread-safe.
  double at(Vec3 x) const;

  // The same without some triangles that x may lie on: half-way between the numbers on both sides.
  double at(Vec3 x, std::span<const std::uint32_t> without) const;

  // Inside of the solid: enclosed at least once.
  bool inside(Vec3 x) const { return at(x) > 0.5; }

 private:
  struct Dipole {
    Vec3 area;  // area-weighted normal of all triangles below
    Vec3 center;
    double far2 = 0;  // squared distance from the centre beyond which the dipole stands for all
  };

  template <class Counts>
  double enclosures(Vec3 x, Counts counts) const;

  const TriangleBvh& bvh_;
  std::vector<Dipole> dipoles_;  // four per node
};

}  // namespace vpm
