// Sphere graph: edges between spheres that nearly touch, and bridges that make it connected.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/graph/sphere_bvh.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the distance between the surfaces of two spheres, negative if they overlap; the same bits
// in either order.
inline double surface_gap(const Sphere& a, const Sphere& b) {
  return norm(a.center - b.center) - (a.radius + b.radius);
}

using SpherePair = std::pair<std::uint32_t, std::uint32_t>;  // first < second

// Returns the graph with an edge wherever the gap is < epsilon. Throws Error(refused) if that joins
// more pairs than can be stored.
SphereGraph epsilon_edges(const SphereBvh& bvh, double epsilon);

// Returns the number of connected components and stores that of each sphere; components are
// numbered by their lowest spheres.
std::uint32_t connected_components(const SphereGraph& graph, std::vector<std::uint32_t>& component);

// Returns the shortest edges that join all components into one: a minimum spanning forest over
// components, ordered by gap, then by sphere indices. Empty if the graph is connected.
std::vector<SpherePair> shortest_bridges(const SphereBvh& bvh, const SphereGraph& graph);

SphereGraph with_edges(const SphereGraph& graph, const std::vector<SpherePair>& added);

}  // namespace vpm
