// Reads triangle and polygon meshes: OBJ, OFF and PLY (text, or binary of either byte order), STL
// (text, binary), and OM by OpenMesh; 3MF by expat; COLLADA, glTF and FBX by assimp, where it was
// built.
//
// The other parsers are our own for two reasons: coordinates keep double precision, and all
// polygons are kept, also those that no half-edge structure accepts, so that defects can be named.
// OpenMesh's readers round to floats and drop such faces. OM files come from half-edge structures;
// their faces are taken from OpenMesh's reader before it builds its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/solid.h"

namespace vpm {

enum class MeshFormat { obj, off, ply, stl, om, dae, gltf, threemf, fbx };

// Polygons as a file states them, whether or not they bound a solid. Corners are vertex indices,
// all below vertices.size(); coordinates are finite.
struct RawMesh {
  MeshFormat format = MeshFormat::obj;
  std::string name;  // file name, for messages
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> polygon_end;  // end of each polygon in `corners`
  std::size_t dropped_polygons = 0;      // polygons of fewer than three corners
  std::vector<std::string> notes;        // how the file was taken where it could be taken otherwise
  double metres_per_unit = 1;            // of the file's unit, where its format has one
  std::string doubt;  // defect of the file that may have opened the mesh; empty if there is none

  std::size_t polygon_count() const { return polygon_end.size(); }
  void add_triangle(const Triangle& triangle);
  // Ends the polygon of the corners appended last, and drops it if they are fewer than three.
  void end_polygon();
};

// Returns "OBJ", "OFF", ...
const char* name_of(MeshFormat format);
// True for formats whose files list a point once for each triangle or corner that has it.
bool lists_corners(MeshFormat format);
// True for formats whose files say or imply a unit, which is applied.
bool has_unit(MeshFormat format);

// Cuts polygons into triangles whose corners are the polygon's, in the plane along whose normal the
// polygon is seen largest: polygons of four corners by a diagonal, convex ones as a fan, others by
// GLU's tessellator. Throws Error(refused) for polygons that cross themselves, and
// Error(unavailable) for those that need GLU where it was not built.
std::vector<Triangle> triangulate(const RawMesh& mesh);

// Parses a mesh, of formats with nodes that of the node named, with those below it. The format is
// recognised by content, or by the extension of `name` if the content does not tell. Throws
// Error(refused) with the file's name and the line, byte or element for unknown formats, empty or
// truncated files, counts that the file cannot hold (checked before allocating), indices out of
// range, and coordinates that are not finite.
RawMesh parse_mesh(std::span<const std::byte> bytes, const std::string& name,
                   const std::string& node = {});

// Reads a mesh from a file, or from standard input ("-"); throws as parse_mesh does.
RawMesh read_mesh(const std::string& path);

// Returns what is wrong with a mesh so far from the origin that its numbers, floats of 32 bits or
// of six digits, have lost its shape, with lengths in the file's unit: neighbours of the farthest
// one are more than 1/10 000 of the mesh's diagonal apart. Otherwise returns an empty text.
std::string coarse_coordinates(const RawMesh& mesh);

}  // namespace vpm
