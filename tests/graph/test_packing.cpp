#include "tests/graph/test_packing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libvpm/synthetic/shapes.h"

namespace vpm::test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
  Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
};

Box box_of(const Solid& solid) {
  Box box;
  for (const Vec3& v : solid.vertices) {
    box.low = {std::min(box.low.x, v.x), std::min(box.low.y, v.y), std::min(box.low.z, v.z)};
    box.high = {std::max(box.high.x, v.x), std::max(box.high.y, v.y), std::max(box.high.z, v.z)};
  }
  return box;
}

struct Candidate {
  Vec3 at;
  double radius;
};

std::vector<Candidate> candidates_in(const Shape& shape, double count) {
  const Box box = box_of(shape.solid);
  const Vec3 extent = box.high - box.low;
  const double step = std::cbrt(extent.x * extent.y * extent.z / count);
  std::vector<Candidate> found;
  for (double x = box.low.x + 0.5 * step; x < box.high.x; x += step) {
    for (double y = box.low.y + 0.5 * step; y < box.high.y; y += step) {
      for (double z = box.low.z + 0.5 * step; z < box.high.z; z += step) {
        const double depth = shape.depth({x, y, z});
        if (depth > 0) found.push_back({{x, y, z}, depth});
      }
    }
  }
  return found;
}

}  // namespace

double Numbers::uniform(double low, double high) {
  std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return low + (high - low) * (static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

Vec3 Numbers::direction() {
  for (;;) {
    const Vec3 v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    if (squared_norm(v) <= 1 && squared_norm(v) > 0.01) return v / norm(v);
  }
}

Shape convex(std::string name, Solid solid) {
  std::vector<std::pair<Vec3, double>> planes;
  for (const Triangle& t : solid.triangles) {
    const Vec3 a = solid.vertices[t[0]];
    const Vec3 n = normalized_or_zero(cross(solid.vertices[t[1]] - a, solid.vertices[t[2]] - a));
    planes.push_back({n, dot(n, a)});
  }
  const auto depth = [planes](Vec3 p) {
    double least = kInfinity;
    for (const auto& [n, offset] : planes) least = std::min(least, offset - dot(n, p));
    return least;
  };
  return {std::move(name), std::move(solid), depth};
}

Shape cube() {
  return convex("cube", synthetic::make_cube(0.2));
}
Shape tetrahedron() {
  return convex("tetrahedron", synthetic::make_tetrahedron(0.2));
}
Shape octahedron() {
  return convex("octahedron", synthetic::make_octahedron(0.2));
}

Shape torus() {
  constexpr double kRing = 0.07, kTube = 0.03;
  constexpr int kAround = 96, kAcross = 48;
  // The facets lie inside the round torus by their sagittas at most.
  const double inner =
      kTube * std::cos(kPi / kAcross) - (kRing + kTube) * (1 - std::cos(kPi / kAround));
  const auto depth = [inner](Vec3 p) {
    return inner - std::hypot(std::hypot(p.x, p.y) - kRing, p.z);
  };
  return {"torus", synthetic::make_torus(kRing, kTube, kAround, kAcross), depth};
}

Shape plate() {
  return convex("plate", synthetic::make_box(0.2, 0.2, 0.004));
}

Shape wedge() {
  const double length = 0.2, height = length * std::tan(kPi / 12), half = 0.05;
  Solid solid;
  for (const double z : {-half, half})
    for (const Vec3 corner : {Vec3{0, 0, z}, Vec3{length, 0, z}, Vec3{length, height, z}})
      solid.vertices.push_back(corner);
  solid.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                     {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  return convex("wedge", solid);
}

Shape ball() {
  return convex("ball", synthetic::make_icosphere(0.1, 3));
}

Packing greedy_packing(const Shape& shape, std::size_t spheres, double candidates) {
  std::vector<Candidate> free = candidates_in(shape, candidates);
  Packing packing{{}, shape.solid, {}};
  while (packing.spheres.size() < spheres && !free.empty()) {
    const Candidate best = *std::max_element(
        free.begin(), free.end(),
        [](const Candidate& a, const Candidate& b) { return a.radius < b.radius; });
    const double radius = best.radius * (1 - 1e-12);
    packing.spheres.push_back({best.at, radius});
    for (Candidate& c : free) c.radius = std::min(c.radius, norm(c.at - best.at) - radius);
    std::erase_if(free, [](const Candidate& c) { return !(c.radius > 0); });
  }
  return packing;
}

double volume_below(const Solid& solid, Vec3 normal, double offset) {
  // Sums cones over the clipped triangles from a point of the plane, so that the cut itself adds
  // nothing.
  const Vec3 apex = normal * (offset / squared_norm(normal));
  double sum = 0;
  for (const Triangle& t : solid.triangles) {
    std::vector<Vec3> clipped;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = solid.vertices[t[k]], b = solid.vertices[t[(k + 1) % 3]];
      const double da = dot(normal, a) - offset, db = dot(normal, b) - offset;
      if (da < 0) clipped.push_back(a);
      if ((da < 0) != (db < 0)) clipped.push_back(a + (da / (da - db)) * (b - a));
    }
    for (std::size_t k = 2; k < clipped.size(); ++k) {
      sum += dot(clipped[0] - apex, cross(clipped[k - 1] - apex, clipped[k] - apex));
    }
  }
  return sum / 6;
}

}  // namespace vpm::test
