// Upper bounds of the clearance over cells: cubes of an octree within a solid.
//
// The clearance d(x) = min(distance to the mesh, min_i |x - c_i| - r_i) is 1-Lipschitz, so
// d(centre) + half diagonal bounds it over a cell. Three bounds are tighter: the distance of the
// cell's farthest point from one obstacle, the greatest clearance that all obstacles near the cell
// leave together, and what fits into a thin part of the solid or a narrow gap beside a sphere.
#pragma once

#include <cstdint>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/sphere.h"
#include "libvpm/packing/block_tree.h"
#include "libvpm/packing/linear_programme.h"
#include "libvpm/packing/solid_distance.h"

namespace vpm {

// More than what rounding changes in distances within the unit cube, and less than any room.
constexpr double kDistanceRounding = 1e-12;

// True if a sphere is for sure no nearer to a point than `distance`: most are told without a root.
// `from` leads from the sphere's centre to the point.
inline bool is_beyond(Vec3 from, double radius, double distance) {
  const double reach = radius + distance + kDistanceRounding;
  return squared_norm(from) > reach * reach;
}

// All spheres, by index, that come nearer than `distance` to some cube.
struct ListedSpheres {
  double distance = 0;
  std::vector<std::uint32_t> spheres = {};
};

class CellRoom {
 public:
  enum class Side : std::uint8_t { unknown, inside, outside };
  struct Cell {
    float x, y, z;  // centre; exact, multiples of 2^-24
    // Upper bound on the clearance of the centre, if that is inside.
    float d;
    // Lower bound on the distance of the centre from the mesh.
    float mesh;
    // Upper bound on spheres centred in the cell.
    float bound;
    std::uint8_t level;  // edge length 2^-level
    Side side;           // side of the centre
    Side parent;         // side of the parent cell's centre
    bool measured;       // d is exact, up to the distance of the listed spheres
    // `triangle` is nearest to this centre, not to a parent's.
    bool exact;
    bool thick;  // holds no thin part (thin_part.h)
    std::uint32_t triangle;
    Vec3 center() const { return {x, y, z}; }
  };

  // Keeps references to the solid and to `spheres`, which may grow. Cells whose bound is not above
  // `smallest` are dropped. All coordinates are in the unit frame of `solid`. Different cells may
  // be bounded in parallel.
  CellRoom(const SolidDistance& solid, const std::vector<Sphere>& spheres, float smallest)
      : solid_(solid), spheres_(spheres), smallest_(smallest) {}

  // Returns the unit cube, measured; `listed` is empty.
  Cell root(const ListedSpheres& listed) const;

  // Finds the nearest triangle, for cells whose estimate does not exclude a sphere.
  void measure(Cell& cell) const;

  // Bounds a cell before it is cut: a cell much larger than the part or gap is thin needs no
  // cutting until spheres of that size are sought.
  void bound_narrow_part(Cell& cell, const ListedSpheres& listed) const;

  // Bounds the clearance over a cell by all nearby obstacles together. `planes` is memory that is
  // used again.
  void bound_jointly(Cell& cell, const ListedSpheres& listed,
                     std::vector<LinearBound>& planes) const;

  // Finds the side of a measured cell's centre.
  void find_side(Cell& cell, const ListedSpheres& listed) const;

  // Appends the eighths of a cell that have room.
  void split(const Cell& cell, const ListedSpheres& listed, std::vector<Cell>& parts) const;

  // Takes a new sphere from the room of a cell.
  static void take_from(Cell& cell, const Sphere& sphere);

 private:
  SurfacePoint nearest_on_mesh(const Cell& cell, double within) const;
  void estimate(Cell& cell, const ListedSpheres& listed) const;
  double joint_bound(Cell& cell, const ListedSpheres& listed,
                     std::vector<LinearBound>& planes) const;
  Side side_of(const Cell& cell, const ListedSpheres& listed) const;
  static void settle(Cell& cell, Side side);
  static double farthest(const Cell& cell, const Sphere& from);

  const SolidDistance& solid_;
  const std::vector<Sphere>& spheres_;
  float smallest_;
};

}  // namespace vpm
