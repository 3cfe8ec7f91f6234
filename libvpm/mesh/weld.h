// Joins vertices that are the same point of the surface.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

struct Weld {
  std::size_t joined_vertices = 0;      // vertices replaced by another
  std::size_t collapsed_triangles = 0;  // triangles dropped because two corners became one
};

// Joins each vertex to the first vertex, in the file's order, within `tolerance` (m) that was not
// joined itself; 0 joins equal positions only. Dropped vertices stay in the list, unused.
Weld weld(const std::vector<Vec3>& vertices, double tolerance, std::vector<Triangle>& triangles);

// Drops triangles that name a vertex twice. Returns how many.
std::size_t drop_collapsed(std::vector<Triangle>& triangles);

// Drops triangles with the vertices of an earlier one. Returns how many.
std::size_t drop_repeated(std::vector<Triangle>& triangles);

// Drops vertices that no triangle uses, keeping the order of others. Returns how many.
std::size_t drop_unused(std::vector<Vec3>& vertices, std::vector<Triangle>& triangles);

}  // namespace vpm
