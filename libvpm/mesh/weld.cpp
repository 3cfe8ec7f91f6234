#include "libvpm/mesh/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <unordered_map>

namespace vpm {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

using Cell = std::array<std::int64_t, 3>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t k : cell) {
      // The odd constant of Fibonacci hashing, 2^64 / golden ratio.
      hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9e3779b97f4a7c15ULL;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

// Vertices that were not joined, in a grid twice as wide as the tolerance: whatever lies within the
// tolerance is in the same or a neighbouring grid cell.
class Representatives {
 public:
  Representatives(const std::vector<Vec3>& vertices, double tolerance)
      : vertices_(vertices),
        width_(2 * tolerance),
        far_(kFar * width_),
        far_bits_(std::bit_cast<std::int64_t>(far_)),
        tolerance_(tolerance),
        next_(vertices.size(), kNone) {
    first_.reserve(vertices.size());
  }

  // Returns the first one within the tolerance, or kNone.
  std::uint32_t find(Vec3 p) const {
    const Cell home = cell_of(p);
    std::uint32_t found = kNone;
    for (std::int64_t i = 0; i < 27; ++i) {
      const Cell cell{home[0] + i % 3 - 1, home[1] + i / 3 % 3 - 1, home[2] + i / 9 - 1};
      const auto list = first_.find(cell);
      if (list == first_.end()) continue;
      for (std::uint32_t k = list->second; k != kNone; k = next_[k]) {
        if (norm(vertices_[k] - p) <= tolerance_) found = std::min(found, k);
      }
    }
    return found;
  }

  void add(std::uint32_t vertex) {
    std::uint32_t& first = first_.try_emplace(cell_of(vertices_[vertex]), kNone).first->second;
    next_[vertex] = first;
    first = vertex;
  }

 private:
  // Number of cells up to which a quotient tells cells apart, and doubles in a cell beyond: there
  // the tolerance is less than four steps from one double to the next.
  static constexpr double kFar = 0x1p50;
  static constexpr int kStepBits = 2;

  Cell cell_of(Vec3 p) const { return {row_of(p.x), row_of(p.y), row_of(p.z)}; }

  // Ascends with x; rows of coordinates within the tolerance differ by at most one.
  std::int64_t row_of(double x) const {
    if (std::abs(x) < far_) return static_cast<std::int64_t>(std::floor(x / width_));
    const std::int64_t steps = std::bit_cast<std::int64_t>(std::abs(x)) - far_bits_;
    const std::int64_t row = static_cast<std::int64_t>(kFar) + (steps >> kStepBits);
    return x < 0 ? -1 - row : row;
  }

  const std::vector<Vec3>& vertices_;
  double width_, far_;
  std::int64_t far_bits_;
  double tolerance_;
  std::vector<std::uint32_t> next_;
  std::unordered_map<Cell, std::uint32_t, CellHash> first_;
};

std::vector<std::uint32_t> join_near(const std::vector<Vec3>& vertices, double tolerance) {
  Representatives representatives(vertices, tolerance);
  std::vector<std::uint32_t> target(vertices.size());
  for (std::uint32_t k = 0; k < vertices.size(); ++k) {
    const std::uint32_t found = representatives.find(vertices[k]);
    target[k] = found == kNone ? k : found;
    if (found == kNone) representatives.add(k);
  }
  return target;
}

std::vector<std::uint32_t> join_equal(const std::vector<Vec3>& vertices) {
  std::vector<std::uint32_t> order(vertices.size()), target(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) {
    const Vec3 &a = vertices[i], &b = vertices[j];
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    if (a.z != b.z) return a.z < b.z;
    return i < j;
  });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && vertices[order[k]] == vertices[order[k - 1]];
    target[order[k]] = same ? target[order[k - 1]] : order[k];
  }
  return target;
}

}  // namespace

std::size_t drop_collapsed(std::vector<Triangle>& triangles) {
  return std::erase_if(
      triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

std::size_t drop_repeated(std::vector<Triangle>& triangles) {
  std::set<Triangle> seen;
  return std::erase_if(triangles, [&](Triangle t) {
    std::sort(t.begin(), t.end());
    return !seen.insert(t).second;
  });
}

Weld weld(const std::vector<Vec3>& vertices, double tolerance, std::vector<Triangle>& triangles) {
  Weld done;
  if (vertices.empty()) return done;
  const std::vector<std::uint32_t> target =
      tolerance > 0 ? join_near(vertices, tolerance) : join_equal(vertices);
  for (std::uint32_t k = 0; k < target.size(); ++k) done.joined_vertices += target[k] != k;
  for (Triangle& t : triangles) {
    for (std::uint32_t& corner : t) corner = target[corner];
  }
  done.collapsed_triangles = drop_collapsed(triangles);
  return done;
}

std::size_t drop_unused(std::vector<Vec3>& vertices, std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> renamed(vertices.size(), kNone);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t corner : t) renamed[corner] = 0;
  }
  std::uint32_t kept = 0;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (renamed[k] == kNone) continue;
    vertices[kept] = vertices[k];
    renamed[k] = kept++;
  }
  for (Triangle& t : triangles) {
    for (std::uint32_t& corner : t) corner = renamed[corner];
  }
  const std::size_t dropped = vertices.size() - kept;
  vertices.resize(kept);
  return dropped;
}

}  // namespace vpm
