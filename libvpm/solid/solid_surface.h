// The surface of a solid, prepared once so that overlaps with others take time of the contact's
// size.
#pragma once

#include <vpm/query_types.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libvpm/model/solid.h"
#include "libvpm/solid/depth_grid.h"
#include "libvpm/solid/face_planes.h"
#include "libvpm/solid/inside_index.h"
#include "libvpm/solid/surface_tree.h"

namespace vpm {

// Immutable. Lives in its own frame: the axes of the mesh about the centre of mass.
class SolidSurface {
 public:
  // Takes the boundary of what a mesh encloses at least once (enclosure_of in
  // mesh/outer_surface.h), welds it, and moves each vertex by at most kJitter of the reach, by a
  // hash of its place: flush, coincident and aligned faces of two solids then are in general
  // position. `with_depth` also prepares forces. Throws Error(refused) for a boundary without
  // volume or triangles.
  explicit SolidSurface(const Solid& boundary, bool with_depth = true);

  static constexpr double kJitter = 0x1p-36;

  double volume() const { return volume_; }           // m^3
  double area() const { return area_; }               // of the surface, m^2
  Vec3 center_of_mass() const { return center_; }     // in the mesh's frame, m
  double reach() const { return reach_; }             // largest distance of a vertex from it, m
  const SurfaceTree& tree() const { return *tree_; }  // of the triangles
  bool has_depth() const { return grid_ || planes_; }
  // Returns the planes of a convex solid with few faces, which tell its depth; else null. Null
  // without has_depth().
  const FacePlanes* face_planes() const { return planes_ ? &*planes_ : nullptr; }
  const std::string& hash() const { return hash_; }  // of the surface; orders pairs
  std::size_t triangles() const { return tree_->triangles().size(); }
  std::size_t bytes() const;

  // True if x, own frame, lies inside.
  bool holds(Vec3 x) const { return inside_view().holds(x); }
  const InsideIndex& inside() const { return *inside_; }
  InsideView inside_view() const { return inside_->view(tree_->vertices(), tree_->triangles()); }
  // Returns the depth of x below the surface: by face_planes(), or else by the grid where it is
  // deep and by the closest point near the surface. Needs has_depth().
  Depth depth(Vec3 x) const;
  // Returns the depth by the grid alone, which errs by a cell or two at creases, and the size of
  // its cells. Needs has_depth() and no face_planes().
  double grid_depth(Vec3 x) const { return grid_->at(x).value; }
  double grid_cell() const { return grid_->cell(); }
  // Returns the depth by the closest point, everywhere. Needs has_depth().
  Depth exact_depth(Vec3 x) const;
  // Returns whether a ball, own frame, is outside, inside, or cut by the surface. Needs
  // has_depth().
  SphereState state_of(Vec3 center, double radius) const;

 private:
  void prepare_grid();

  double volume_ = 0, area_ = 0, reach_ = 0;
  Vec3 center_;
  std::string hash_;
  std::unique_ptr<SurfaceTree> tree_;
  std::unique_ptr<InsideIndex> inside_;
  std::optional<FacePlanes> planes_;  // where they tell the depth there is no grid
  std::optional<DepthGrid> grid_;
};

}  // namespace vpm
