// Reads triangle and polygon meshes: OBJ, OFF and PLY (text, binary of either byte order), STL
// (text, binary), and OM by OpenMesh.
//
// The other parsers are our own for two reasons: coordinates keep their double precision, and every
// polygon is kept, also those that no half-edge structure takes, so that a defect can be named.
// OpenMesh's readers round to floats and drop such faces; for OM, which only half-edge structures
// write, faces are taken from its reader before that.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "libvpm/mesh/raw_mesh.h"

namespace vpm {

// The format is told by content, and by the extension of `name` where the content is silent.
// Throws Error(refused) with the file's name and the line, the byte or the element for: unknown
// formats, empty and truncated files, counts in a header that the file cannot hold (before any
// memory is taken), indices out of range, coordinates that are not finite.
RawMesh parse_mesh(std::span<const std::byte> bytes, const std::string& name);

// The same for a file; "-" is standard input.
RawMesh read_mesh(const std::string& path);

}  // namespace vpm
