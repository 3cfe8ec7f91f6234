#include "libvpm/mesh/topology.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace vpm {
namespace {

constexpr std::uint32_t kNone = Topology::kNone;

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }
  std::uint32_t find(std::uint32_t k) {
    while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
    return k;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::uint32_t corner_at(const Triangle& t, std::uint32_t vertex) {
  return t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
}

// Finds vertices with more than one fan. Corners of a vertex form one fan if edges lead from each
// to each.
std::vector<std::uint32_t> find_pinched(std::size_t vertex_count,
                                        const std::vector<Triangle>& triangles,
                                        const Topology& topology) {
  DisjointSets fans(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t other = topology.neighbor[t][k];
      if (other == kNone) continue;
      for (const std::uint32_t end : {k, (k + 1) % 3})
        fans.join(3 * t + end, 3 * other + corner_at(triangles[other], triangles[t][end]));
    }
  }
  std::vector<std::uint32_t> fan_of(vertex_count, kNone), pinched;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = triangles[t][k], fan = fans.find(3 * t + k);
      if (fan_of[vertex] == kNone) {
        fan_of[vertex] = fan;
      } else if (fan_of[vertex] != fan) {
        pinched.push_back(vertex);
      }
    }
  }
  std::sort(pinched.begin(), pinched.end());
  pinched.erase(std::unique(pinched.begin(), pinched.end()), pinched.end());
  return pinched;
}

}  // namespace

// Sorts by the lower vertex with a count of each, and then the few sides of each vertex.
std::vector<TriangleSide> sorted_sides(std::size_t vertex_count,
                                       const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> next(vertex_count + 1, 0);
  const auto for_sides = [&](const auto& visit) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
        visit({std::min(from, to), std::max(from, to), t, k, from < to});
      }
    }
  };
  for_sides([&](const TriangleSide& side) { ++next[side.low + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<TriangleSide> sides(3 * triangles.size());
  for_sides([&](const TriangleSide& side) { sides[next[side.low]++] = side; });
  auto begin = sides.begin();
  for (std::size_t vertex = 0; vertex < vertex_count; ++vertex) {
    const auto end = sides.begin() + next[vertex];
    std::sort(begin, end, [](const TriangleSide& a, const TriangleSide& b) {
      return std::tie(a.high, a.triangle, a.corner) < std::tie(b.high, b.triangle, b.corner);
    });
    begin = end;
  }
  return sides;
}

std::size_t count_duplicates(std::vector<Triangle> triangles) {
  for (Triangle& t : triangles) std::sort(t.begin(), t.end());
  std::sort(triangles.begin(), triangles.end());
  const auto last = std::unique(triangles.begin(), triangles.end());
  return static_cast<std::size_t>(triangles.end() - last);
}

Topology topology_of(std::size_t vertex_count, const std::vector<Triangle>& triangles) {
  Topology topology;
  topology.neighbor.assign(triangles.size(), {kNone, kNone, kNone});
  for_edges(sorted_sides(vertex_count, triangles), [&](std::span<const TriangleSide> sides) {
    const TriangleSide& first = sides.front();
    const Edge edge{first.low, first.high};
    if (sides.size() == 1) topology.boundary.push_back(edge);
    if (sides.size() > 2) topology.non_manifold.push_back(edge);
    if (sides.size() != 2) return;
    const TriangleSide& second = sides.back();
    if (first.forward == second.forward) topology.conflicting.push_back(edge);
    topology.neighbor[first.triangle][first.corner] = second.triangle;
    topology.neighbor[second.triangle][second.corner] = first.triangle;
  });
  // Fans fall apart at non-manifold edges too, so pinched vertices matter only without those.
  if (topology.non_manifold.empty())
    topology.pinched = find_pinched(vertex_count, triangles, topology);
  return topology;
}

std::vector<std::uint32_t> shells_of(const Topology& topology, std::size_t& count) {
  std::vector<std::uint32_t> shell(topology.neighbor.size(), kNone), stack;
  count = 0;
  for (std::uint32_t seed = 0; seed < shell.size(); ++seed) {
    if (shell[seed] != kNone) continue;
    shell[seed] = static_cast<std::uint32_t>(count);
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (const std::uint32_t other : topology.neighbor[t]) {
        if (other == kNone || shell[other] != kNone) continue;
        shell[other] = static_cast<std::uint32_t>(count);
        stack.push_back(other);
      }
    }
    ++count;
  }
  return shell;
}

std::size_t orient_consistently(const Topology& topology, std::vector<Triangle>& triangles) {
  enum State : char { unseen, kept, turned };
  std::vector<State> state(triangles.size(), unseen);
  std::vector<std::uint32_t> stack;
  // Neighbours agree if they run their common edge in opposite directions.
  const auto agree = [&](std::uint32_t t, std::uint32_t k, std::uint32_t other) {
    const std::uint32_t from = triangles[t][k], to = triangles[t][(k + 1) % 3];
    return triangles[other][(corner_at(triangles[other], from) + 1) % 3] != to;
  };
  for (std::uint32_t seed = 0; seed < triangles.size(); ++seed) {
    if (state[seed] != unseen) continue;
    state[seed] = kept;
    stack.push_back(seed);
    while (!stack.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t other = topology.neighbor[t][k];
        if (other == kNone) continue;
        const State wanted = agree(t, k, other) == (state[t] == kept) ? kept : turned;
        if (state[other] == unseen) {
          state[other] = wanted;
          stack.push_back(other);
        } else if (state[other] != wanted) {
          return kNotOrientable;
        }
      }
    }
  }
  std::size_t count = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (state[t] != turned) continue;
    std::swap(triangles[t][1], triangles[t][2]);
    ++count;
  }
  return count;
}

}  // namespace vpm
