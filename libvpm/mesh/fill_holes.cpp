#include "libvpm/mesh/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

namespace vpm {
namespace {

constexpr std::size_t kMostEdges = 1000;  // time grows with their cube
// Weight of short edges, which decides among triangulations of equal area, as all are in a plane.
constexpr double kShortEdges = 1e-6;

FilledHole describe(const std::vector<Vec3>& rim) {
  FilledHole hole;
  hole.edges = rim.size();
  Vec3 low = rim[0], high = rim[0], normal;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const Vec3 p = rim[k];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    hole.center += (p - rim[0]) / static_cast<double>(rim.size());
    normal += cross(p - rim[0], rim[(k + 1) % rim.size()] - rim[0]);
  }
  hole.center += rim[0];
  hole.size = norm(high - low);
  normal = normalized_or_zero(normal);
  hole.planar = std::all_of(rim.begin(), rim.end(), [&](Vec3 p) {
    return std::abs(dot(normal, p - hole.center)) <= kPlanarRim * hole.size;
  });
  return hole;
}

// Edges of a mesh, by their two vertices.
class EdgeSet {
 public:
  explicit EdgeSet(const std::vector<Triangle>& triangles) {
    for (const Triangle& t : triangles) add(t);
  }
  void add(const Triangle& t) {
    for (std::size_t k = 0; k < 3; ++k) edges_.insert(key(t[k], t[(k + 1) % 3]));
  }
  bool has(std::uint32_t a, std::uint32_t b) const { return edges_.contains(key(a, b)); }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
  }
  std::unordered_set<std::uint64_t> edges_;
};

// Returns the least-area triangulation of a rim; empty if all need an edge that the mesh has.
std::vector<Triangle> least_area(const std::vector<Vec3>& rim,
                                 const std::vector<std::uint32_t>& vertices, const EdgeSet& taken) {
  const std::size_t n = rim.size();
  std::vector<double> cost(n * n, HUGE_VAL);  // cost of the part from corner i to j
  std::vector<std::uint32_t> apex(n * n, 0);
  for (std::size_t i = 0; i + 1 < n; ++i) cost[i * n + i + 1] = 0;
  for (std::size_t length = 2; length < n; ++length) {
    for (std::size_t i = 0, j = length; j < n; ++i, ++j) {
      const bool is_rim = length == n - 1;
      if (!is_rim && taken.has(vertices[i], vertices[j])) continue;
      const double chord = kShortEdges * squared_norm(rim[j] - rim[i]);
      for (std::size_t k = i + 1; k < j; ++k) {
        const double parts = cost[i * n + k] + cost[k * n + j];
        if (!(parts < cost[i * n + j])) continue;
        const double area = 0.5 * norm(cross(rim[k] - rim[i], rim[j] - rim[i]));
        if (parts + area + chord < cost[i * n + j]) {
          cost[i * n + j] = parts + area + chord;
          apex[i * n + j] = static_cast<std::uint32_t>(k);
        }
      }
    }
  }
  std::vector<Triangle> triangles;
  if (!(cost[n - 1] < HUGE_VAL)) return triangles;
  std::vector<std::pair<std::size_t, std::size_t>> parts{{0, n - 1}};
  while (!parts.empty()) {
    const auto [i, j] = parts.back();
    parts.pop_back();
    if (j - i < 2) continue;
    const std::size_t k = apex[i * n + j];
    triangles.push_back({vertices[i], vertices[k], vertices[j]});
    parts.emplace_back(i, k);
    parts.emplace_back(k, j);
  }
  return triangles;
}

std::vector<Triangle> fan(const std::vector<std::uint32_t>& vertices, std::uint32_t middle) {
  std::vector<Triangle> triangles;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    triangles.push_back({vertices[k], vertices[(k + 1) % vertices.size()], middle});
  return triangles;
}

}  // namespace

HoleFilling fill_holes(const Topology& topology, double diagonal, std::vector<Vec3>& vertices,
                       std::vector<Triangle>& triangles) {
  HoleFilling result;
  EdgeSet edges(triangles);
  for (const BoundaryLoop& loop : boundary_loops(topology, triangles)) {
    std::vector<Vec3> rim;
    for (const std::uint32_t v : loop.vertices) rim.push_back(vertices[v]);
    const FilledHole hole = describe(rim);
    if (!loop.closed || rim.size() < 3 || (!hole.planar && hole.size > kSmallHole * diagonal)) {
      result.left.push_back(loop);
      continue;
    }
    std::vector<Triangle> patch;
    if (rim.size() <= kMostEdges) patch = least_area(rim, loop.vertices, edges);
    if (patch.empty()) {
      patch = fan(loop.vertices, static_cast<std::uint32_t>(vertices.size()));
      vertices.push_back(hole.center);
    }
    for (const Triangle& t : patch) edges.add(t);
    triangles.insert(triangles.end(), patch.begin(), patch.end());
    result.filled.push_back(hole);
  }
  return result;
}

}  // namespace vpm
