// Pairs of triangles of one mesh that intersect beyond the vertices and edges they share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/mesh/work_limit.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Two triangles, the lower index first.
using TrianglePair = std::pair<std::uint32_t, std::uint32_t>;

// Returns the pairs in ascending order, found by exact predicates; triangles without area are left
// out. Throws TooMuchWork beyond WorkLimit.
std::vector<TrianglePair> find_self_intersections(const std::vector<Vec3>& vertices,
                                                  const std::vector<Triangle>& triangles);

// Returns those of the pairs that find_contacts found which intersect: equals the above.
std::vector<TrianglePair> intersecting(const std::vector<TrianglePair>& contacts,
                                       const std::vector<Vec3>& vertices,
                                       const std::vector<Triangle>& triangles);

// Returns the distance, m, below which parts touch: those made to meet are off by rounding.
double contact_tolerance(const std::vector<Vec3>& vertices);

// Returns self-intersections, and pairs that overlap in a common plane within the tolerance, in
// ascending order. Throws TooMuchWork beyond WorkLimit. Adds the work it did to `work`, if given.
std::vector<TrianglePair> find_contacts(const std::vector<Vec3>& vertices,
                                        const std::vector<Triangle>& triangles,
                                        const MeshProgress& progress = {},
                                        std::uint64_t* work = nullptr);

}  // namespace vpm
