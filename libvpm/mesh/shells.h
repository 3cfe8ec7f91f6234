// Orientation and nesting of the closed surfaces of a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/mesh/work_limit.h"
#include "libvpm/model/solid.h"

namespace vpm {

struct ShellPlace {
  // Number of shells around it, each of which encloses at least half of its vertices.
  std::size_t depth = 0;
  bool outward = true;  // as its triangles face
};

// Returns the place of each shell, numbered as by shells_of in topology.h. Throws TooMuchWork
// beyond WorkLimit.
std::vector<ShellPlace> place_shells(const std::vector<Vec3>& vertices,
                                     const std::vector<std::uint32_t>& shell_of_triangle,
                                     std::size_t shell_count,
                                     const std::vector<Triangle>& triangles);

struct ShellOrientation {
  std::size_t turned = 0;    // shells whose triangles were turned over
  std::size_t cavities = 0;  // shells that face inward within another one
};

// Turns shells so that the mesh bounds a solid. Outermost shells come to face outward. If the file
// is consistent, shells within others keep their orientation relative to the shell around them; if
// not (`given_consistent` is false), they alternate: a shell wholly within an odd number of others
// is a cavity. Throws TooMuchWork beyond WorkLimit, as above.
ShellOrientation orient_shells(const std::vector<Vec3>& vertices,
                               const std::vector<std::uint32_t>& shell_of_triangle,
                               std::size_t shell_count, bool given_consistent,
                               std::vector<Triangle>& triangles, const MeshProgress& progress = {});

}  // namespace vpm
