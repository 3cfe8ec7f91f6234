// How triangles hang together: neighbours over edges, and what keeps them from bounding a solid.
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
  std::vector<Edge> conflicting;        // edges that both their triangles run the same way
  std::vector<std::uint32_t> pinched;   // vertices where several fans of triangles meet
  std::size_t duplicate_triangles = 0;  // with the same three vertices as an earlier one
  std::vector<std::array<std::uint32_t, 3>> neighbor;  // triangle beyond edge k -> k+1, or kNone
  static constexpr std::uint32_t kNone = 0xffffffff;
};

// Every list ascends. Triangles must name three different vertices each.
Topology topology_of(std::size_t vertex_count, const std::vector<Triangle>& triangles);

// The connected surfaces: shell number of each triangle, numbered in the order of their first
// triangles. `count` receives how many there are.
std::vector<std::uint32_t> shells_of(const Topology& topology, std::size_t& count);

// Turns triangles so that neighbours agree with the first triangle of their shell; returns how many
// were turned, or kNotOrientable for a one-sided surface, which is left as it is. `topology` stays
// that of the triangles as they were: a turned one has other sides.
inline constexpr std::size_t kNotOrientable = static_cast<std::size_t>(-1);
std::size_t orient_consistently(const Topology& topology, std::vector<Triangle>& triangles);

}  // namespace vpm
