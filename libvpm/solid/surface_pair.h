// Integrals over the boundary of what two solids share: the parts of each surface inside the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/solid/crossed_triangle.h"
#include "libvpm/solid/depth_cells.h"
#include "libvpm/solid/solid_surface.h"
#include "libvpm/solid/tree_walk.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

// What is summed over one surface's part inside the other solid, in the first's frame.
struct InnerSurface {
  SurfaceMoments moments;
  // ∫ -depth n dA and ∫ -depth x cross n dA, with the depth below the other's surface; in m^3, m^4.
  Vec3 force, torque;
};

struct SurfacePairSums {
  std::array<InnerSurface, 2> inner;
  std::size_t undecided = 0;  // pairs of triangles whose signs contradict each other
  // Counts for tests and benchmarks.
  std::size_t candidates = 0, crossings = 0, depths = 0;
};

// Scratch of a pair of surfaces at changing poses. Belongs to one thread. The surfaces must outlive
// it.
class SurfacePair {
 public:
  SurfacePair(const SolidSurface& first, const SolidSurface& second);

  // Sums at a pose, which maps the second's frame to the first's. Allocates nothing once its lists
  // have grown. The order of triangles changes no bit of the sums.
  SurfacePairSums run(const Pose& pose, bool with_force);

 private:
  // One of the two surfaces. Stamps are those of the last pose where they equal `stamp_`.
  struct Role {
    const SolidSurface* solid = nullptr;
    const SurfaceTree* tree = nullptr;
    Pose to_first, to_other;                         // from its own frame
    std::uint32_t placed_last = SurfaceTree::kNone;  // triangle
    PlacedTriangle last;
    std::vector<CrossedTriangle> crossed;
    // What cuts the large ones: each entry names the one before of the same triangle.
    std::vector<std::pair<CutSegment, std::uint32_t>> segments;
    std::vector<std::pair<CutPoint, std::uint32_t>> points;
    std::vector<std::uint32_t> crossed_stamp, crossed_place;  // of triangles
    std::vector<std::uint32_t> node_stamp;                    // nodes above a crossed triangle
    std::vector<std::uint32_t> corner_stamp;                  // vertices whose side is known
    std::vector<std::uint8_t> is_inside;                      // of vertices
    // Sums over crossed triangles in the first's frame, over others in its own; in the unit.
    WideMoments cut, whole;
    WideWrench cut_wrench, whole_wrench;
  };

  void start(const Pose& pose, bool with_force);
  PlacedTriangle placed(const Role& role, std::uint32_t triangle) const;
  const PlacedTriangle& placed_again(Role& role, std::uint32_t triangle);
  void meet(std::uint32_t first_triangle, std::uint32_t second_triangle);
  CrossedTriangle& crossed(Role& role, std::uint32_t triangle, const PlacedTriangle& placed);
  bool is_inside(std::size_t role, std::uint32_t vertex);
  void mark_crossed(std::size_t role);
  void add_crossed(std::size_t role);
  void add_whole(std::size_t role);
  void add_whole_triangle(std::size_t role, std::uint32_t triangle);
  void add_force(std::size_t role, std::uint32_t node);
  void add_force_of_triangle(std::size_t role, std::uint32_t triangle);
  bool is_large(const Role& role, std::uint32_t triangle) const;
  void add_cut(std::size_t role, CrossedTriangle& triangle, const CrossedTriangle& other,
               CutSegment segment, std::span<const EdgeCrossing> crossings);
  void add_force_of_cells(std::size_t role, const CrossedTriangle& triangle);
  void add_force_of_cell(std::size_t role, const DepthCell& cell, Vec3 normal);
  void add_force_of_cut(std::size_t role, const CrossedTriangle& triangle);
  Depth depth_at(std::size_t role, Vec3 place);
  void add_cut_force(std::size_t role, const ForceMoments& moments, const Depth& depth, Vec3 place);
  InnerSurface result(const Role& role) const;

  std::array<Role, 2> roles_;
  TreeWalk walk_;
  std::vector<std::uint32_t> pending_, patches_;  // nodes
  DepthCells cells_;
  std::vector<CutSegment> cut_segments_;  // of one triangle
  std::vector<CutPoint> cut_points_;
  std::uint32_t stamp_ = 0;
  double unit_, per_unit_;  // m, a power of two that no coordinate exceeds, and its inverse
  bool with_force_ = false;
  SurfacePairSums sums_;
};

}  // namespace vpm
