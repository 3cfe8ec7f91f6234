// From what a file says to a solid: diagnoses a mesh, mends what can be mended without guessing,
// refuses the rest by name and place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/mesh/fill_holes.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/mesh/raw_mesh.h"
#include "libvpm/mesh/voxel_repair.h"
#include "libvpm/model/solid.h"

namespace vpm {

enum class Repair {
  none,   // refuse what is not a solid
  holes,  // drop repeated triangles; fill holes that are planar or small (fill_holes.h)
  voxel,  // a new surface about the voxels that the mesh encloses (voxel_repair.h)
  flood,  // the same about those that a ball of max_hole cannot reach from outside
};

struct SolidOptions {
  double scale = 1;  // the file's unit in metres
  // Vertices nearer than this share of the box's diagonal are one. Unset: kDefaultWeld for STL;
  // for formats with indices only if the mesh is open as its indices have it and closed after.
  std::optional<double> weld = std::nullopt;
  Repair repair = Repair::none;
  int repair_voxels = kRepairVoxels;  // along the longest side, for Repair::voxel and flood
  // m: wider holes (width_of in boundary_loops.h) are refused. Unset: none with Repair::voxel,
  // kDefaultMaxHole with Repair::flood.
  std::optional<double> max_hole = std::nullopt;
};

// CAD exporters write one coordinate as 0 here and as -2.7e-16 there.
inline constexpr double kDefaultWeld = 1e-9;
// Of the longest side.
inline constexpr double kDefaultMaxHole = 1.0 / 16;
// A larger tolerance would eat parts of the mesh instead of joining them.
inline constexpr double kLargestWeld = 0.1;

// Lengths, areas and volumes after scaling: metres.
struct MeshFacts {
  MeshFormat format = MeshFormat::obj;
  std::size_t vertices = 0, triangles = 0;  // of the solid
  std::size_t shells = 0, cavities = 0;
  std::int64_t euler = 0;  // vertices - edges + triangles: 2 - 2 genus for one shell
  double area = 0;         // of the triangles, also of parts that lie inside
  double volume = 0;       // of what is enclosed at least once
  Vec3 low, high;
  std::size_t inner_shells = 0;  // dropped: they had solid on both sides
  std::size_t joined_vertices = 0;
  std::size_t unused_vertices = 0;
  std::size_t collapsed_triangles = 0;
  std::size_t turned_triangles = 0;
  std::size_t zero_area_triangles = 0;
  std::size_t self_intersections = 0;  // pairs of triangles
  std::size_t repeated_triangles = 0;  // dropped by Repair::holes
  std::vector<FilledHole> filled_holes;
  std::optional<VoxelRepair> voxel_repair;
};

struct CheckedSolid {
  Solid solid;
  Enclosure enclosure;
  MeshFacts facts;
  std::vector<std::string> notes;     // what was mended
  std::vector<std::string> warnings;  // what was accepted though it may surprise
};

// Throws Error(refused) for meshes that are empty, that are open, non-manifold or one-sided beyond
// the repair that was asked for (naming the rims of holes by their first vertices), that enclose no
// volume, or whose extent leaves 1e-30 .. 1e30 m; Error(usage) for options out of range.
CheckedSolid make_solid(const RawMesh& mesh, const SolidOptions& options = {});

}  // namespace vpm
