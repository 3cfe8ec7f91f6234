#include "libvpm/solid/triangle_pair.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/lanes.h"
#include "libvpm/core/vec3x4.h"
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

  [[gnu::always_inline]] Meeting find(TriangleCrossing& found) {
    const Vec3 origin = b_.corner[0];
    const Vec3x4 p = corners_from(a_, origin);
    const Double4 above_b = dot(b_.normal, p);
    if (is_on_one_side(above_b)) return Meeting::apart;
    const Double4 above_a = dot(a_.normal, corners_from(b_, a_.corner[0]));
    if (is_on_one_side(above_a)) return Meeting::apart;
    for (std::size_t k = 0; k < 3; ++k) {
      const int lane = static_cast<int>(k);
      above_b_[k] = above_b[lane], above_a_[k] = above_a[lane];
    }
    for (std::size_t k = 0; k < 3; ++k) side_b_[k] = side(above_b_[k], b_, a_.corner[k]);
    if (side_b_[0] == side_b_[1] && side_b_[1] == side_b_[2]) return meeting(Meeting::apart);
    for (std::size_t k = 0; k < 3; ++k) side_a_[k] = side(above_a_[k], a_, b_.corner[k]);
    if (side_a_[0] == side_a_[1] && side_a_[1] == side_a_[2]) return meeting(Meeting::apart);
    find_sides_of_edges(p, corners_from(b_, origin));
    add_crossings(a_, above_b_, side_b_, true, found);
    add_crossings(b_, above_a_, side_a_, false, found);
    if (starts_ == 0 && ends_ == 0) return meeting(Meeting::apart);
    return meeting(starts_ == 1 && ends_ == 1 ? Meeting::crossing : Meeting::undecided);
  }

 private:
  Meeting meeting(Meeting found) const { return has_zero_ ? Meeting::undecided : found; }

  // Corners about an origin, in three lanes; the fourth repeats the first.
  [[gnu::always_inline]] static Vec3x4 corners_from(const PlacedTriangle& t, Vec3 origin) {
    const auto& [a, b, c] = t.corner;
    return Vec3x4(a, b, c, a) - Vec3x4(origin, origin, origin, origin);
  }
  // The corners that follow.
  [[gnu::always_inline]] static Vec3x4 next_corners(const Vec3x4& v) {
    const Mask4 next{1, 2, 0, 1};
    return {__builtin_shuffle(v.x, next), __builtin_shuffle(v.y, next),
            __builtin_shuffle(v.z, next)};
  }

  // Takes the heights of a triangle's corners over a plane, in six volumes.
  [[gnu::always_inline]] bool is_on_one_side(const Double4& above) const {
    return all(above > bound_) || all(above < -bound_);
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

  // Finds on which side edges of a pass those of b by Plücker coordinates about b's first corner,
  // from which p and r are the corners of a and b.
  [[gnu::always_inline]] void find_sides_of_edges(const Vec3x4& p, const Vec3x4& r) {
    const Vec3x4 q = next_corners(p), s = next_corners(r);
    const Vec3x4 along_a = q - p, moment_a = cross(p, q), along_b = s - r, moment_b = cross(r, s);
    for (int i = 0; i < 3; ++i) {
      const Double4 volume = dot(along_a.of(i), moment_b) + dot(moment_a.of(i), along_b);
      const unsigned above = mask_of(converted<Int4>(volume > bound_)),
                     below = mask_of(converted<Int4>(volume < -bound_));
      for (unsigned j = 0; j < 3; ++j)
        edges_[static_cast<std::size_t>(i)][j] =
            static_cast<int>(above >> j & 1) - static_cast<int>(below >> j & 1);
    }
  }

  // Returns on which side edge i of a passes edge j of b.
  int edges(std::size_t i, std::size_t j) {
    int& known = edges_[i][j];  // 0 where only the exact sign tells
    if (known == 0)
      known = sign(0, a_.corner[i], a_.corner[(i + 1) % 3], b_.corner[j], b_.corner[(j + 1) % 3]);
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
  std::array<std::array<int, 3>, 3> edges_{};
  int starts_ = 0, ends_ = 0;
  bool has_zero_ = false;
};

}  // namespace

VPM_VECTOR_CLONES
Meeting cross_triangles(const PlacedTriangle& a, const PlacedTriangle& b,
                        TriangleCrossing& crossing) {
  return Crossing(a, b).find(crossing);
}

}  // namespace vpm
