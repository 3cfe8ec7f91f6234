// Generalised winding numbers: how often a mesh encloses a point.
//
// Far groups of triangles count as one dipole each (Barill, Dickson, Schmidt, Levin, Jacobson 2018,
// "Fast winding numbers for soups and clouds", section 3), near triangles exactly. For a closed
// mesh the number is an integer up to that approximation, so that half-way between integers
// decides, whether or not the mesh intersects itself.
#pragma once

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

  // Inside of the solid: enclosed a number of times other than zero.
  bool inside(Vec3 x) const { return std::abs(at(x)) > 0.5; }

 private:
  struct Dipole {
    Vec3 area;  // area-weighted normal of all triangles below
    Vec3 center;
    double far2 = 0;  // squared distance from the centre beyond which the dipole stands for all
  };

  const TriangleBvh& bvh_;
  std::vector<Dipole> dipoles_;  // four per node
};

}  // namespace vpm
