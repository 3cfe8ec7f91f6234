// Cuts a polygon of any shape into triangles.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "libvpm/mesh/predicates.h"

namespace vpm {

using CornerTriangle = std::array<std::uint32_t, 3>;

enum class CuttingFault { none, crosses_itself, not_cut, unavailable };

struct PolygonCutting {
  std::vector<CornerTriangle> triangles;  // positions within the ring
  CuttingFault fault = CuttingFault::none;
  Vec2 place;  // place of the crossing
};

// Returns size - 2 triangles whose sides are those of the ring and diagonals. The ring runs
// counter-clockwise, may be concave, and may pass twice through points and edges, as the bridge to
// a hole does; neighbours and their next neighbours are different points. Uses the tessellator of
// GLU; the fault is `unavailable` where that was not built.
PolygonCutting cut_polygon(std::span<const Vec2> ring);

}  // namespace vpm
