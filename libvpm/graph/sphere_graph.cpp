#include "libvpm/graph/sphere_graph.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <tuple>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

// Most neighbours in a graph, both directions of each edge counted: far more than a packing has for
// an epsilon of the size of its gaps.
constexpr std::uint64_t kMaxNeighbors = std::uint64_t{1} << 28;
constexpr std::size_t kGrain = 64;

std::vector<std::uint32_t> neighbors_of(const SphereBvh& bvh, std::uint32_t i, double epsilon) {
  const std::span<const Sphere> spheres = bvh.spheres();
  const double search_radius = spheres[i].radius + epsilon;
  std::vector<std::uint32_t> found;
  bvh.walk(
      spheres[i].center, [&](std::uint32_t, double bound) { return bound <= search_radius; },
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
    for (std::size_t i = begin; i < end && total <= kMaxNeighbors; ++i) {
      rows[i] = neighbors_of(bvh, static_cast<std::uint32_t>(i), epsilon);
      total += rows[i].size();
    }
  });
  if (total > kMaxNeighbors) {
    refuse("epsilon joins more than " + std::to_string(kMaxNeighbors / 2) + " pairs of spheres", {},
           "choose one of the size of the gaps between them");
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

// What follows is Boruvka's algorithm: in each round every component takes its shortest edge to
// another one.

namespace {

// Label of a node whose spheres lie in several components.
constexpr std::uint32_t kMixed = ~std::uint32_t{0};

// Totally ordered edge: no two pairs are equal, so shortest edges never close a cycle.
struct Edge {
  double gap = std::numeric_limits<double>::infinity();
  std::uint32_t low = kMixed, high = kMixed;
  bool operator<(const Edge& other) const {
    return std::tie(gap, low, high) < std::tie(other.gap, other.low, other.high);
  }
};

// Returns for each node the component of all its spheres, or kMixed, so that a search skips its own
// component at once.
std::vector<std::uint32_t> label_nodes(const SphereBvh& bvh,
                                       const std::vector<std::uint32_t>& component) {
  const auto nodes = bvh.nodes();
  std::vector<std::uint32_t> label(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    if (nodes[n].right != 0) {
      label[n] = label[n + 1] == label[nodes[n].right] ? label[n + 1] : kMixed;
      continue;
    }
    label[n] = component[bvh.order()[nodes[n].begin]];
    for (std::uint32_t k = nodes[n].begin; k < nodes[n].end; ++k) {
      if (component[bvh.order()[k]] != label[n]) label[n] = kMixed;
    }
  }
  return label;
}

Edge shortest_to_other(const SphereBvh& bvh, const std::vector<std::uint32_t>& component,
                       const std::vector<std::uint32_t>& label, std::uint32_t i) {
  const std::span<const Sphere> spheres = bvh.spheres();
  Edge best;
  bvh.walk(
      spheres[i].center,
      [&](std::uint32_t node, double bound) {
        return label[node] != component[i] && bound - spheres[i].radius <= best.gap;
      },
      [&](std::uint32_t j) {
        if (component[j] == component[i]) return;
        best = std::min(best,
                        Edge{surface_gap(spheres[i], spheres[j]), std::min(i, j), std::max(i, j)});
      });
  return best;
}

class DisjointSets {
 public:
  explicit DisjointSets(std::uint32_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  bool join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace

std::vector<SpherePair> shortest_bridges(const SphereBvh& bvh, const SphereGraph& graph) {
  const std::size_t count = bvh.spheres().size();
  std::vector<std::uint32_t> component;
  std::uint32_t components = connected_components(graph, component);
  DisjointSets sets(components);
  std::vector<std::uint32_t> first = component;  // components before any bridge
  std::vector<SpherePair> bridges;
  while (components > 1) {
    const std::vector<std::uint32_t> label = label_nodes(bvh, component);
    std::vector<Edge> nearest(count);
    parallel_for(count, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        nearest[i] = shortest_to_other(bvh, component, label, static_cast<std::uint32_t>(i));
      }
    });
    std::vector<Edge> shortest(count);  // indexed by component
    for (std::size_t i = 0; i < count; ++i) {
      shortest[component[i]] = std::min(shortest[component[i]], nearest[i]);
    }
    for (const Edge& edge : shortest) {
      if (edge.low == kMixed || !sets.join(first[edge.low], first[edge.high])) continue;
      bridges.push_back({edge.low, edge.high});
      --components;
    }
    for (std::size_t i = 0; i < count; ++i) component[i] = sets.find(first[i]);
  }
  return bridges;
}

}  // namespace vpm
