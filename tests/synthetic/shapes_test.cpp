#include "libvpm/synthetic/shapes.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <sstream>

#include "libvpm/model/sphere.h"
#include "tests/temporary_folder.h"

namespace vpm::synthetic {
namespace {

// True if every directed edge has exactly one partner in the other direction.
bool is_closed_and_oriented(const Solid& solid) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : solid.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end() || back->second != 1) return false;
  }
  return !edges.empty();
}

struct Shape {
  const char* name;
  Solid solid;
  double volume, tolerance;  // relative to the volume
};

double trefoil_length(double ring, double coil) {
  constexpr int kSteps = 10000;
  double length = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double around = 2 * (ring + coil * std::cos(3 * 2 * kPi * i / kSteps));
    length += 2 * kPi / kSteps * std::sqrt(9 * coil * coil + around * around);
  }
  return length;
}

std::vector<Shape> shapes() {
  const double torus = 2 * kPi * kPi * 0.3 * 0.01, tube = 2 * kPi * 0.3 * 0.01;
  return {{"cube", make_cube(2), 8, 1e-14},
          {"needle", make_box(1e-3, 2e-3, 3), 6e-6, 1e-14},
          {"tetrahedron", make_tetrahedron(2), 8 / (6 * std::sqrt(2.0)), 1e-14},
          {"octahedron", make_octahedron(2), 8 * std::sqrt(2.0) / 3, 1e-14},
          {"icosphere", make_icosphere(0.5, 4), kPi / 6, 5e-3},
          {"torus", make_torus(0.3, 0.1, 128, 64), torus, 5e-3},
          {"twisted torus", make_twisted_torus(0.3, 0.1, 3, 256), tube, 1e-2},
          // A tube holds the area of its section times the length of its core.
          {"trefoil", make_torus_knot(2, 3, 0.3, 0.1, 0.03, 512, 64),
           kPi * 0.03 * 0.03 * trefoil_length(0.3, 0.1), 5e-3},
          {"untwisted torus", make_twisted_torus(0.3, 0.1, 0, 256), tube, 5e-3}};
}

TEST(Shapes, AreClosedOutwardAndHaveTheirVolume) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    EXPECT_TRUE(is_closed_and_oriented(shape.solid));
    const MassProperties mass = mass_properties(shape.solid);
    EXPECT_NEAR(mass.volume, shape.volume, shape.tolerance * shape.volume);
    EXPECT_LT(norm(mass.center_of_mass), 2e-3 * bounding_radius(shape.solid, {}));
  }
}

TEST(Shapes, OffFileHoldsEveryBit) {
  const Solid solid = make_twisted_torus(0.06, 0.03, 2, 32);
  const file::TemporaryFolder folder;
  write_off(folder.path("shape.off"), solid);
  std::istringstream in(test::text_of(folder.path("shape.off")));
  std::string magic;
  std::size_t vertices = 0, triangles = 0, edges = 0;
  in >> magic >> vertices >> triangles >> edges;
  ASSERT_EQ(vertices, solid.vertices.size());
  ASSERT_EQ(triangles, solid.triangles.size());
  for (const Vec3& v : solid.vertices) {
    Vec3 read;
    in >> read.x >> read.y >> read.z;
    EXPECT_EQ(read, v);
  }
}

}  // namespace
}  // namespace vpm::synthetic
