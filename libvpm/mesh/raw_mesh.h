// Mesh as its file states it, whether or not it bounds a solid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/model/solid.h"

namespace vpm {

enum class MeshFormat { obj, off, ply, stl, om };

// Polygons of a file. Corners are vertex indices, all below vertices.size(); coordinates are
// finite.
struct RawMesh {
  MeshFormat format = MeshFormat::obj;
  std::string name;  // file name, for messages
  std::vector<Vec3> vertices;
  std::vector<std::uint32_t> corners;
  std::vector<std::size_t> polygon_end;  // end of each polygon in `corners`

  std::size_t polygon_count() const { return polygon_end.size(); }
};

// Returns "OBJ", "OFF", ...
const char* name_of(MeshFormat format);

// Cuts polygons into triangles by ear clipping in their own plane; polygons without a plane, or
// that cross themselves, become fans. Throws Error(refused) for more than 4096 corners.
std::vector<Triangle> triangulate(const RawMesh& mesh);

}  // namespace vpm
