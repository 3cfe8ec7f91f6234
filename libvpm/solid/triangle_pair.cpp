#include "libvpm/solid/triangle_pair.h"

#include <algorithm>
#include <cmath>

#include "libvpm/mesh/predicates.h"

namespace vpm {
namespace {

// Rounding error of the determinants here, by far, relative to the cube of the largest distance of
// two corners: each is a sum of a dozen products of three differences.
constexpr double kFilter = 3e-14;
// The corners of two triangles with overlapping boxes are within so many times the sum of their
// longest edges: the root of three for boxes, and their padding.
constexpr double kSpread = 1.8;

using Signs = std::array<int, 3>;

class Crossing {
 public:
  Crossing(const PlacedTriangle& a, const PlacedTriangle& b) : a_(a), b_(b) {
    const double spread = kSpread * (a.longest_edge + b.longest_edge);
    bound_ = kFilter * spread * spread * spread;
  }

  Meeting find(TriangleCrossing& found) {
    measure(a_, b_, above_b_);
    if (is_on_one_side(above_b_)) return Meeting::apart;
    measure(b_, a_, above_a_);
    if (is_on_one_side(above_a_)) return Meeting::apart;
    for (std::size_t k = 0; k < 3; ++k) side_b_[k] = side(above_b_[k], b_, a_.corner[k]);
    if (side_b_[0] == side_b_[1] && side_b_[1] == side_b_[2]) return meeting(Meeting::apart);
    for (std::size_t k = 0; k < 3; ++k) side_a_[k] = side(above_a_[k], a_, b_.corner[k]);
    if (side_a_[0] == side_a_[1] && side_a_[1] == side_a_[2]) return meeting(Meeting::apart);
    prepare_edges();
    add_crossings(a_, above_b_, side_b_, true, found);
    add_crossings(b_, above_a_, side_a_, false, found);
    if (starts_ == 0 && ends_ == 0) return meeting(Meeting::apart);
    return meeting(starts_ == 1 && ends_ == 1 ? Meeting::crossing : Meeting::undecided);
  }

 private:
  Meeting meeting(Meeting found) const { return has_zero_ ? Meeting::undecided : found; }

  // Measures the corners of a triangle over the plane of another, in six volumes.
  static void measure(const PlacedTriangle& t, const PlacedTriangle& plane,
                      std::array<double, 3>& above) {
    for (std::size_t k = 0; k < 3; ++k) above[k] = dot(plane.normal, t.corner[k] - plane.corner[0]);
  }

  bool is_on_one_side(const std::array<double, 3>& above) const {
    return std::min({above[0], above[1], above[2]}) > bound_ ||
           std::max({above[0], above[1], above[2]}) < -bound_;
  }

  int sign(double determinant, Vec3 p, Vec3 q, Vec3 r, Vec3 s) {
    if (determinant > bound_) return 1;
    if (determinant < -bound_) return -1;
    const int exact = -orientation(p, q, r, s);
    has_zero_ = has_zero_ || exact == 0;
    return exact;
  }

  // Returns +1 if x lies above the triangle's plane, outside of its solid.
  int side(double above, const PlacedTriangle& t, Vec3 x) {
    return sign(above, t.corner[0], t.corner[1], t.corner[2], x);
  }

  // Plücker coordinates of the edges, about b's first corner, for the signs of pairs of edges.
  void prepare_edges() {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const Vec3 p = a_.corner[k] - b_.corner[0], q = a_.corner[next] - b_.corner[0];
      const Vec3 r = b_.corner[k] - b_.corner[0], s = b_.corner[next] - b_.corner[0];
      along_a_[k] = q - p, moment_a_[k] = cross(p, q);
      along_b_[k] = s - r, moment_b_[k] = cross(r, s);
    }
  }

  // Returns on which side edge i of a passes edge j of b.
  int edges(std::size_t i, std::size_t j) {
    int& known = edges_[i][j];
    if (known == 0) {
      const double volume = dot(along_a_[i], moment_b_[j]) + dot(along_b_[j], moment_a_[i]);
      known =
          sign(volume, a_.corner[i], a_.corner[(i + 1) % 3], b_.corner[j], b_.corner[(j + 1) % 3]);
    }
    return known;
  }

  // True if an edge whose ends are on different sides of the other's plane passes through the
  // other.
  bool passes(std::size_t edge, bool is_first) {
    const auto at = [&](std::size_t k) { return is_first ? edges(edge, k) : edges(k, edge); };
    return at(0) == at(1) && at(1) == at(2);
  }

  void add_crossings(const PlacedTriangle& t, const std::array<double, 3>& above, const Signs& side,
                     bool is_first, TriangleCrossing& found) {
    int& count = is_first ? found.first_count : found.second_count;
    auto& list = is_first ? found.of_first : found.of_second;
    count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (side[k] == side[next] || !passes(k, is_first)) continue;
      const bool enters = side[next] < 0;
      const Vec3 place = place_on_edge(t, k, next, above);
      // An edge of the first that enters the other ends the segment; one of the second starts it.
      const bool starts = enters != is_first;
      (starts ? found.start : found.end) = place;
      ++(starts ? starts_ : ends_);
      if (count < 2)
        list[static_cast<std::size_t>(count++)] = {static_cast<int>(k), enters ? 1 : -1, place};
    }
  }

  // Computes from the lower vertex to the higher, so that all triangles of an edge get the same
  // bits.
  static Vec3 place_on_edge(const PlacedTriangle& t, std::size_t k, std::size_t next,
                            const std::array<double, 3>& above) {
    if (t.index[k] > t.index[next]) std::swap(k, next);
    const double span = above[k] - above[next];
    const double fraction = span != 0 ? std::clamp(above[k] / span, 0.0, 1.0) : 0.5;
    return t.corner[k] + fraction * (t.corner[next] - t.corner[k]);
  }

  const PlacedTriangle &a_, &b_;
  double bound_ = 0;
  std::array<double, 3> above_b_{}, above_a_{};  // of the corners over the other's plane
  Signs side_b_{}, side_a_{};
  std::array<Vec3, 3> along_a_, moment_a_, along_b_, moment_b_;
  std::array<std::array<int, 3>, 3> edges_{};
  int starts_ = 0, ends_ = 0;
  bool has_zero_ = false;
};

}  // namespace

Meeting cross_triangles(const PlacedTriangle& a, const PlacedTriangle& b,
                        TriangleCrossing& crossing) {
  return Crossing(a, b).find(crossing);
}

}  // namespace vpm
