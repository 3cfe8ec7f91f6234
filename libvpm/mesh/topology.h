// Connectivity of triangles: neighbours over edges, and defects that keep them from bounding a
// solid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

struct Edge {
  std::uint32_t a = 0, b = 0;  // vertices, a < b
};

// Side of a triangle from corner k to k + 1.
struct TriangleSide {
  std::uint32_t low = 0, high = 0;  // vertices
  std::uint32_t triangle = 0, corner = 0;
  bool forward = false;  // runs from low to high
};

// Returns the sides of all triangles, those of one edge together, by their vertices, then by
// triangle and corner.
std::vector<TriangleSide> sorted_sides(std::size_t vertex_count,
                                       const std::vector<Triangle>& triangles);

// Calls visit(sides) for each edge with all its sides, of those that sorted_sides() returns.
template <class Visit>
void for_edges(std::span<const TriangleSide> sorted, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
    const TriangleSide& first = sorted[begin];
    while (end < sorted.size() && sorted[end].low == first.low && sorted[end].high == first.high)
      ++end;
    visit(sorted.subspan(begin, end - begin));
  }
}

// Returns the number of triangles with the vertices of an earlier one.
std::size_t count_duplicates(std::vector<Triangle> triangles);

struct Topology {
  std::vector<Edge> boundary;          // edges of one triangle
  std::vector<Edge> non_manifold;      // edges of more than two triangles
  std::vector<Edge> conflicting;       // edges that both triangles run in the same direction
  std::vector<std::uint32_t> pinched;  // vertices where several fans of triangles meet
  // Triangle beyond the edge from corner k to k + 1, or kNone.
  std::vector<std::array<std::uint32_t, 3>> neighbor;
  static constexpr std::uint32_t kNone = 0xffffffff;
};

// Returns the connectivity; all lists ascend. Each triangle must have three different vertices.
Topology topology_of(std::size_t vertex_count, const std::vector<Triangle>& triangles);

// Returns the shell number of each triangle; shells are connected surfaces, numbered by their first
// triangles. Stores their number in `count`.
std::vector<std::uint32_t> shells_of(const Topology& topology, std::size_t& count);

// Turns triangles so that neighbours agree with the first triangle of their shell. Returns how many
// were turned, or kNotOrientable, changing nothing, for a one-sided surface. `topology` is not
// updated: turned triangles have other sides.
inline constexpr std::size_t kNotOrientable = static_cast<std::size_t>(-1);
std::size_t orient_consistently(const Topology& topology, std::vector<Triangle>& triangles);

}  // namespace vpm
