// Where two triangles of different surfaces cross: the segment that they share and the edges that
// pass through the other, decided by exact signs.
#pragma once

#include <array>
#include <cstdint>

#include "libvpm/core/vec3.h"

namespace vpm {

// Triangle in the frame of both surfaces. `index` orders its vertices as all triangles of its
// surface do.
struct PlacedTriangle {
  std::array<Vec3, 3> corner;
  std::array<std::uint32_t, 3> index;
  Vec3 normal;          // cross product of its edges: twice the area vector
  double longest_edge;  // or more
};

// Point where an edge of one triangle, from corner `edge` to the next, passes through the other.
struct EdgeCrossing {
  int edge = 0;
  int sign = 0;  // +1: the edge goes into the other solid, -1: it leaves that
  // The same bits for all triangles that share the edge, and for both roles.
  Vec3 place;
};

enum class Meeting {
  apart,
  crossing,
  // Signs are zero or contradict each other: the surfaces are not in general position.
  undecided
};

struct TriangleCrossing {
  // Ends of the common segment, in the direction in which it bounds the part of the first triangle
  // inside the other solid, counter-clockwise seen from outside.
  Vec3 start, end;
  // Crossings of edges of the first and of the second; one of the two ends each.
  std::array<EdgeCrossing, 2> of_first, of_second;
  int first_count = 0, second_count = 0;
};

// Finds how two triangles meet whose boxes overlap, and fills `crossing` where they cross.
Meeting cross_triangles(const PlacedTriangle& a, const PlacedTriangle& b,
                        TriangleCrossing& crossing);

}  // namespace vpm
