// Distance to the boundary of a solid in the packer's frame. Mesh parts in the solid's interior are
// no boundary.
//
// The frame centres the solid's bounding box in the unit cube and scales by a power of two, so that
// a solid 2^k times as large gives the same numbers to the bit.
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
  Vec3 center;          // centre of the solid's bounding box
  double scale = 1;     // metres per unit, a power of two
  double longest = 1;   // longest side of the box in units, from 1/2 to 1
  double rounding = 0;  // m; bound on rounding of the frame and of distances in it
  Vec3 to_unit(Vec3 p) const { return (p - center) / scale + Vec3{0.5, 0.5, 0.5}; }
  Vec3 to_solid(Vec3 p) const { return center + scale * (p - Vec3{0.5, 0.5, 0.5}); }
  // Maps a sphere to metres, shrunk so that rounding makes no overlap.
  Sphere to_solid(const Sphere& s) const;
};

class SolidDistance {
 public:
  // `enclosure` is that of the solid, or null to compute it. Throws Error(refused) for a solid
  // without triangles, extent or finite coordinates.
  explicit SolidDistance(const Solid& solid, const Enclosure* enclosure = nullptr);
  SolidDistance(const SolidDistance&) = delete;
  SolidDistance& operator=(const SolidDistance&) = delete;

  const UnitFrame& frame() const { return frame_; }
  double volume() const { return volume_; }  // m^3
  SurfacePoint closest(Vec3 x, double within) const { return boundary_->closest(x, within); }
  Vec3 closest_on(std::uint32_t triangle, Vec3 x) const;
  // True if the disk of this radius about a point of the triangle lies in the triangle.
  bool holds_disk(std::uint32_t triangle, Vec3 point, double radius) const;
  // Finds triangles as TriangleBvh::around does; corners() takes their numbers.
  std::size_t around(Vec3 x, double half, std::span<std::uint32_t> found) const {
    return boundary_->around(x, half, found);
  }
  const TriangleBvh::Corners& corners(std::uint32_t found) const {
    return boundary_->corners()[found];
  }
  bool inside(Vec3 x) const { return winding_.inside(x); }
  // Returns inside(x) for a point near the mesh, mostly from the nearest triangle.
  bool is_inside_near(Vec3 x) const;
  // Returns inside(x) from the triangle nearest to x, at almost no cost. Empty if x is nearest to
  // an edge or too near to decide.
  std::optional<bool> inside_of_face(std::uint32_t nearest, Vec3 x) const;

 private:
  UnitFrame frame_;
  // Boundary of the solid.
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  TriangleBvh mesh_;
  WindingNumber winding_;
  // BVH of the boundary, where the mesh is not the boundary.
  std::optional<TriangleBvh> surface_;
  const TriangleBvh* boundary_ = nullptr;  // points to mesh_ or surface_
  bool faces_tell_ = true;
  double volume_ = 0;
};

}  // namespace vpm
