#include "libvpm/graph/edges.h"

#include <algorithm>
#include <atomic>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

// Limits the graph's size, counting both directions of edges; far more than a packing has for an
// epsilon of the size of its gaps.
constexpr std::uint64_t kMostNeighbors = std::uint64_t{1} << 28;
constexpr std::size_t kGrain = 64;

std::vector<std::uint32_t> neighbors_of(const SphereBvh& bvh, std::uint32_t i, double epsilon) {
  const std::span<const Sphere> spheres = bvh.spheres();
  const double reach = spheres[i].radius + epsilon;
  std::vector<std::uint32_t> found;
  bvh.walk(
      spheres[i].center, [&](std::uint32_t, double bound) { return bound <= reach; },
      [&](std::uint32_t j) {
        if (j != i && surface_gap(spheres[i], spheres[j]) < epsilon) found.push_back(j);
      });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

SphereGraph epsilon_edges(const SphereBvh& bvh, double epsilon) {
  const std::size_t count = bvh.spheres().size();
  std::vector<std::vector<std::uint32_t>> rows(count);
  std::atomic<std::uint64_t> total = 0;
  parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && total <= kMostNeighbors; ++i) {
      rows[i] = neighbors_of(bvh, static_cast<std::uint32_t>(i), epsilon);
      total += rows[i].size();
    }
  });
  if (total > kMostNeighbors) {
    refuse("epsilon joins more than " + std::to_string(kMostNeighbors / 2) + " pairs of spheres",
           {}, "choose one of the size of the gaps between them");
  }
  SphereGraph graph;
  graph.begin.reserve(count + 1);
  graph.neighbors.reserve(total);
  for (const auto& row : rows) {
    graph.begin.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
    graph.neighbors.insert(graph.neighbors.end(), row.begin(), row.end());
  }
  graph.begin.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
  return graph;
}

std::uint32_t connected_components(const SphereGraph& graph,
                                   std::vector<std::uint32_t>& component) {
  const std::uint32_t count = static_cast<std::uint32_t>(graph.begin.size() - 1);
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  component.assign(count, kNone);
  std::uint32_t components = 0;
  std::vector<std::uint32_t> open;
  for (std::uint32_t root = 0; root < count; ++root) {
    if (component[root] != kNone) continue;
    component[root] = components;
    open.push_back(root);
    while (!open.empty()) {
      const std::uint32_t i = open.back();
      open.pop_back();
      for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k) {
        const std::uint32_t j = graph.neighbors[k];
        if (component[j] != kNone) continue;
        component[j] = components;
        open.push_back(j);
      }
    }
    ++components;
  }
  return components;
}

SphereGraph with_edges(const SphereGraph& graph, const std::vector<SpherePair>& added) {
  std::vector<SpherePair> directed;
  for (const auto& [i, j] : added) {
    directed.push_back({i, j});
    directed.push_back({j, i});
  }
  std::sort(directed.begin(), directed.end());
  SphereGraph joined;
  auto next = directed.begin();
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    joined.begin.push_back(static_cast<std::uint32_t>(joined.neighbors.size()));
    const auto row = static_cast<std::ptrdiff_t>(joined.neighbors.size());
    joined.neighbors.insert(joined.neighbors.end(), graph.neighbors.begin() + graph.begin[i],
                            graph.neighbors.begin() + graph.begin[i + 1]);
    for (; next != directed.end() && next->first == i; ++next) {
      joined.neighbors.push_back(next->second);
    }
    std::sort(joined.neighbors.begin() + row, joined.neighbors.end());
  }
  joined.begin.push_back(static_cast<std::uint32_t>(joined.neighbors.size()));
  return joined;
}

}  // namespace vpm
