// Parts of a closed mesh that bound the solid given by its winding number.
//
// Inside is what the mesh encloses at least once (winding number > 0): overlapping bodies form one,
// and inward shells subtract. Triangles in the interior bound nothing. Intersecting triangles are
// cut into cells, and each cell takes the winding numbers on its two sides, so that volumes are
// exact up to rounding.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "libvpm/mesh/self_intersection.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/model/solid.h"

namespace vpm {

class OuterSurface {
 public:
  // Needs `contacts` from find_contacts, and a closed, consistently oriented solid with at least
  // one triangle. Throws TooMuchWork beyond WorkLimit.
  OuterSurface(const Solid& solid, const std::vector<TrianglePair>& contacts,
               const MeshProgress& progress = {});

  // True if the triangle meets no other and has the inside, or the outside, on both sides.
  bool bounds_nothing(std::uint32_t triangle) const { return side_[triangle] == Side::none; }
  // Returns enclosed_surface(solid), or nothing if that is the solid itself.
  const std::optional<Solid>& surface() const { return surface_; }
  const MassProperties& mass() const { return mass_; }

 private:
  // Relation of a triangle to the solid; `turned` bounds it with the back as outside.
  enum class Side : char { unknown, outward, turned, none, cut };
  struct Cells;

  void find_sides(Cells& cells, const Topology& topology);

  std::vector<Side> side_;
  std::optional<Solid> surface_;
  MassProperties mass_;
};

// Returns the boundary of what the mesh encloses at least once, for integrals over it: the solid
// itself if its surface neither meets nor encloses itself; else its triangles, cut where they meet,
// without the pieces inside, each with its own corners and facing outward.
Solid enclosed_surface(const Solid& solid);

// Boundary and volume of a solid, computed once for several users.
struct Enclosure {
  // The enclosed_surface, or nothing if every triangle bounds: the surface is the solid itself, or
  // its pieces do not close.
  std::optional<Solid> surface;
  bool faces_tell = true;  // each face of the boundary has the inside behind it
  double volume = 0;       // m^3
};
Enclosure enclosure_of(const Solid& solid);
Enclosure enclosure_of(const OuterSurface& outer);

// Returns volume and centre of mass of what the mesh encloses, counting overlaps once. Equals
// mass_properties to the bit if the surface neither meets nor encloses itself.
MassProperties enclosed_mass(const Solid& solid);

}  // namespace vpm
