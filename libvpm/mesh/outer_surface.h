// Which parts of a closed mesh bound the solid that its winding number describes.
//
// Inside is what the mesh encloses at least once (winding number > 0): bodies that overlap make one
// body, a shell that faces inward takes away. What lies wholly inside bounds nothing. Triangles
// that meet others are cut along them into cells, and each cell asks for the winding number on its
// two sides, so that volumes are exact up to rounding.
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
  // `contacts` as from find_contacts; the solid is closed and consistently oriented, with at least
  // one triangle.
  OuterSurface(const Solid& solid, const std::vector<TrianglePair>& contacts);

  // Whether the triangle meets no other and has the inside, or the outside, on both of its sides.
  bool bounds_nothing(std::uint32_t triangle) const { return side_[triangle] == Side::none; }
  // See enclosed_surface; nothing where that is the solid as it is.
  const std::optional<Solid>& surface() const { return surface_; }
  const MassProperties& mass() const { return mass_; }

 private:
  // `turned` bounds the solid with the side that its triangle calls the inner one.
  enum class Side : char { unknown, outward, turned, none, cut };
  struct Cells;

  void find_sides(const Cells& cells, const Topology& topology);

  std::vector<Side> side_;
  std::optional<Solid> surface_;
  MassProperties mass_;
};

// The boundary of what the mesh encloses at least once, for integrals over it. The solid as it is
// where the surface neither meets itself nor lies within itself; else its triangles, cut where they
// meet, without the pieces inside: each with its own corners, facing outward.
Solid enclosed_surface(const Solid& solid);

// What bounds a solid and how much it holds, for all that asks more than once.
struct Enclosure {
  // As enclosed_surface; nothing where that is the solid as it is, and where its pieces do not
  // close up: then every triangle is a bound.
  std::optional<Solid> surface;
  bool faces_tell =
      true;           // what bounds the solid has the inside behind it and the outside in front
  double volume = 0;  // m^3
};
Enclosure enclosure_of(const Solid& solid);
Enclosure enclosure_of(const OuterSurface& outer);

// Volume and centre of mass of what the mesh encloses, overlaps counted once. Equals
// mass_properties to the bit where the surface neither meets itself nor lies within itself.
MassProperties enclosed_mass(const Solid& solid);

}  // namespace vpm
