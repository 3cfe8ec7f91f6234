#include "libvpm/mesh/holes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace vpm {
namespace {

// Side of a triangle, walked towards one of its ends.
struct Step {
  std::uint32_t triangle = 0, side = 0;
  std::uint32_t to = 0;  // vertex
};

class Walk {
 public:
  Walk(const Topology& topology, const std::vector<Triangle>& triangles)
      : topology_(topology), triangles_(triangles), seen_(3 * triangles.size(), 0) {}

  std::vector<BoundaryLoop> all() {
    std::vector<BoundaryLoop> loops;
    // Starts at the ends of open rims first, so that none is found in two parts.
    for (const bool open_only : {true, false}) {
      for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        for (std::uint32_t k = 0; k < 3; ++k) {
          const Step first{t, k, triangles_[t][k]};
          if (!is_rim(first) || seen_[3 * t + k] != 0) continue;
          if (open_only && next({t, k, triangles_[t][(k + 1) % 3]})) continue;
          add_simple(from(first), loops);
        }
      }
    }
    std::sort(loops.begin(), loops.end(), [](const BoundaryLoop& a, const BoundaryLoop& b) {
      if (a.vertices.size() != b.vertices.size()) return a.vertices.size() > b.vertices.size();
      return a.vertices < b.vertices;
    });
    return loops;
  }

 private:
  bool is_rim(const Step& s) const {
    if (topology_.neighbor[s.triangle][s.side] != Topology::kNone) return false;
    const std::uint32_t a = triangles_[s.triangle][s.side],
                        b = triangles_[s.triangle][(s.side + 1) % 3];
    const Edge edge{std::min(a, b), std::max(a, b)};
    const auto before = [](const Edge& x, const Edge& y) {
      return x.a != y.a ? x.a < y.a : x.b < y.b;
    };
    return std::binary_search(topology_.boundary.begin(), topology_.boundary.end(), edge, before);
  }

  // Returns the next boundary side around the vertex that the step leads to; none if that side
  // belongs to more than two triangles.
  std::optional<Step> next(Step s) const {
    while (true) {
      // Turns to the triangle's other side at the vertex.
      const std::uint32_t corner = corner_at(s.triangle, s.to);
      s.side = s.side == corner ? (corner + 2) % 3 : corner;
      const std::uint32_t beyond = topology_.neighbor[s.triangle][s.side];
      if (beyond == Topology::kNone) break;
      const std::uint32_t far = far_end(s);
      s.side = side_between(beyond, s.to, far);
      s.triangle = beyond;
    }
    if (!is_rim(s)) return std::nullopt;
    return Step{s.triangle, s.side, far_end(s)};
  }

  BoundaryLoop from(const Step& first) {
    BoundaryLoop loop;
    loop.vertices.push_back(triangles_[first.triangle][(first.side + 1) % 3]);
    std::optional<Step> step = first;
    while (step && seen_[3 * step->triangle + step->side] == 0) {
      seen_[3 * step->triangle + step->side] = 1;
      loop.vertices.push_back(step->to);
      step = next(*step);
    }
    loop.closed = step.has_value();
    if (loop.closed) loop.vertices.pop_back();  // repeats the first
    return loop;
  }

  // Cuts a loop where it passes a vertex again.
  static void add_simple(const BoundaryLoop& loop, std::vector<BoundaryLoop>& loops) {
    BoundaryLoop open{{}, loop.closed};
    std::unordered_map<std::uint32_t, std::size_t> place;  // index of each vertex in `open`
    for (const std::uint32_t vertex : loop.vertices) {
      const auto [before, is_new] = place.try_emplace(vertex, open.vertices.size());
      if (loop.closed && !is_new) {
        const auto cut = open.vertices.begin() + static_cast<std::ptrdiff_t>(before->second);
        for (auto passed = cut + 1; passed != open.vertices.end(); ++passed) place.erase(*passed);
        loops.push_back({{cut, open.vertices.end()}, true});
        open.vertices.erase(cut, open.vertices.end());
      }
      open.vertices.push_back(vertex);
    }
    loops.push_back(std::move(open));
  }

  std::uint32_t corner_at(std::uint32_t t, std::uint32_t vertex) const {
    return triangles_[t][0] == vertex ? 0 : triangles_[t][1] == vertex ? 1 : 2;
  }
  std::uint32_t far_end(const Step& s) const {
    const std::uint32_t a = triangles_[s.triangle][s.side];
    return a == s.to ? triangles_[s.triangle][(s.side + 1) % 3] : a;
  }
  std::uint32_t side_between(std::uint32_t t, std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t i = corner_at(t, a), j = corner_at(t, b);
    return (i + 1) % 3 == j ? i : j;
  }

  const Topology& topology_;
  const std::vector<Triangle>& triangles_;
  std::vector<char> seen_;  // three per triangle, one for each side
};

}  // namespace

std::vector<BoundaryLoop> boundary_loops(const Topology& topology,
                                         const std::vector<Triangle>& triangles) {
  return topology.boundary.empty() ? std::vector<BoundaryLoop>{} : Walk(topology, triangles).all();
}

double width_of(const BoundaryLoop& loop, const std::vector<Vec3>& vertices) {
  constexpr std::size_t kMaxEdges = 256;  // time grows with edges times vertices
  const std::size_t count = loop.vertices.size();
  const auto corner = [&](std::size_t k) { return vertices[loop.vertices[k % count]]; };
  Vec3 normal;
  for (std::size_t k = 0; k < count; ++k)
    normal += cross(corner(k) - corner(0), corner(k + 1) - corner(0));
  double narrowest = HUGE_VAL;
  for (std::size_t k = 0; k < count; k += 1 + count / kMaxEdges) {
    const Vec3 across = normalized_or_zero(cross(normal, corner(k + 1) - corner(k)));
    if (across == Vec3{}) continue;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t i = 0; i < count; ++i) {
      low = std::min(low, dot(across, corner(i) - corner(k)));
      high = std::max(high, dot(across, corner(i) - corner(k)));
    }
    narrowest = std::min(narrowest, high - low);
  }
  return narrowest < HUGE_VAL ? narrowest : 0;  // a rim without area lets nothing pass
}

namespace {

constexpr std::size_t kMaxEdges = 1000;  // time grows with their cube
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
    if (rim.size() <= kMaxEdges) patch = least_area(rim, loop.vertices, edges);
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
