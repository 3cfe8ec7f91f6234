// Turns a mesh file into a solid: diagnoses the mesh, repairs what needs no guessing, and refuses
// the rest by name and place.
#pragma once

#include <vpm/solid.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/mesh/holes.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/mesh/outer_surface.h"
#include "libvpm/mesh/voxel_repair.h"
#include "libvpm/mesh/work_limit.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Default of SolidOptions::weld: CAD exporters write the same coordinate as 0 and as -2.7e-16.
inline constexpr double kDefaultWeld = 1e-9;
// Default of SolidOptions::max_hole for a flood, relative to the longest side.
inline constexpr double kDefaultMaxHole = 1.0 / 16;
// Larger tolerances are refused, since they would destroy parts of the mesh.
inline constexpr double kLargestWeld = 0.1;

// Facts of a mesh; lengths, areas and volumes in metres after scaling.
struct MeshFacts {
  MeshFormat format = MeshFormat::obj;
  std::size_t vertices = 0, triangles = 0;  // counts of the solid
  std::size_t shells = 0, cavities = 0;
  // vertices - edges + triangles; 2 - 2 genus for one shell.
  std::int64_t euler = 0;
  double area = 0;    // area of all triangles, also in the solid's interior
  double volume = 0;  // volume enclosed at least once
  Vec3 low, high;
  std::size_t inner_shells = 0;  // dropped, since solid was on both sides
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
  std::vector<std::string> notes;     // repairs that were made
  std::vector<std::string> warnings;  // oddities that were accepted
};

// Checks, repairs and orients a mesh. Throws Error(refused) for meshes that are empty; open,
// non-manifold or one-sided beyond the requested repair (naming a corner of the largest hole);
// without volume; of an extent outside 1e-30 to 1e30 m; or that meet or nest in more places than
// WorkLimit allows. Throws Error(invalid_argument) for options out of range.
CheckedSolid make_solid(const RawMesh& mesh, const SolidOptions& options = {},
                        const MeshProgress& progress = {});

}  // namespace vpm
