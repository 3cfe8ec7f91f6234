// Says how a mesh that bounds no solid can be mended, by trying it.
#pragma once

#include <functional>
#include <string>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/topology.h"

namespace vpm {

// A mesh that was refused, with what is known of it.
struct DefectiveMesh {
  const Solid& solid;  // the file's unit
  const Topology& topology;
  const SolidOptions& options;  // with which it was refused
  double diagonal = 0;          // of its box, the file's unit
  double scale = 1;             // metres of the file's unit
};

// Makes the solid of the same mesh with other options, and gives no advice. Throws Error where they
// do not mend it.
using MakeSolid = std::function<CheckedSolid(const SolidOptions& options)>;

// Returns what makes the mesh pass, found by trying; for a mesh that takes too long to try, what
// may do so.
std::string repair_advice(const DefectiveMesh& mesh, const MakeSolid& make);

}  // namespace vpm
