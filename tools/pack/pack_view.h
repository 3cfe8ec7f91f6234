// vpm-pack --view: a packing in its solid, or what is wrong with a mesh.
#pragma once

#include <string>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/packing/packer.h"

namespace vpm::tools {

// Writes a page with the mesh, the defects at their places, how to mend them and `why` it was
// refused.
void write_defects_view(const std::string& path, const RawMesh& mesh, const SolidOptions& options,
                        const std::string& why, const std::string& cure);

// Writes a page with the solid, its spheres largest first, what they do not cover, and the coverage
// over their number. `mesh` is the mesh's name.
void write_packing_view(const std::string& path, const std::string& mesh,
                        const CheckedSolid& checked, const PackResult& packed);

}  // namespace vpm::tools
