#include "libvpm/mesh/boundary_loops.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

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
  constexpr std::size_t kMostEdges = 256;  // time grows with edges times vertices
  const std::size_t count = loop.vertices.size();
  const auto corner = [&](std::size_t k) { return vertices[loop.vertices[k % count]]; };
  Vec3 normal;
  for (std::size_t k = 0; k < count; ++k)
    normal += cross(corner(k) - corner(0), corner(k + 1) - corner(0));
  double narrowest = HUGE_VAL;
  for (std::size_t k = 0; k < count; k += 1 + count / kMostEdges) {
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

}  // namespace vpm
