#include "libvpm/mesh/self_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/overlap_tree.h"
#include "libvpm/mesh/predicates.h"

namespace vpm {
namespace {

constexpr double kTouching = 1e-12;  // relative to the mesh's diagonal
// Triangles at one vertex from which on they are a fan: fewer are compared with each other.
constexpr std::size_t kFan = 32;

using Corners = std::array<Vec3, 3>;

// True if the corners of t lie in the plane of s, given its unit normal, and the two overlap there
// by more than the tolerance in every direction, which the normals of the six edges decide.
bool overlap_in_plane_of(const Corners& s, Vec3 normal, const Corners& t, double tolerance) {
  for (const Vec3& p : t) {
    if (std::abs(dot(normal, p - s[0])) > tolerance) return false;
  }
  for (const Corners& edges : {s, t}) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 from = edges[k];
      const Vec3 across = normalized_or_zero(cross(normal, edges[(k + 1) % 3] - from));
      const auto span = [&](const Corners& c) {
        return std::minmax(
            {dot(across, c[0] - from), dot(across, c[1] - from), dot(across, c[2] - from)});
      };
      const auto [s_low, s_high] = span(s);
      const auto [t_low, t_high] = span(t);
      if (s_high <= t_low + tolerance || t_high <= s_low + tolerance) return false;
    }
  }
  return true;
}

// Returns for each triangle the vertex in the most triangles, if these are a fan.
std::vector<std::uint32_t> fans_of(std::size_t vertex_count,
                                   const std::vector<Triangle>& triangles) {
  std::vector<std::uint32_t> valence(vertex_count, 0), fan(triangles.size(), OverlapTree::kNone);
  for (const Triangle& t : triangles) {
    for (const std::uint32_t corner : t) ++valence[corner];
  }
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    std::uint32_t most = kFan;
    for (const std::uint32_t corner : triangles[k]) {
      if (valence[corner] > most) most = valence[corner], fan[k] = corner;
    }
  }
  return fan;
}

// Returns the directions in which an apex sees the triangle (apex, b, c): an arc of a great circle
// on the unit sphere, in the triangle of its ends and the point where the tangents there meet.
// Triangles with a common apex meet beyond it only if their arcs do.
OverlapTree::Item arc_of(Vec3 apex, Vec3 b, Vec3 c, double tolerance) {
  constexpr double kRounding = 1e-14;  // rounding of directions
  constexpr double kFull = 2, kLongArc = -0.5;
  const Vec3 u = normalized_or_zero(b - apex), v = normalized_or_zero(c - apex);
  const double cosine = dot(u, v);
  OverlapTree::Item arc{{u, v, u}, kRounding};
  // An arc that touches another within the tolerance may lie beside it by this angle.
  const double edge = norm(c - b), twice = norm(cross(b - apex, c - apex));
  if (tolerance > 0) arc.pad += 4 * tolerance < twice / edge ? 4 * tolerance * edge / twice : kFull;
  if (!(squared_norm(u) > 0 && squared_norm(v) > 0) || !(cosine > kLongArc)) {
    arc.pad = kFull;
  } else {
    arc.points[2] = (u + v) / (1 + cosine);
  }
  return arc;
}

class Search {
 public:
  // A negative tolerance finds true intersections only.
  Search(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles,
         double tolerance, MeshProgress progress)
      : vertices_(vertices),
        triangles_(triangles),
        tolerance_(tolerance),
        limit_(triangles.size()),
        progress_(std::move(progress)) {}

  // Compares triangles without a common fan by their boxes, those of each fan by their arcs.
  std::vector<TrianglePair> all() {
    const std::vector<std::uint32_t> fan = fans_of(vertices_.size(), triangles_);
    std::vector<std::uint32_t> solid;
    std::vector<OverlapTree::Item> items;
    items.reserve(triangles_.size());
    normals_.resize(triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Corners c = corners_of(t);
      normals_[t] = normalized_or_zero(cross(c[1] - c[0], c[2] - c[0]));
      if (!has_area(c[0], c[1], c[2])) continue;
      solid.push_back(t);
      items.push_back({c, 2 * std::max(tolerance_, 0.0), fan[t]});
    }
    search(items, solid, progress_);
    std::erase_if(solid, [&](std::uint32_t t) { return fan[t] == OverlapTree::kNone; });
    std::sort(solid.begin(), solid.end(), [&](std::uint32_t s, std::uint32_t t) {
      return fan[s] != fan[t] ? fan[s] < fan[t] : s < t;
    });
    for (std::size_t begin = 0, end = 0; begin < solid.size(); begin = end) {
      while (end < solid.size() && fan[solid[end]] == fan[solid[begin]]) ++end;
      search_fan({solid.begin() + static_cast<std::ptrdiff_t>(begin),
                  solid.begin() + static_cast<std::ptrdiff_t>(end)},
                 fan[solid[begin]]);
    }
    std::sort(pairs_.begin(), pairs_.end());
    return std::move(pairs_);
  }

  std::uint64_t work() const { return limit_.done(); }

 private:
  // Adds the pairs among triangles, given their volumes.
  void search(const std::vector<OverlapTree::Item>& items,
              const std::vector<std::uint32_t>& triangles, const MeshProgress& progress) {
    const OverlapTree tree(items);
    std::vector<std::vector<TrianglePair>> found(tree.groups());
    const auto work_of = [&](std::size_t group) {
      std::uint64_t tests = 0;
      const std::uint64_t boxes = tree.pairs_of(group, [&](std::uint32_t i, std::uint32_t j) {
        const std::uint32_t s = std::min(triangles[i], triangles[j]),
                            t = std::max(triangles[i], triangles[j]);
        ++tests;
        if (meet(s, t)) found[group].emplace_back(s, t);
      });
      return boxes * work::kBoxes + tests * work::kTriangles +
             found[group].size() * work::kPairFound;
    };
    const bool complete = run_within(limit_, tree.groups(), work_of, progress);
    for (const std::vector<TrianglePair>& part : found)
      pairs_.insert(pairs_.end(), part.begin(), part.end());
    if (!complete) refuse_work(triangles[0]);
  }

  void search_fan(const std::vector<std::uint32_t>& fan, std::uint32_t apex) {
    std::vector<OverlapTree::Item> arcs;
    for (const std::uint32_t t : fan) {
      const Triangle& c = triangles_[t];
      const std::size_t k = c[0] == apex ? 0 : c[1] == apex ? 1 : 2;
      arcs.push_back(arc_of(vertices_[apex], vertices_[c[(k + 1) % 3]], vertices_[c[(k + 2) % 3]],
                            tolerance_));
    }
    search(arcs, fan, {});
  }

  // Names the triangle that meets the most others among the pairs found so far.
  [[noreturn]] void refuse_work(std::uint32_t worst) const {
    std::vector<std::uint32_t> partners(triangles_.size(), 0);
    for (const auto& [s, t] : pairs_) ++partners[s], ++partners[t];
    const auto most = std::max_element(partners.begin(), partners.end());
    if (*most > 0) worst = static_cast<std::uint32_t>(most - partners.begin());
    const Corners c = corners_of(worst);
    const std::string count = std::to_string(triangles_.size());
    throw TooMuchWork("the mesh meets itself, or nearly, in too many places: after " +
                          std::to_string(limit_.done()) + " comparisons of its " + count +
                          " triangles, " + std::to_string(pairs_.size()) +
                          " pairs that meet were found, " + std::to_string(*most) +
                          " of them with one triangle",
                      (c[0] + c[1] + c[2]) / 3,
                      "delete doubled or tangled parts, or give `repair` voxel for a new surface");
  }

  bool meet(std::uint32_t s, std::uint32_t t) const {
    const Corners a = corners_of(s), b = corners_of(t);
    if (tolerance_ >= 0 && (overlap_in_plane_of(a, normals_[s], b, tolerance_) ||
                            overlap_in_plane_of(b, normals_[t], a, tolerance_)))
      return true;
    if (beside(a, s, t) || beside(b, t, s)) return false;
    return triangles_intersect(vertices_, triangles_[s], triangles_[t]);
  }

  // True if triangle t lies on one side of the plane of triangle s, whose corners are `plane`;
  // corners that both have do not matter.
  bool beside(const Corners& plane, std::uint32_t s, std::uint32_t t) const {
    int side = 0;
    for (const std::uint32_t corner : triangles_[t]) {
      const Triangle& own = triangles_[s];
      if (corner == own[0] || corner == own[1] || corner == own[2]) continue;
      const int its = orientation(plane[0], plane[1], plane[2], vertices_[corner]);
      if (its == 0 || its == -side) return false;
      side = its;
    }
    return side != 0;
  }

  Corners corners_of(std::uint32_t t) const {
    const auto [a, b, c] = triangles_[t];
    return {vertices_[a], vertices_[b], vertices_[c]};
  }

  const std::vector<Vec3>& vertices_;
  const std::vector<Triangle>& triangles_;
  double tolerance_;
  WorkLimit limit_;
  MeshProgress progress_;
  std::vector<Vec3> normals_;  // of the triangles, of unit length
  std::vector<TrianglePair> pairs_;
};

}  // namespace

std::vector<TrianglePair> find_self_intersections(const std::vector<Vec3>& vertices,
                                                  const std::vector<Triangle>& triangles) {
  return Search(vertices, triangles, -1, {}).all();
}

std::vector<TrianglePair> intersecting(const std::vector<TrianglePair>& contacts,
                                       const std::vector<Vec3>& vertices,
                                       const std::vector<Triangle>& triangles) {
  std::vector<char> meet(contacts.size());
  constexpr std::size_t kTogether = 256;
  parallel_for(contacts.size(), kTogether, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto& [s, t] = contacts[k];
      meet[k] = triangles_intersect(vertices, triangles[s], triangles[t]) ? 1 : 0;
    }
  });
  std::vector<TrianglePair> pairs;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    if (meet[k] != 0) pairs.push_back(contacts[k]);
  }
  return pairs;
}

double contact_tolerance(const std::vector<Vec3>& vertices) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity}, high = -low;
  for (const Vec3& p : vertices) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double farthest = std::max(norm(low), norm(high));
  return kTouching * norm(high - low) + 8 * std::numeric_limits<double>::epsilon() * farthest;
}

std::vector<TrianglePair> find_contacts(const std::vector<Vec3>& vertices,
                                        const std::vector<Triangle>& triangles,
                                        const MeshProgress& progress, std::uint64_t* work) {
  Search search(vertices, triangles, contact_tolerance(vertices), progress);
  std::vector<TrianglePair> pairs = search.all();
  if (work != nullptr) *work += search.work();
  return pairs;
}

}  // namespace vpm
