// Distance to the boundary of a solid, in the packer's own frame. What of the mesh lies inside of
// the solid is no boundary.
//
// The frame puts the solid's box in the middle of the unit cube and scales by a power of two, so
// that a solid 2^k times as large gives the same numbers to the bit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

struct UnitFrame {
  Vec3 center;          // of the solid's box
  double scale = 1;     // a power of two: metres per unit
  double longest = 1;   // side of the box, in units: from 1/2 to 1
  double rounding = 0;  // metres: bound of what the frame and distances in it lose
  Vec3 to_unit(Vec3 p) const { return (p - center) / scale + Vec3{0.5, 0.5, 0.5}; }
  Vec3 to_solid(Vec3 p) const { return center + scale * (p - Vec3{0.5, 0.5, 0.5}); }
  // Radii shrink, so that rounding makes no overlap.
  Sphere to_solid(const Sphere& s) const;
};

class SolidDistance {
 public:
  // `enclosure` is that of the solid, where it is known. Throws Error(refused) for a solid without
  // triangles, extent or finite coordinates.
  explicit SolidDistance(const Solid& solid, const Enclosure* enclosure = nullptr);
  SolidDistance(const SolidDistance&) = delete;
  SolidDistance& operator=(const SolidDistance&) = delete;

  const UnitFrame& frame() const { return frame_; }
  double volume() const { return volume_; }  // m^3
  SurfacePoint closest(Vec3 x, double within) const { return boundary_->closest(x, within); }
  Vec3 closest_on(std::uint32_t triangle, Vec3 x) const;
  // Whether the disk of this radius about a point of the triangle lies in the triangle.
  bool holds_disk(std::uint32_t triangle, Vec3 point, double radius) const;
  // As TriangleBvh::around; and a triangle that it found.
  std::size_t around(Vec3 x, double half, std::span<std::uint32_t> found) const {
    return boundary_->around(x, half, found);
  }
  const TriangleBvh::Corners& corners(std::uint32_t found) const {
    return boundary_->corners()[found];
  }
  bool inside(Vec3 x) const { return winding_.inside(x); }
  // The same by the triangle that is nearest to x, which costs next to nothing; nothing where x is
  // nearest to an edge, or too near to say.
  std::optional<bool> inside_of_face(std::uint32_t nearest, Vec3 x) const;

 private:
  UnitFrame frame_;
  std::vector<Vec3> vertices_;  // of the boundary, like triangles_
  std::vector<Triangle> triangles_;
  TriangleBvh mesh_;
  WindingNumber winding_;
  std::optional<TriangleBvh> surface_;     // where the mesh is not the boundary
  const TriangleBvh* boundary_ = nullptr;  // one of the two
  bool faces_tell_ = true;
  double volume_ = 0;
};

}  // namespace vpm
