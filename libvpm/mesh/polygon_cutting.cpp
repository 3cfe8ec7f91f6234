// Uses the sweep line of GLU's tessellator. It merges corners at one point, so it tells triangles
// of points; which corner of the ring each of them is follows from the sides that they share.
#include "libvpm/mesh/polygon_cutting.h"

#include <GL/glu.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace vpm {
namespace {

constexpr std::uint32_t kNone = 0xffffffff;

// Numbers the points of the ring, so that corners at one point have one number.
std::vector<std::uint32_t> numbered_points(std::span<const Vec2> ring) {
  std::vector<std::uint32_t> order(ring.size()), number(ring.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  const auto key = [&](std::uint32_t k) { return std::pair(ring[k].x, ring[k].y); };
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool is_new = k == 0 || key(order[k]) != key(order[k - 1]);
    number[order[k]] = is_new ? order[k] : number[order[k - 1]];
  }
  return number;
}

// Vertex as GLU takes and returns it.
struct Vertex {
  double at[3];
  std::uint32_t point;
};

struct Sweep {
  std::vector<std::uint32_t> points;  // three for each triangle
  PolygonCutting* result;
};

void GLAPIENTRY add_vertex(void* vertex, void* sweep) {
  static_cast<Sweep*>(sweep)->points.push_back(static_cast<const Vertex*>(vertex)->point);
}

// Asks for triangles in place of fans and strips by being set.
void GLAPIENTRY pass_edge_flag(GLboolean) {}

void GLAPIENTRY note_fault(GLenum, void* sweep) {
  static_cast<Sweep*>(sweep)->result->fault = CuttingFault::not_cut;
}

// Merges two corners at one point; four edge ends belong to a crossing.
void GLAPIENTRY combine(GLdouble at[3], void* vertices[4], GLfloat[4], void** merged, void* sweep) {
  *merged = vertices[0];
  if (vertices[2] == nullptr && vertices[3] == nullptr) return;
  PolygonCutting& result = *static_cast<Sweep*>(sweep)->result;
  result.fault = CuttingFault::crosses_itself;
  result.place = {at[0], at[1]};
}

// Returns the triangles' points, three for each.
std::vector<std::uint32_t> swept_points(std::span<const Vec2> ring,
                                        const std::vector<std::uint32_t>& number,
                                        PolygonCutting& result) {
  std::vector<Vertex> vertices;
  for (std::size_t k = 0; k < ring.size(); ++k)
    vertices.push_back({{ring[k].x, ring[k].y, 0}, number[k]});
  Sweep sweep{.points = {}, .result = &result};
  using Function = void(GLAPIENTRY*)();
  const std::unique_ptr<GLUtesselator, decltype(&gluDeleteTess)> tess(gluNewTess(), &gluDeleteTess);
  gluTessCallback(tess.get(), GLU_TESS_VERTEX_DATA, reinterpret_cast<Function>(&add_vertex));
  gluTessCallback(tess.get(), GLU_TESS_EDGE_FLAG, reinterpret_cast<Function>(&pass_edge_flag));
  gluTessCallback(tess.get(), GLU_TESS_ERROR_DATA, reinterpret_cast<Function>(&note_fault));
  gluTessCallback(tess.get(), GLU_TESS_COMBINE_DATA, reinterpret_cast<Function>(&combine));
  gluTessProperty(tess.get(), GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_POSITIVE);
  gluTessNormal(tess.get(), 0, 0, 1);
  gluTessBeginPolygon(tess.get(), &sweep);
  gluTessBeginContour(tess.get());
  for (Vertex& vertex : vertices) gluTessVertex(tess.get(), vertex.at, &vertex);
  gluTessEndContour(tess.get());
  gluTessEndPolygon(tess.get());
  return std::move(sweep.points);
}

// Side of a triangle from one point to the next, numbered 3 * triangle + position.
struct Side {
  std::uint64_t ends;
  std::uint32_t number;
};

std::uint64_t ends_of(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}

std::uint32_t next_in_triangle(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

class Corners {
 public:
  // Takes the numbers of the ring's points, and those of the triangles.
  Corners(const std::vector<std::uint32_t>& ring, const std::vector<std::uint32_t>& points)
      : ring_(ring), points_(points), corner_(points.size(), kNone), is_rim_(points.size(), false) {
    for (std::uint32_t side = 0; side < points.size(); ++side)
      sides_.push_back({ends_of(points[side], points[next_in_triangle(side)]), side});
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
      return a.ends != b.ends ? a.ends < b.ends : a.number < b.number;
    });
  }

  // Returns for each place in the triangles the corner of the ring; empty if the triangles do not
  // fill the ring, or not without a doubt.
  std::optional<std::vector<std::uint32_t>> find() {
    if (points_.size() != 3 * (ring_.size() - 2)) return std::nullopt;
    for (std::uint32_t k = 0; k < ring_.size(); ++k) {
      const auto next = static_cast<std::uint32_t>((k + 1) % ring_.size());
      const std::uint32_t side = side_between(ring_[k], ring_[next]);
      if (side == kNone || is_rim_[side]) return std::nullopt;
      is_rim_[side] = true;
      if (!set(side, k) || !set(next_in_triangle(side), next)) return std::nullopt;
    }
    while (!open_.empty()) {
      const std::uint32_t place = open_.back();
      open_.pop_back();
      if (!spread(place)) return std::nullopt;
    }
    const bool is_complete = std::find(corner_.begin(), corner_.end(), kNone) == corner_.end();
    return is_complete ? std::optional(std::move(corner_)) : std::nullopt;
  }

 private:
  // Returns the only side between the points; none if there are several.
  std::uint32_t side_between(std::uint32_t from, std::uint32_t to) const {
    const std::uint64_t ends = ends_of(from, to);
    const auto found =
        std::lower_bound(sides_.begin(), sides_.end(), ends,
                         [](const Side& side, std::uint64_t wanted) { return side.ends < wanted; });
    if (found == sides_.end() || found->ends != ends) return kNone;
    const auto second = found + 1;
    return second != sides_.end() && second->ends == ends ? kNone : found->number;
  }

  bool set(std::uint32_t place, std::uint32_t corner) {
    if (corner_[place] == corner) return true;
    if (corner_[place] != kNone) return false;
    corner_[place] = corner;
    open_.push_back(place);
    return true;
  }

  // Tells the corner at a place to the triangles beyond both sides that meet there.
  bool spread(std::uint32_t place) {
    const std::uint32_t after = place, next = next_in_triangle(place),
                        before = next_in_triangle(next);
    if (!is_rim_[after]) {
      const std::uint32_t beyond = side_between(points_[next], points_[place]);
      if (beyond == kNone || !set(next_in_triangle(beyond), corner_[place])) return false;
    }
    if (!is_rim_[before]) {
      const std::uint32_t beyond = side_between(points_[place], points_[before]);
      if (beyond == kNone || !set(beyond, corner_[place])) return false;
    }
    return true;
  }

  const std::vector<std::uint32_t>& ring_;
  const std::vector<std::uint32_t>& points_;
  std::vector<Side> sides_;
  std::vector<std::uint32_t> corner_;
  std::vector<bool> is_rim_;
  std::vector<std::uint32_t> open_;  // places whose corner is not told to others yet
};

}  // namespace

PolygonCutting cut_polygon(std::span<const Vec2> ring) {
  PolygonCutting result;
  const std::vector<std::uint32_t> number = numbered_points(ring);
  const std::vector<std::uint32_t> points = swept_points(ring, number, result);
  if (result.fault != CuttingFault::none) return result;
  const auto corners = Corners(number, points).find();
  if (!corners) {
    result.fault = CuttingFault::not_cut;
    return result;
  }
  for (std::size_t k = 0; k < corners->size(); k += 3)
    result.triangles.push_back({(*corners)[k], (*corners)[k + 1], (*corners)[k + 2]});
  return result;
}

}  // namespace vpm
