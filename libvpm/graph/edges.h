// The sphere graph: edges between spheres that nearly touch, and the bridges that make it
// connected.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/graph/sphere_bvh.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Distance between the surfaces of two spheres; the same bits whichever comes first.
inline double surface_gap(const Sphere& a, const Sphere& b) {
  return norm(a.center - b.center) - (a.radius + b.radius);
}

using SpherePair = std::pair<std::uint32_t, std::uint32_t>;  // first < second

// An edge wherever the gap is < epsilon. Refuses an epsilon that joins more pairs than can be
// stored.
SphereGraph epsilon_edges(const SphereBvh& bvh, double epsilon);

// The connected component of every sphere, numbered by their lowest spheres; returns their count.
std::uint32_t connected_components(const SphereGraph& graph, std::vector<std::uint32_t>& component);

// The shortest edges that join the components into one (a minimum spanning forest over components,
// gaps compared first and sphere indices after). Empty where the graph is connected.
std::vector<SpherePair> shortest_bridges(const SphereBvh& bvh, const SphereGraph& graph);

SphereGraph with_edges(const SphereGraph& graph, const std::vector<SpherePair>& added);

}  // namespace vpm
