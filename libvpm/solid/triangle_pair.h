// Where two triangles of different surfaces cross: the segment that they share and the edges that
// pass through the other, decided by exact signs.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/vec3.h"

namespace vpm {

// Names a triangle of each of two surfaces that may cross each other, by its place in a list of its
// surface's.
struct CandidatePair {
  std::uint32_t a, b;
};

// Triangle in the frame of both surfaces. `index` orders its vertices as all triangles of its
// surface do.
struct PlacedTriangle {
  std::array<Vec3, 3> corner;
  Vec3 normal;          // cross product of its edges: twice the area vector
  double longest_edge;  // or more
  std::array<std::uint32_t, 3> index;
};

// What doubles tell of a pair of triangles a, b: heights of corners over the other's plane, times
// twice its area, and the signs of these and of the volumes of pairs of edges, in bits. Bit k
// stands for a's corner k over b's plane, 3 + k for b's corner over a's, and 6 + 3 i + j for the
// edges i of a and j of b. Of a sign that rounding leaves open neither bit is set.
struct PairSigns {
  std::array<double, 3> above_b, above_a;
  unsigned above, below;
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

// Keeps those pairs of two lists of triangles, whose boxes must overlap, that doubles do not tell
// to be apart, in their order, and fills `signs` with what doubles tell of each of these. Nothing
// that follows from signs depends on how many doubles tell: exact ones decide what they leave open.
void drop_apart(std::span<const PlacedTriangle> a, std::span<const PlacedTriangle> b,
                std::vector<CandidatePair>& pairs, std::vector<PairSigns>& signs);

// Returns how two triangles meet, and fills `crossing` where they cross. `signs` are what
// drop_apart() told of the two.
Meeting cross_triangles(const PlacedTriangle& a, const PlacedTriangle& b, const PairSigns& signs,
                        TriangleCrossing& crossing);

}  // namespace vpm
