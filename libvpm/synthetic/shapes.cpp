#include "libvpm/synthetic/shapes.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/model/sphere.h"

namespace vpm::synthetic {
namespace {

using Index = std::uint32_t;

// Adds a quadrilateral, corners counter-clockwise from outside, as two triangles.
void add_quad(Solid& solid, Index a, Index b, Index c, Index d) {
  solid.triangles.push_back({a, b, c});
  solid.triangles.push_back({a, c, d});
}

// Connects a ring of closed profiles. Vertex (i, j) has index i * across + j; after one turn the
// profile's corners meet those `shift` further. Increasing i, then j, must be counter-clockwise.
void connect_ring(Solid& solid, Index around, Index across, Index shift) {
  for (Index i = 0; i < around; ++i) {
    const bool last = i + 1 == around;
    const Index next = last ? 0 : i + 1, turn = last ? shift : 0;
    for (Index j = 0; j < across; ++j) {
      const Index k = (j + 1) % across;
      add_quad(solid, i * across + j, next * across + (j + turn) % across,
               next * across + (k + turn) % across, i * across + k);
    }
  }
}

Solid icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;  // golden ratio
  Solid s;
  s.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  s.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  return s;
}

Solid subdivided(const Solid& coarse) {
  Solid fine;
  fine.vertices = coarse.vertices;
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, fresh] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                    static_cast<Index>(fine.vertices.size()));
    if (fresh) fine.vertices.push_back(0.5 * (coarse.vertices[a] + coarse.vertices[b]));
    return entry->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    for (const Triangle& t : {Triangle{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
      fine.triangles.push_back(t);
  }
  return fine;
}

}  // namespace

Solid make_box(double a, double b, double c) {
  Solid s;
  for (int corner = 0; corner < 8; ++corner) {
    s.vertices.push_back({(corner & 1 ? 0.5 : -0.5) * a, (corner & 2 ? 0.5 : -0.5) * b,
                          (corner & 4 ? 0.5 : -0.5) * c});
  }
  add_quad(s, 0, 2, 3, 1);
  add_quad(s, 4, 5, 7, 6);
  add_quad(s, 0, 1, 5, 4);
  add_quad(s, 2, 6, 7, 3);
  add_quad(s, 0, 4, 6, 2);
  add_quad(s, 1, 3, 7, 5);
  return s;
}

Solid make_cube(double edge) {
  return make_box(edge, edge, edge);
}

Solid make_tetrahedron(double edge) {
  const double base = edge / std::sqrt(3.0), height = edge * std::sqrt(2.0 / 3.0);
  const double low = -height / 4;  // the centroid lies a quarter of the height above a face
  Solid s;
  s.vertices = {{base, 0, low},
                {-base / 2, edge / 2, low},
                {-base / 2, -edge / 2, low},
                {0, 0, low + height}};
  s.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return s;
}

Solid make_octahedron(double edge) {
  const double r = edge / std::sqrt(2.0);
  Solid s;
  s.vertices = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  s.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                 {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return s;
}

Solid make_icosphere(double radius, int subdivisions) {
  Solid s = icosahedron();
  for (int k = 0; k < subdivisions; ++k) s = subdivided(s);
  for (Vec3& v : s.vertices) v = radius * normalized_or_zero(v);
  return s;
}

Solid make_torus(double ring_radius, double tube_radius, int around, int across) {
  Solid s;
  for (int i = 0; i < around; ++i) {
    const double a = 2 * kPi * i / around;
    for (int j = 0; j < across; ++j) {
      const double b = 2 * kPi * j / across, r = ring_radius + tube_radius * std::cos(b);
      s.vertices.push_back({r * std::cos(a), r * std::sin(a), tube_radius * std::sin(b)});
    }
  }
  connect_ring(s, static_cast<Index>(around), static_cast<Index>(across), 0);
  return s;
}

Solid make_twisted_torus(double ring_radius, double edge, int quarter_turns, int around) {
  const double corner = edge / std::sqrt(2.0);
  Solid s;
  for (int i = 0; i < around; ++i) {
    const double a = 2 * kPi * i / around, twist = quarter_turns * kPi / 2 * i / around;
    for (int j = 0; j < 4; ++j) {
      const double b = kPi / 4 + kPi / 2 * j + twist, r = ring_radius + corner * std::cos(b);
      s.vertices.push_back({r * std::cos(a), r * std::sin(a), corner * std::sin(b)});
    }
  }
  connect_ring(s, static_cast<Index>(around), 4, static_cast<Index>(((quarter_turns % 4) + 4) % 4));
  return s;
}

Solid make_torus_knot(int p, int q, double ring_radius, double coil_radius, double tube_radius,
                      int around, int across) {
  Solid s;
  for (int i = 0; i < around; ++i) {
    const double t = 2 * kPi * i / around, a = p * t, b = q * t;
    const double r = ring_radius + coil_radius * std::cos(b), dr = -coil_radius * q * std::sin(b);
    const Vec3 center{r * std::cos(a), r * std::sin(a), coil_radius * std::sin(b)};
    const Vec3 along{dr * std::cos(a) - r * p * std::sin(a), dr * std::sin(a) + r * p * std::cos(a),
                     coil_radius * q * std::cos(b)};
    // The knot lies on a torus, whose normal returns to itself after one turn.
    const Vec3 out{std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)};
    const Vec3 side = normalized_or_zero(cross(out, along));
    for (int j = 0; j < across; ++j) {
      const double c = 2 * kPi * j / across;
      s.vertices.push_back(center + tube_radius * (std::cos(c) * out + std::sin(c) * side));
    }
  }
  connect_ring(s, static_cast<Index>(around), static_cast<Index>(across), 0);
  return s;
}

void write_off(const std::string& path, const Solid& solid) {
  std::string text = "OFF\n" + std::to_string(solid.vertices.size()) + " " +
                     std::to_string(solid.triangles.size()) + " 0\n";
  char line[128];
  for (const Vec3& v : solid.vertices) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", v.x, v.y, v.z);
    text += line;
  }
  for (const auto& [a, b, c] : solid.triangles) {
    std::snprintf(line, sizeof line, "3 %u %u %u\n", a, b, c);
    text += line;
  }
  file::write_all(path, std::string_view(text));
}

}  // namespace vpm::synthetic
