// Work and truth of the searches over a mesh with itself: contacts, shells, cutting, welding.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/overlap_tree.h"
#include "libvpm/mesh/predicates.h"
#include "libvpm/mesh/ray_crossings.h"
#include "libvpm/mesh/self_intersection.h"
#include "libvpm/mesh/weld.h"
#include "libvpm/mesh/winding_number.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

using synthetic::make_cube;

// Returns two fans of n triangles over one circle.
Solid double_cone(std::uint32_t n, double height) {
  Solid solid{{{0, 0, height}, {0, 0, -height}}, {}};
  for (std::uint32_t k = 0; k < n; ++k) {
    const double angle = 2 * M_PI * k / n;
    solid.vertices.push_back({std::cos(angle), std::sin(angle), 0});
    const std::uint32_t a = 2 + k, b = 2 + (k + 1) % n;
    solid.triangles.push_back({0, a, b});
    solid.triangles.push_back({1, b, a});
  }
  return solid;
}

Solid turned(Solid solid) {
  const Vec3 x{0.36, 0.48, -0.8}, y{-0.8, 0.6, 0}, z{0.48, 0.64, 0.6};
  for (Vec3& p : solid.vertices) p = p.x * x + p.y * y + p.z * z;
  return solid;
}

Solid cubes(int n, const std::function<Solid(int)>& cube) {
  Solid all;
  for (int k = 0; k < n; ++k) {
    const Solid one = cube(k);
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), one.vertices.begin(), one.vertices.end());
    for (const auto& [a, b, c] : one.triangles)
      all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

std::uint64_t work_of_contacts(const Solid& solid) {
  std::uint64_t work = 0;
  find_contacts(solid.vertices, solid.triangles, {}, &work);
  return work;
}

std::vector<TrianglePair> all_pairs(const Solid& solid) {
  std::vector<TrianglePair> pairs;
  for (std::uint32_t i = 0; i < solid.triangles.size(); ++i) {
    for (std::uint32_t j = i + 1; j < solid.triangles.size(); ++j) {
      const auto corner = [&](std::uint32_t t, std::size_t k) {
        return solid.vertices[solid.triangles[t][k]];
      };
      if (has_area(corner(i, 0), corner(i, 1), corner(i, 2)) &&
          has_area(corner(j, 0), corner(j, 1), corner(j, 2)) &&
          triangles_intersect(solid.vertices, solid.triangles[i], solid.triangles[j]))
        pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

// Returns a fan of triangles around a vertex that cross one another, lie in one plane or share
// edges, and some others.
Solid tangled_fan(unsigned seed) {
  std::mt19937 random(seed);
  const auto coordinate = [&] { return static_cast<double>(random() % 17) / 4 - 2; };
  Solid solid{{{0.25, 0.5, 0.125}}, {}};
  const bool flat = seed % 3 == 0;
  for (std::uint32_t k = 0; k < 60; ++k) {
    const double z = flat ? 0.125 : coordinate();
    solid.vertices.push_back({coordinate(), coordinate(), z});
  }
  for (int k = 0; k < 100; ++k) {
    const auto any = [&] { return 1 + static_cast<std::uint32_t>(random() % 60); };
    const Triangle t{k < 80 ? 0 : any(), any(), any()};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) solid.triangles.push_back(t);
  }
  return solid;
}

TEST(BroadPhase, FindsWhatAllPairsFindInTangledFans) {
  for (unsigned seed = 0; seed < 24; ++seed) {
    const Solid solid = tangled_fan(seed);
    const std::vector<TrianglePair> truth = all_pairs(solid);
    EXPECT_EQ(find_self_intersections(solid.vertices, solid.triangles), truth) << seed;
    const auto contacts = find_contacts(solid.vertices, solid.triangles);
    EXPECT_EQ(intersecting(contacts, solid.vertices, solid.triangles), truth) << seed;
  }
}

TEST(BroadPhase, FindsAllPairsOfLongThinTriangles) {
  std::mt19937 random(5);
  const auto coordinate = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  Solid solid;
  for (std::uint32_t k = 0; k < 300; ++k) {
    const Vec3 a{coordinate(), coordinate(), coordinate()};
    const Vec3 thin{1e-3 * coordinate(), 1e-3 * coordinate(), 1e-3 * coordinate()};
    solid.vertices.insert(solid.vertices.end(),
                          {a, {coordinate(), coordinate(), coordinate()}, a + 30 * thin});
    solid.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const std::vector<TrianglePair> truth = all_pairs(solid);
  EXPECT_GT(truth.size(), 20U);
  EXPECT_EQ(find_self_intersections(solid.vertices, solid.triangles), truth);
}

// Expects work that grows by less than 2.7 from n to 2 n, as n log n does.
void expect_near_linear(const std::function<std::uint64_t(std::uint32_t)>& work_of,
                        std::uint32_t n) {
  const std::uint64_t once = work_of(n), twice = work_of(2 * n), four = work_of(4 * n);
  EXPECT_LT(twice, 27 * once / 10);
  EXPECT_LT(four, 27 * twice / 10);
}

TEST(BroadPhase, WorkIsNearLinearInTheTrianglesOfAFan) {
  for (const double height : {0.1, 1.0, 10.0}) {
    expect_near_linear([&](std::uint32_t n) { return work_of_contacts(double_cone(n, height)); },
                       1000);
    expect_near_linear(
        [&](std::uint32_t n) { return work_of_contacts(turned(double_cone(n, height))); }, 1000);
  }
}

TEST(BroadPhase, WorkIsNearLinearInTheBodiesOfAFile) {
  const auto grid = [](std::uint32_t n) {
    return work_of_contacts(cubes(static_cast<int>(n), [](int k) {
      return moved(make_cube(1), {2.0 * (k % 10), 2.0 * (k / 10 % 10), 2.0 * (k / 100)});
    }));
  };
  expect_near_linear(grid, 200);
}

TEST(BroadPhase, RoundsStopAtTheLimitWhereverThreadsAre) {
  std::vector<std::size_t> stops;
  for (int repeat = 0; repeat < 3; ++repeat) {
    WorkLimit limit(0);
    std::size_t last = 0;
    const bool complete = run_within(
        limit, 100'000, [](std::size_t k) { return 10'000 + k % 7; },
        [&](double done) { last = static_cast<std::size_t>(100'000 * done); });
    EXPECT_FALSE(complete);
    EXPECT_GT(limit.done(), limit.most());
    stops.push_back(last);
  }
  EXPECT_EQ(stops[0], stops[1]);
  EXPECT_EQ(stops[0], stops[2]);
  WorkLimit enough(0);
  EXPECT_TRUE(run_within(enough, 1000, [](std::size_t) { return 1; }));
}

RawMesh raw(const Solid& solid) {
  RawMesh mesh;
  mesh.name = "parts.obj";
  mesh.vertices = solid.vertices;
  for (const Triangle& t : solid.triangles) mesh.add_triangle(t);
  return mesh;
}

// More partners than a search kept before: the solid is one cube.
TEST(BroadPhase, ManyEqualBodiesAreOne) {
  const CheckedSolid checked = make_solid(raw(cubes(120, [](int) { return make_cube(1); })));
  EXPECT_NEAR(checked.facts.volume, 1, 1e-9);
}

TEST(BroadPhase, TooManyMeetingTrianglesAreRefusedWithAPlace) {
  const std::string error =
      refusal([] { make_solid(raw(cubes(3000, [](int k) { return make_cube(1 + 1e-13 * k); }))); });
  EXPECT_NE(error.find("parts.obj"), std::string::npos) << error;
  EXPECT_NE(error.find("too many places"), std::string::npos) << error;
  EXPECT_NE(error.find("delete doubled"), std::string::npos) << error;
}

// A nest of cubes has cavities at every other depth if the file faces neighbours differently.
TEST(BroadPhase, NestedShellsAreCounted) {
  Solid nest = cubes(200, [](int k) {
    const Solid cube = turned(make_cube(1 + 0.01 * k));
    return k % 2 == 0 ? turned_over(cube) : cube;
  });
  const CheckedSolid checked = make_solid(raw(nest));
  EXPECT_EQ(checked.facts.shells, 200U);
  EXPECT_EQ(checked.facts.cavities, 100U);
}

TEST(RayCrossings, AgreeWithWindingNumbers) {
  Solid torus = turned(synthetic::make_torus(1, 0.4, 30, 20));
  const RayCrossings rays(torus.vertices, torus.triangles);
  const TriangleBvh bvh(torus.vertices, torus.triangles);
  const WindingNumber winding(bvh);
  std::mt19937 random(7);
  const auto coordinate = [&] { return static_cast<double>(random() % 3001) / 1000 - 1.5; };
  int inside = 0;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 x{coordinate(), coordinate(), coordinate()};
    int number = 0;
    bool doubtful = false;
    rays.from(x, [&](std::uint32_t, Crossing crossing) {
      doubtful = doubtful || crossing == Crossing::doubtful;
      number += crossing == Crossing::outward ? 1 : -1;
    });
    EXPECT_FALSE(doubtful);
    EXPECT_NEAR(number, winding.at(x), 0.1);
    inside += number;
  }
  EXPECT_GT(inside, 100);
  // On a vertex, an edge and a face.
  const auto [a, b, c] = torus.triangles[5];
  const Vec3 p = torus.vertices[a], q = torus.vertices[b], r = torus.vertices[c];
  for (const Vec3 x : {p, 0.5 * (p + q), (p + q + r) / 3}) {
    EXPECT_EQ(RayCrossings::crossing(x, p, q, r), Crossing::doubtful);
  }
}

// A tolerance that far vertices cannot resolve joins equal ones only there, and takes time linear
// in their number.
TEST(Weld, FarVerticesNeedNoRangeOfIntegers) {
  std::vector<Vec3> vertices{{0, 0, 0}, {0.5e-6, 0, 0}, {1, 0, 0}};
  for (int k = 0; k < 40'000; ++k) {
    const double far = 1e20 + 1e16 * k;
    vertices.push_back({far, -far, k % 2 == 0 ? 1e300 : -1e300});
  }
  for (int k = 0; k < 40'000; ++k) vertices.push_back({1e-3 * k, 7, 7});
  vertices.push_back(vertices[10]);
  std::vector<Triangle> triangles{{0, 1, 2}};
  EXPECT_EQ(weld(vertices, 1e-6, triangles).joined_vertices, 2U);
  EXPECT_EQ(weld(vertices, 1e-300, triangles).joined_vertices, 1U);
}

}  // namespace
}  // namespace vpm::test
