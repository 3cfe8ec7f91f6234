// Solids that packers find hard, made from a seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {  // gives the same with every standard library
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Vec3 in_box(Vec3 low, Vec3 high) {
    const double x = uniform(low.x, high.x), y = uniform(low.y, high.y);
    return {x, y, uniform(low.z, high.z)};
  }
  Rotation rotation() {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    return rotation_from_unit({x, y, z, uniform(0.1, 1)});
  }

 private:
  static Rotation rotation_from_unit(Quaternion q) {
    const double n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return rotation_from_quaternion({q.x / n, q.y / n, q.z / n, q.w / n});
  }
  std::mt19937_64 engine_;
};

inline Solid shifted(Solid solid, Vec3 by) {
  for (Vec3& p : solid.vertices) p += by;
  return solid;
}
inline Solid moved(Solid solid, const Rotation& turn, Vec3 shift) {
  for (Vec3& p : solid.vertices) p = turn * p + shift;
  return solid;
}

inline Solid reversed(Solid solid) {
  for (Triangle& t : solid.triangles) std::swap(t[0], t[1]);
  return solid;
}

// Returns both meshes in one: a union, a cavity or two components, depending on where they lie.
inline Solid joined(Solid a, const Solid& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles)
    a.triangles.push_back({i + offset, j + offset, k + offset});
  return a;
}

inline constexpr int kFamilies = 8;

// Returns a solid of the family: 0 self-intersecting union, 1 plate, 2 needle, 3 cavity, 4 torus, 5
// two components, 6 nested shells (a ball in the cavity of a box), 7 genus 2 (two tori that meet)
// or a torus knot.
inline Solid random_solid(int family, std::uint64_t seed) {
  Random random(seed * kFamilies + static_cast<std::uint64_t>(family));
  const auto length = [&] { return random.uniform(0.3, 1); };
  const auto box = [&] { return synthetic::make_box(length(), length(), length()); };
  const Rotation turn = random.rotation();
  const Vec3 shift = random.in_box({-3, -3, -3}, {3, 3, 3});
  switch (family) {
    case 0: {
      const Solid second = moved(synthetic::make_octahedron(length()), random.rotation(),
                                 random.in_box({-.3, -.3, -.3}, {.3, .3, .3}));
      return moved(joined(joined(box(), moved(box(), random.rotation(), {.2, .1, 0})), second),
                   turn, shift);
    }
    case 1: {
      const double thin = std::pow(10, random.uniform(-2.5, -1.3));
      return moved(synthetic::make_box(length(), length(), thin * length()), turn, shift);
    }
    case 2: {
      const double thin = std::pow(10, random.uniform(-3, -1.5));
      return moved(synthetic::make_box(length(), thin * length(), thin * length()), turn, shift);
    }
    case 3: {
      const double edge = length();
      const Solid hole =
          moved(reversed(synthetic::make_icosphere(0.4 * edge, 1)), random.rotation(), {});
      return moved(joined(synthetic::make_box(edge, edge, edge), hole), turn, shift);
    }
    case 4:
      return moved(synthetic::make_torus(0.5, random.uniform(0.05, 0.2), 24, 9), turn, shift);
    case 6: {
      const double edge = length();
      const Solid hole = reversed(synthetic::make_icosphere(0.45 * edge, 1));
      const Solid core = synthetic::make_icosphere(random.uniform(0.1, 0.3) * edge, 1);
      return moved(joined(joined(synthetic::make_cube(edge), hole), core), turn, shift);
    }
    case 7: {
      if (seed % 2 == 0) {
        return moved(synthetic::make_torus_knot(2, 3, 0.5, 0.2, random.uniform(0.02, 0.08), 60, 5),
                     turn, shift);
      }
      const Solid ring = synthetic::make_torus(0.4, random.uniform(0.08, 0.2), 20, 7);
      return moved(joined(ring, moved(ring, random.rotation(), {0.4, 0, 0})), turn, shift);
    }
    default:
      return moved(joined(box(), moved(box(), random.rotation(), {3, 1, 0})), turn, shift);
  }
}

// Returns the solid as a file of it would be read.
inline RawMesh raw(const Solid& solid) {
  RawMesh mesh;
  mesh.format = MeshFormat::off;
  mesh.name = "test";
  mesh.vertices = solid.vertices;
  for (const Triangle& t : solid.triangles) mesh.add_triangle(t);
  return mesh;
}

inline bool same_bytes(const std::vector<Sphere>& a, const std::vector<Sphere>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Sphere)) == 0;
}

}  // namespace vpm::test
