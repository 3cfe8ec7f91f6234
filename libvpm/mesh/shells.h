// Which way the closed surfaces of a mesh face, and which of them lie within which.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

struct ShellPlace {
  std::size_t depth = 0;  // shells around it: each encloses half of its vertices or more
  bool outward = true;    // as its triangles face
};

// Of each shell, by number (see shells_of in topology.h).
std::vector<ShellPlace> place_shells(const std::vector<Vec3>& vertices,
                                     const std::vector<std::uint32_t>& shell_of_triangle,
                                     std::size_t shell_count,
                                     const std::vector<Triangle>& triangles);

struct ShellOrientation {
  std::size_t turned = 0;    // shells whose triangles were turned over
  std::size_t cavities = 0;  // shells that face inward within another one
};

// Turns shells so that the mesh bounds a solid from outside. Shells that lie within no other one
// face outward. Shells within others: where the file is consistent they are left as they are (but
// turn with the shell around them); where not (`given_consistent` false) they alternate, a shell
// wholly within an odd number of others being a cavity.
ShellOrientation orient_shells(const std::vector<Vec3>& vertices,
                               const std::vector<std::uint32_t>& shell_of_triangle,
                               std::size_t shell_count, bool given_consistent,
                               std::vector<Triangle>& triangles);

}  // namespace vpm
