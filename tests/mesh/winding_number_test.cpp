#include "libvpm/mesh/winding_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "libvpm/synthetic/shapes.h"

namespace vpm {
namespace {

// Error of the approximation of far groups: a fifth of the difference that decides.
constexpr double kApproximation = 0.1;

Solid joined(Solid a, const Solid& b, bool reverse) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) {
    if (reverse) {
      a.triangles.push_back({j + offset, i + offset, k + offset});
    } else {
      a.triangles.push_back({i + offset, j + offset, k + offset});
    }
  }
  return a;
}

TEST(WindingNumber, CountsHowOftenAPointIsEnclosed) {
  const Solid large = synthetic::make_cube(2), small = synthetic::make_icosphere(0.5, 2);
  const struct {
    Solid solid;
    double in_both, in_large;
  } cases[] = {{joined(large, small, false), 2, 1}, {joined(large, small, true), 0, 1}};
  for (const auto& c : cases) {
    const TriangleBvh bvh(c.solid.vertices, c.solid.triangles);
    const WindingNumber winding(bvh);
    EXPECT_NEAR(winding.at({0.1, 0.05, -0.2}), c.in_both, kApproximation);
    EXPECT_NEAR(winding.at({0.8, 0.7, -0.9}), c.in_large, kApproximation);
    EXPECT_NEAR(winding.at({1.2, 0.7, -0.9}), 0, kApproximation);
    EXPECT_EQ(winding.inside({0.1, 0.05, -0.2}), c.in_both != 0);
  }
}

// Two sheets that lie on one another and face apart enclose nothing, not even points on them.
TEST(WindingNumber, FoldedSheetsEncloseNothing) {
  std::mt19937_64 engine(2);
  const auto lattice = [&] { return 0.05 * static_cast<double>(engine() % 9) - 0.2; };
  for (int k = 0; k < 1000; ++k) {
    const Vec3 a{lattice(), lattice(), lattice()}, b{lattice(), lattice(), lattice()},
        c{lattice(), lattice(), lattice()};
    if (norm(cross(b - a, c - a)) < 1e-6) continue;
    const Solid sheet{{a, b, c}, {{0, 1, 2}, {0, 2, 1}}};
    const TriangleBvh bvh(sheet.vertices, sheet.triangles);
    const WindingNumber winding(bvh);
    for (const double s : {0.25, 0.5}) {
      const Vec3 on_it = a + s * (b - a) + 0.25 * (c - a);
      EXPECT_NEAR(winding.at(on_it), 0, kApproximation) << k;
    }
  }
}

TEST(WindingNumber, TorusAgreesWithItsEquation) {
  const Solid torus = synthetic::make_torus(0.5, 0.2, 200, 80);
  const TriangleBvh bvh(torus.vertices, torus.triangles);
  const WindingNumber winding(bvh);
  std::mt19937_64 engine(4);
  const auto uniform = [&](double size) {
    return size * (static_cast<double>(engine() >> 11) * 0x1p-52 - 1);
  };
  for (int k = 0; k < 3000; ++k) {
    const double x = uniform(0.8), y = uniform(0.8), z = uniform(0.3);
    const double from_ring = std::hypot(std::hypot(x, y) - 0.5, z);
    if (std::abs(from_ring - 0.2) < 1e-3)
      continue;  // skips places between the torus and its facets
    EXPECT_NEAR(winding.at({x, y, z}), from_ring < 0.2 ? 1 : 0, kApproximation);
  }
}

}  // namespace
}  // namespace vpm
