// Joins vertices that are one point of the surface.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

struct Weld {
  std::size_t joined_vertices = 0;      // vertices that gave way to another
  std::size_t collapsed_triangles = 0;  // dropped since two of their corners became one
};

// A vertex is joined to the first vertex (in the order of the file) within `tolerance` (metres)
// that was not joined itself; 0 joins equal positions only. Dropped vertices stay in the list,
// unused.
Weld weld(const std::vector<Vec3>& vertices, double tolerance, std::vector<Triangle>& triangles);

// Drops triangles that name a vertex twice; returns how many.
std::size_t drop_collapsed(std::vector<Triangle>& triangles);

// Drops triangles that name the vertices of an earlier one; returns how many.
std::size_t drop_repeated(std::vector<Triangle>& triangles);

// Drops vertices that no triangle uses, keeping the order of the others; returns how many.
std::size_t drop_unused(std::vector<Vec3>& vertices, std::vector<Triangle>& triangles);

}  // namespace vpm
