// Connectivity of triangles: neighbours over edges, and defects that keep them from bounding a
// solid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/model/solid.h"

namespace vpm {

struct Edge {
  std::uint32_t a = 0, b = 0;  // vertices, a < b
};

struct Topology {
  std::vector<Edge> boundary;           // edges of one triangle
  std::vector<Edge> non_manifold;       // edges of more than two triangles
  std::vector<Edge> conflicting;        // edges that both triangles run in the same direction
  std::vector<std::uint32_t> pinched;   // vertices where several fans of triangles meet
  std::size_t duplicate_triangles = 0;  // triangles with the vertices of an earlier one
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
