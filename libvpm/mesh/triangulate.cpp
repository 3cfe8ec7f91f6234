#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/mesh/polygon_cutting.h"

namespace vpm {
namespace {

// Polygons whose width is less than this fraction of their length are taken for lines.
constexpr double kThin = 1e-13;
// Triangles whose height is less than this fraction of their longest side are exchanged for others
// where the polygon has any. Coordinates of six digits leave corners of one line this far off it.
constexpr double kSliver = 1e-3;
// Limits corners of a polygon that is not convex, for which GLU may take quadratic time.
constexpr std::size_t kMostCorners = 8192;
constexpr const char* kHint = "save triangles in the program that wrote it";

// Returns twice the signed area of the triangle a, b, c.
double turn(Vec2 a, Vec2 b, Vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Returns Newell's normal, which averages a polygon that is not quite flat.
Vec3 newell_normal(const std::vector<Vec3>& corners) {
  Vec3 normal;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 a = corners[k] - corners[0], b = corners[(k + 1) % corners.size()] - corners[0];
    normal += cross(a, b);
  }
  return normal;
}

// Returns a normal of the polygon's plane. Newell's vanishes where parts of the polygon are turned
// against each other, as those of one that crosses itself; there it is that of its largest triangle
// at the first corner.
Vec3 normal_of(const std::vector<Vec3>& corners) {
  constexpr double kVanished = 1e-9;
  const Vec3 newell = newell_normal(corners);
  Vec3 largest;
  for (std::size_t k = 1; k < corners.size(); ++k) {
    const std::size_t next = k + 1 < corners.size() ? k + 1 : 1;
    const Vec3 normal = cross(corners[k] - corners[0], corners[next] - corners[0]);
    if (squared_norm(normal) > squared_norm(largest)) largest = normal;
  }
  return norm(newell) > kVanished * norm(largest) ? newell : largest;
}

// Drops the axis along which the polygon's projection is largest, keeping its orientation.
std::vector<Vec2> project(const std::vector<Vec3>& corners, Vec3 normal) {
  const double ax = std::abs(normal.x), ay = std::abs(normal.y), az = std::abs(normal.z);
  std::vector<Vec2> flat(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 p = corners[k] - corners[0];
    if (ax >= ay && ax >= az) {
      flat[k] = normal.x > 0 ? Vec2{p.y, p.z} : Vec2{p.z, p.y};
    } else if (ay >= az) {
      flat[k] = normal.y > 0 ? Vec2{p.z, p.x} : Vec2{p.x, p.z};
    } else {
      flat[k] = normal.z > 0 ? Vec2{p.x, p.y} : Vec2{p.y, p.x};
    }
  }
  return flat;
}

// True if all corners lie on one line, or in one point.
bool is_line(const std::vector<Vec3>& corners) {
  const auto from_first = [&](Vec3 p) { return norm(p - corners[0]); };
  const Vec3 farthest = *std::max_element(corners.begin(), corners.end(), [&](Vec3 a, Vec3 b) {
    return from_first(a) < from_first(b);
  });
  const Vec3 along = farthest - corners[0];
  const double length = norm(along);
  return std::all_of(corners.begin(), corners.end(), [&](Vec3 p) {
    return norm(cross(p - corners[0], along)) <= kThin * length * length;
  });
}

// True if every corner turns left, and the polygon goes once around.
bool is_convex(const std::vector<Vec2>& flat) {
  const std::size_t count = flat.size();
  const Vec2 last = flat[count - 1];
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 here = flat[k], after = flat[(k + 1) % count];
    if (!(turn(flat[(k + count - 1) % count], here, after) > 0)) return false;
    if (k + 2 < count && !(turn(last, here, after) > 0)) return false;
  }
  return true;
}

// True if a side crosses another between the ends of both.
bool sides_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double c_side = turn(a, b, c), d_side = turn(a, b, d), a_side = turn(c, d, a),
               b_side = turn(c, d, b);
  return ((c_side > 0 && d_side < 0) || (c_side < 0 && d_side > 0)) &&
         ((a_side > 0 && b_side < 0) || (a_side < 0 && b_side > 0));
}

double squared_distance(Vec2 a, Vec2 b) {
  return (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
}

// Returns the least height of the triangle relative to its longest side; negative if it is turned.
double shape_of(Vec2 a, Vec2 b, Vec2 c) {
  const double longest =
      std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)});
  return longest > 0 ? turn(a, b, c) / longest : 0;
}

// Exchanges diagonals of a polygon's triangles beside slivers. A sliver lies along sides of the
// polygon whose corners are on one line, and its long side is none of the surface's edges: faces
// beyond the polygon's sides would meet the triangle at its long side beside their common corner.
class SliverFlips {
 public:
  SliverFlips(const std::vector<Vec2>& flat, std::vector<CornerTriangle>& triangles)
      : flat_(flat), triangles_(triangles) {}

  void run() {
    std::vector<std::uint32_t> open;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      if (is_sliver(t)) open.push_back(t);
    if (open.empty()) return;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) note_sides(t);
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      const std::uint32_t beyond = is_sliver(t) ? flip_longest_side(t) : kNone;
      if (beyond == kNone) continue;
      // Slivers beside the two may be mended now.
      for (const std::uint32_t changed : {t, beyond}) {
        open.push_back(changed);
        for (int k = 0; k < 3; ++k)
          if (const std::uint32_t beside = beyond_side(ends_of(changed, k)); beside != kNone)
            open.push_back(beside);
      }
    }
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  using Ends = std::pair<std::uint32_t, std::uint32_t>;

  double shape(const CornerTriangle& t) const {
    return shape_of(flat_[t[0]], flat_[t[1]], flat_[t[2]]);
  }
  bool is_sliver(std::uint32_t t) const { return shape(triangles_[t]) < kSliver; }

  void note_sides(std::uint32_t t) {
    for (int k = 0; k < 3; ++k) side_of_[ends_of(t, k)] = t;
  }

  // Returns the triangle beyond a side; none beyond a side of the polygon.
  std::uint32_t beyond_side(Ends side) const {
    const auto found = side_of_.find({side.second, side.first});
    return found == side_of_.end() ? kNone : found->second;
  }

  Ends ends_of(std::uint32_t t, int k) const {
    return {triangles_[t][static_cast<std::size_t>(k)],
            triangles_[t][static_cast<std::size_t>((k + 1) % 3)]};
  }

  double squared_length(Ends side) const {
    return squared_distance(flat_[side.first], flat_[side.second]);
  }

  // Replaces the longest side by the other diagonal of the two triangles at it, where that makes
  // the worse of them better. Returns the triangle beyond it; none if nothing was changed.
  std::uint32_t flip_longest_side(std::uint32_t t) {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (squared_length(ends_of(t, k)) > squared_length(ends_of(t, longest))) longest = k;
    const auto [from, to] = ends_of(t, longest);
    const std::uint32_t beyond = beyond_side({from, to});
    if (beyond == kNone) return kNone;
    const std::uint32_t apex = triangles_[t][static_cast<std::size_t>((longest + 2) % 3)];
    std::uint32_t far = apex;
    for (const std::uint32_t corner : triangles_[beyond])
      if (corner != from && corner != to) far = corner;
    const CornerTriangle first{from, far, apex}, second{far, to, apex};
    const double before = std::min(shape(triangles_[t]), shape(triangles_[beyond]));
    if (!(std::min(shape(first), shape(second)) > std::max(before, 0.0))) return kNone;
    side_of_.erase({from, to});
    side_of_.erase({to, from});
    triangles_[t] = first;
    triangles_[beyond] = second;
    note_sides(t);
    note_sides(beyond);
    return beyond;
  }

  const std::vector<Vec2>& flat_;
  std::vector<CornerTriangle>& triangles_;
  std::map<Ends, std::uint32_t> side_of_;  // triangle with the side from one corner to another
};

// True if the corner of a polygon of four can be cut off.
bool is_ear_of_four(const std::vector<Vec2>& flat, std::size_t at) {
  const Vec2 before = flat[(at + 3) % 4], here = flat[at], after = flat[(at + 1) % 4],
             other = flat[(at + 2) % 4];
  return turn(before, here, after) > 0 &&
         !(turn(before, here, other) >= 0 && turn(here, after, other) >= 0 &&
           turn(after, before, other) >= 0);
}

// Cuts polygons; `Emit` takes positions within the polygon.
template <class Emit>
class Cutter {
 public:
  Cutter(const RawMesh& mesh, std::size_t begin, std::size_t end, Emit emit)
      : mesh_(mesh), index_(mesh.corners.data() + begin), emit_(emit) {
    for (std::size_t k = 0; k < end - begin; ++k) corners_.push_back(mesh.vertices[index_[k]]);
  }

  void cut() {
    const std::vector<Vec2> flat = project(corners_, normal_of(corners_));
    if (corners_.size() == 4) {
      cut_four(flat);
    } else if (is_convex(flat)) {
      cut_convex();
    } else if (is_line(corners_)) {
      for (std::size_t k = 2; k < corners_.size(); ++k) add(0, k - 1, k);
    } else {
      cut_any(flat);
    }
    SliverFlips(flat, triangles_).run();
    for (const CornerTriangle& t : triangles_) emit_(t[0], t[1], t[2]);
  }

 private:
  void add(std::size_t a, std::size_t b, std::size_t c) {
    triangles_.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                          static_cast<std::uint32_t>(c)});
  }

  void cut_four(const std::vector<Vec2>& flat) {
    if (sides_cross(flat[0], flat[1], flat[2], flat[3]) ||
        sides_cross(flat[1], flat[2], flat[3], flat[0]))
      refuse_polygon(CuttingFault::crosses_itself);
    for (std::size_t at = 0; at < 4; ++at) {
      if (!is_ear_of_four(flat, at)) continue;
      add((at + 3) % 4, at, (at + 1) % 4);
      const std::size_t a = at == 0 ? 1 : 0, b = at <= 1 ? 2 : 1, c = at == 3 ? 2 : 3;
      add(a, b, c);
      return;
    }
    add(0, 1, 2);
    add(0, 2, 3);
  }

  // Cuts a fan about the last corner.
  void cut_convex() {
    const std::size_t last = corners_.size() - 1;
    for (std::size_t k = 0; k + 2 < last; ++k) add(last, k, k + 1);
    add(last - 2, last - 1, last);
  }

  void cut_any(const std::vector<Vec2>& flat) {
    if (corners_.size() > kMostCorners) {
      refuse(text_of_polygon() + "is not convex; such polygons may have " +
                 std::to_string(kMostCorners) + " corners",
             mesh_.name, kHint);
    }
    const std::vector<std::size_t> ring = without_spikes(flat);
    if (ring.size() == 3) add(ring[0], ring[1], ring[2]);
    if (ring.size() <= 3) return;
    const double unit = size_of(flat);
    std::vector<Vec2> points;
    for (const std::size_t k : ring) points.push_back({flat[k].x / unit, flat[k].y / unit});
    const PolygonCutting cutting = cut_polygon(points);
    if (cutting.fault != CuttingFault::none) refuse_polygon(cutting.fault);
    for (const CornerTriangle& t : cutting.triangles) add(ring[t[0]], ring[t[1]], ring[t[2]]);
  }

  // Returns the largest coordinate, rounded to a power of two, by which division is exact.
  static double size_of(const std::vector<Vec2>& flat) {
    double size = 0;
    for (const Vec2& p : flat) size = std::max({size, std::abs(p.x), std::abs(p.y)});
    return std::ldexp(1.0, std::ilogb(size));
  }

  // Cuts off corners that equal a neighbour, or whose neighbours are equal, and returns the others.
  std::vector<std::size_t> without_spikes(const std::vector<Vec2>& flat) {
    const auto equal = [&](std::size_t a, std::size_t b) {
      return flat[a].x == flat[b].x && flat[a].y == flat[b].y;
    };
    const auto is_spike = [&](std::size_t before, std::size_t here, std::size_t after) {
      return equal(here, after) || equal(before, here) || equal(before, after);
    };
    std::vector<std::size_t> ring;
    for (std::size_t k = 0; k < flat.size(); ++k) {
      ring.push_back(k);
      while (ring.size() >= 3 && is_spike(ring.end()[-3], ring.end()[-2], k)) {
        emit_flat(ring.end()[-3], ring.end()[-2], k);
        ring.erase(ring.end() - 2);
      }
    }
    std::size_t first = 0;  // those before were cut off
    while (ring.size() - first >= 3) {
      const std::size_t last = ring.back(), before = ring.end()[-2];
      if (is_spike(before, last, ring[first])) {
        emit_flat(before, last, ring[first]);
        ring.pop_back();
      } else if (is_spike(last, ring[first], ring[first + 1])) {
        emit_flat(last, ring[first], ring[first + 1]);
        ++first;
      } else {
        break;
      }
    }
    ring.erase(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(first));
    return ring;
  }

  // Emits a triangle without area that closes the surface, unless two of its corners are one
  // vertex.
  void emit_flat(std::size_t a, std::size_t b, std::size_t c) {
    if (index_[a] != index_[b] && index_[b] != index_[c] && index_[c] != index_[a]) add(a, b, c);
  }

  std::string text_of_polygon() const {
    char text[120];
    std::snprintf(text, sizeof text, "a polygon of %zu corners, from (%.6g, %.6g, %.6g), ",
                  corners_.size(), corners_[0].x, corners_[0].y, corners_[0].z);
    return text;
  }

  [[noreturn]] void refuse_polygon(CuttingFault fault) const {
    const std::string polygon = text_of_polygon();
    if (fault == CuttingFault::crosses_itself)
      refuse(polygon + "crosses itself as seen along its normal", mesh_.name, kHint);
    if (fault == CuttingFault::unavailable) {
      throw Error(ErrorKind::unavailable,
                  polygon +
                      "is not convex; this build cuts only convex ones, for want of GLU "
                      "(Debian: libglu1-mesa-dev)",
                  mesh_.name, kHint);
    }
    refuse(polygon + "could not be cut into triangles here, which says nothing against the mesh",
           mesh_.name, kHint);
  }

  const RawMesh& mesh_;
  const std::uint32_t* index_;
  Emit emit_;
  std::vector<Vec3> corners_;
  std::vector<CornerTriangle> triangles_;  // positions within the polygon
};

}  // namespace

std::vector<Triangle> triangulate(const RawMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.corners.size() - 2 * mesh.polygon_count());
  std::size_t begin = 0;
  for (const std::size_t end : mesh.polygon_end) {
    const std::uint32_t* const index = mesh.corners.data() + begin;
    const auto emit = [&](std::size_t a, std::size_t b, std::size_t c) {
      triangles.push_back({index[a], index[b], index[c]});
    };
    if (end - begin == 3) {
      emit(0, 1, 2);
    } else {
      Cutter(mesh, begin, end, emit).cut();
    }
    begin = end;
  }
  return triangles;
}

}  // namespace vpm
