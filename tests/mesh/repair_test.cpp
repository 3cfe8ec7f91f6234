// Repairs: holes filled where that is safe, or a new surface from voxels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/mesh/holes.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/voxel_repair.h"
#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_torus;

// Returns the solid without the triangles whose corners all lie above the height.
Solid cut_open(Solid solid, double height) {
  std::erase_if(solid.triangles, [&](const Triangle& t) {
    return solid.vertices[t[0]].z > height && solid.vertices[t[1]].z > height &&
           solid.vertices[t[2]].z > height;
  });
  return solid;
}

SolidOptions repair(Repair how, int voxels = 48) {
  SolidOptions options;
  options.repair = how;
  options.repair_voxels = voxels;
  return options;
}

TEST(BoundaryLoops, GoAroundEachHole) {
  Solid cube = make_cube(2);  // without top and bottom
  std::erase_if(cube.triangles, [&](const Triangle& t) {
    const double z = cube.vertices[t[0]].z;
    return cube.vertices[t[1]].z == z && cube.vertices[t[2]].z == z;
  });
  const Topology topology = topology_of(cube.vertices.size(), cube.triangles);
  const auto loops = boundary_loops(topology, cube.triangles);
  ASSERT_EQ(loops.size(), 2U);
  for (const BoundaryLoop& loop : loops) {
    EXPECT_TRUE(loop.closed);
    ASSERT_EQ(loop.vertices.size(), 4U);
    Vec3 normal;  // the missing face's
    const double z = cube.vertices[loop.vertices[0]].z;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 p = cube.vertices[loop.vertices[k]], q = cube.vertices[loop.vertices[(k + 1) % 4]];
      EXPECT_EQ(p.z, z);
      normal += cross(p - Vec3{0, 0, z}, q - Vec3{0, 0, z});
    }
    EXPECT_GT(normal.z * z, 0);
  }
}

TEST(BoundaryLoops, HolesThatTouchInAVertexAreTwo) {
  // A flat sheet of 4 x 4 squares lacks two that meet in a corner.
  Solid sheet;
  for (std::uint32_t i = 0; i < 25; ++i) sheet.vertices.push_back({i % 5 * 1.0, i / 5 * 1.0, 0});
  for (std::uint32_t i = 0; i < 4; ++i) {
    for (std::uint32_t j = 0; j < 4; ++j) {
      if (i == j && (i == 1 || i == 2)) continue;
      const std::uint32_t a = 5 * i + j;
      sheet.triangles.push_back({a, a + 1, a + 6});
      sheet.triangles.push_back({a, a + 6, a + 5});
    }
  }
  const Topology topology = topology_of(sheet.vertices.size(), sheet.triangles);
  const auto loops = boundary_loops(topology, sheet.triangles);
  std::size_t edges = 0;
  for (const BoundaryLoop& loop : loops) edges += loop.vertices.size();
  EXPECT_EQ(edges, topology.boundary.size());
  ASSERT_EQ(loops.size(), 3U);
  EXPECT_EQ(loops[0].vertices.size(), 16U);
}

TEST(MeshRefusal, NamesTheLoopOfEachHole) {
  Solid cube = make_cube(2);
  cube.triangles.erase(cube.triangles.begin());
  const std::string one = refusal_of(cube);
  EXPECT_TRUE(
      contains(one, "the mesh is open: 3 edges of one triangle in 1 hole, a loop through ("))
      << one;
  Solid five = make_cube(2);
  for (int k = 1; k < 5; ++k) five = together(five, moved(make_cube(2), {3.0 * k, 0, 0}));
  for (std::size_t k = 0; k < 5; ++k)
    five.triangles.erase(five.triangles.begin() + static_cast<std::ptrdiff_t>(11 * k));
  EXPECT_TRUE(contains(refusal_of(five), "5 holes, the largest a loop of 3 edges through ("))
      << refusal_of(five);
}

constexpr std::size_t kLongest = 200;  // columns of a message

// Places whose text takes as much as one can.
Solid with_long_coordinates(Solid solid) {
  for (Vec3& p : solid.vertices)
    p = {-0.0123456 * (1.3 + p.x), -0.0154321 * (1.7 + p.y), -0.0133337 * (1.9 + p.z)};
  return solid;
}

TEST(MeshRefusal, IsShortForManyDefects) {
  Solid many = with_long_coordinates(make_icosphere(1, 3));  // 1280 triangles
  for (std::size_t k = many.triangles.size(); k-- > 0;)
    if (k % 17 == 0) many.triangles.erase(many.triangles.begin() + static_cast<std::ptrdiff_t>(k));
  EXPECT_LE(refusal_of(many).size(), kLongest) << refusal_of(many);
  for (std::uint32_t k = 0; k < 200; ++k) many.triangles.push_back({k, k + 200, k + 400});
  for (std::size_t k = 0; k < 100; ++k) many.triangles.push_back(many.triangles[7 * k]);
  const std::string refusal = refusal_of(many);
  EXPECT_TRUE(contains(refusal, "non-manifold")) << refusal;
  EXPECT_LE(refusal.size(), kLongest + 150) << refusal;
}

TEST(MeshWarning, IsShortForManyIntersections) {
  Solid crossing = make_icosphere(1, 3);
  for (int k = 1; k < 4; ++k)
    crossing = together(crossing, moved(make_icosphere(1, 3), {0.3 * k, 0.2 * k, 0.1 * k}));
  const CheckedSolid checked = solid_of(with_long_coordinates(crossing));
  ASSERT_FALSE(checked.warnings.empty());
  for (const std::string& warning : checked.warnings)
    EXPECT_LE(warning.size(), kLongest) << warning;
}

TEST(RepairHoles, PlanarOnesGiveTheBodyBack) {
  Solid box = synthetic::make_box(1, 2, 3);  // without its top
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return box.vertices[t[0]].z > 0 && box.vertices[t[1]].z > 0 && box.vertices[t[2]].z > 0;
  });
  const CheckedSolid checked = solid_of(box, repair(Repair::holes));
  EXPECT_NEAR(checked.facts.volume, 6, 1e-14);
  EXPECT_EQ(checked.solid.triangles.size(), 12U);
  ASSERT_EQ(checked.facts.filled_holes.size(), 1U);
  EXPECT_TRUE(checked.facts.filled_holes[0].planar);
  EXPECT_EQ(checked.facts.filled_holes[0].edges, 4U);
  EXPECT_EQ(checked.facts.filled_holes[0].center, (Vec3{0, 0, 1.5}));
  ASSERT_EQ(checked.notes.size(), 1U);
  EXPECT_TRUE(contains(checked.notes[0], "planar hole of 4 edges about (0, 0, 1.5)"));
}

TEST(RepairHoles, ARingIsFilledByItsTwoRims) {
  // A tube lacks the ring that closes it on top, which leaves two planar rims, one within the
  // other.
  const auto tube = [](double inner, double outer, int around) {
    Solid solid;
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * kPi * k / around;
      for (const double r : {inner, outer}) {
        for (const double z : {0.0, 1.0})
          solid.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
      }
    }
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
      solid.triangles.push_back({a, b, c});
      solid.triangles.push_back({a, c, d});
    };
    const auto n = static_cast<std::uint32_t>(around);
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = 4 * k, b = 4 * ((k + 1) % n);
      quad(a + 2, b + 2, b + 3, a + 3);  // outside
      quad(b, a, a + 1, b + 1);          // bore
      quad(a, b, b + 2, a + 2);          // bottom
    }
    return solid;
  };
  const CheckedSolid checked = solid_of(tube(0.3, 0.6, 40), repair(Repair::holes));
  EXPECT_EQ(checked.facts.filled_holes.size(), 2U);
  const double polygon = 20 * std::sin(2 * kPi / 40);  // area of a regular polygon in a unit circle
  EXPECT_NEAR(checked.facts.volume, polygon * (0.36 - 0.09), 1e-9);
}

TEST(RepairHoles, SmallOnesAreClosedAndLargeOnesRefused) {
  const Solid ball = make_icosphere(1, 3);
  const CheckedSolid checked = solid_of(cut_open(ball, 0.97), repair(Repair::holes));
  ASSERT_EQ(checked.facts.filled_holes.size(), 1U);
  EXPECT_NEAR(checked.facts.volume, mass_properties(ball).volume, 0.01);
  EXPECT_EQ(checked.facts.euler, 2);

  Solid bent = cut_open(make_icosphere(1, 3), 0.3);
  for (Vec3& p : bent.vertices) p.z += 0.4 * p.x * p.x;
  const std::string message = refusal_of(as_off(bent), "a.off", repair(Repair::holes));
  EXPECT_TRUE(contains(message, "1 hole")) << message;
  EXPECT_TRUE(contains(message, "`repair` voxel")) << message;
}

TEST(RepairHoles, AreFilledWhereTrianglesFaceTheOtherWay) {
  const Solid whole = make_cube(0.2);
  for (std::size_t missing = 0; missing < whole.triangles.size(); ++missing) {
    for (std::size_t turned = 0; turned + 1 < whole.triangles.size(); ++turned) {
      Solid cube = whole;
      cube.triangles.erase(cube.triangles.begin() + static_cast<std::ptrdiff_t>(missing));
      std::swap(cube.triangles[turned][1], cube.triangles[turned][2]);
      EXPECT_NEAR(solid_of(cube, repair(Repair::holes)).facts.volume, 0.008, 1e-12)
          << missing << " " << turned;
    }
  }
}

TEST(RepairHoles, RepeatedTrianglesAreDropped) {
  Solid cube = make_cube(2);
  cube.triangles.push_back(cube.triangles[3]);
  cube.triangles.push_back(turned_over(cube).triangles[5]);
  const CheckedSolid checked = solid_of(cube, repair(Repair::holes));
  EXPECT_EQ(checked.facts.repeated_triangles, 2U);
  EXPECT_DOUBLE_EQ(checked.facts.volume, 8);
}

TEST(SurfaceDistance, OfSpheresIsThatOfTheirRadii) {
  const Solid one = make_icosphere(1, 4), two = make_icosphere(1.25, 4);
  EXPECT_NEAR(farthest_from_surface(two, one, 0.05), 0.25, 5e-3);
  EXPECT_NEAR(farthest_from_surface(one, two, 0.05), 0.25, 5e-3);
  // The distance is one-sided: a part is near the whole, the whole is not near its part.
  const Solid part = cut_open(one, 0);
  EXPECT_EQ(farthest_from_surface(part, one, 0.1), 0);
  EXPECT_GT(farthest_from_surface(one, part, 0.1), 0.9);
}

// No vertex and no point of a triangle is farther, wherever the surfaces lie.
TEST(SurfaceDistance, IsThatOfTheFarthestPlace) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double far : {0.0, 1e6}) {
    for (int k = 0; k < 20; ++k) {
      const auto place = [&] {
        return Vec3{far + uniform(random), uniform(random), uniform(random)};
      };
      const Solid from = moved(make_torus(1, 0.35, 24, 12), place()),
                  to = moved(make_icosphere(0.5 + uniform(random), 2), place());
      const TriangleBvh surface(to.vertices, to.triangles);
      double of_vertices = 0, of_points = 0;
      for (const Vec3& p : from.vertices)
        of_vertices = std::max(of_vertices, surface.closest(p).distance);
      for (const Triangle& t : from.triangles) {
        const double u = uniform(random), v = (1 - u) * uniform(random);
        const Vec3 p =
            (1 - u - v) * from.vertices[t[0]] + u * from.vertices[t[1]] + v * from.vertices[t[2]];
        of_points = std::max(of_points, surface.closest(p).distance);
      }
      const double spacing = 0.02, rounding = 1e-9;
      EXPECT_NEAR(farthest_from_surface(from, to, 10), of_vertices, rounding);
      const double found = farthest_from_surface(from, to, spacing);
      EXPECT_GE(found, of_vertices - rounding);
      EXPECT_GE(found, of_points - spacing);
      EXPECT_LE(found, of_vertices + 0.3) << "an edge of the torus is this long";
      EXPECT_EQ(found, farthest_from_surface(from, to, spacing)) << "in any order of the threads";
    }
  }
}

TEST(RepairByVoxels, AClosedMeshComesBackWithinAVoxel) {
  const Solid torus = make_torus(1, 0.35, 48, 24);
  const CheckedSolid checked = solid_of(torus, repair(Repair::voxel));
  ASSERT_TRUE(checked.facts.voxel_repair);
  const VoxelRepair& done = *checked.facts.voxel_repair;
  EXPECT_NEAR(done.voxel, 2.7 / 48, 1e-3);
  EXPECT_LT(done.solid_to_mesh, done.voxel);
  EXPECT_LT(done.mesh_to_solid, done.voxel);
  EXPECT_EQ(checked.facts.euler, 0);
  EXPECT_EQ(checked.facts.self_intersections, 0U);
  EXPECT_NEAR(checked.facts.volume, mass_properties(torus).volume, 0.03);
}

TEST(RepairByVoxels, ClosesWideHolesWhateverTheOrientation) {
  const Solid ball = make_icosphere(1, 4), open = cut_open(ball, 0.8);
  for (Solid mesh : {open, turned_over(open)}) {
    std::swap(mesh.triangles[100][0],
              mesh.triangles[100][1]);  // turns one triangle against the others
    const CheckedSolid checked = solid_of(mesh, repair(Repair::voxel));
    EXPECT_EQ(checked.facts.euler, 2);
    const double cap = kPi * 0.04 * (3 - 0.2) / 3;
    EXPECT_GT(checked.facts.volume, mass_properties(ball).volume - 1.3 * cap);
    EXPECT_LT(checked.facts.volume, mass_properties(ball).volume);
    EXPECT_GT(checked.facts.voxel_repair->solid_to_mesh, 0.1);
    EXPECT_LT(checked.facts.voxel_repair->mesh_to_solid, checked.facts.voxel_repair->voxel);
  }
}

TEST(RepairByVoxels, FinsVanishAndOverlapsBecomeOneSurface) {
  Solid pair = together(make_cube(2), moved(make_cube(2), {1, 0.9, 0.8}));
  pair.triangles.push_back({0, 1, static_cast<std::uint32_t>(pair.vertices.size())});
  pair.vertices.push_back({-3, -3, -1});  // a fin of one triangle
  const CheckedSolid checked = solid_of(pair, repair(Repair::voxel));
  EXPECT_EQ(checked.facts.shells, 1U);
  EXPECT_EQ(checked.facts.self_intersections, 0U);
  EXPECT_NEAR(checked.facts.volume, 16 - 1.32, 0.2);
  EXPECT_GT(checked.facts.voxel_repair->mesh_to_solid, 1);
}

TEST(RepairByFlood, ClosesWhatIsNarrowWhateverTheOrientation) {
  Solid torus = make_torus(1, 0.35, 48, 24);
  const double volume = mass_properties(torus).volume;
  for (std::size_t k = 0; k < torus.triangles.size(); k += 3)
    std::swap(torus.triangles[k][0], torus.triangles[k][1]);
  for (std::size_t k = 0; k < 3; ++k)
    torus.triangles.erase(torus.triangles.begin() + static_cast<std::ptrdiff_t>(500 * k));
  torus = together(torus, make_icosphere(0.1, 2));  // a body in the hole of the ring
  const CheckedSolid checked = solid_of(torus, repair(Repair::flood));
  EXPECT_EQ(checked.facts.shells, 2U);
  EXPECT_EQ(checked.facts.euler, 2);  // 0 for the torus plus 2 for the ball
  EXPECT_NEAR(checked.facts.volume, volume, 0.02 * volume);
  const VoxelRepair& done = *checked.facts.voxel_repair;
  EXPECT_NEAR(done.max_hole, 2.7 / 16, 0.02);
  EXPECT_LT(done.mesh_to_solid, done.voxel);
  EXPECT_LT(done.solid_to_mesh, done.max_hole);
}

TEST(RepairByFlood, FillsCavitiesAndKeepsConvexEdges) {
  const Solid hollow = together(make_cube(2), turned_over(make_cube(1)));
  const CheckedSolid checked = solid_of(hollow, repair(Repair::flood));
  EXPECT_EQ(checked.facts.shells, 1U);
  EXPECT_NEAR(checked.facts.volume, 8, 0.05);
  EXPECT_LT(checked.facts.voxel_repair->mesh_to_solid, 1.0 + checked.facts.voxel_repair->voxel);
}

TEST(RepairMaxHole, WiderHolesAreRefusedWithTheirPlace) {
  const Solid open = cut_open(make_icosphere(1, 4), 0.8);  // 1.1 m wide
  for (const Repair how : {Repair::voxel, Repair::flood}) {
    SolidOptions options = repair(how, 32);
    options.max_hole = 1;
    const std::string message = refusal_of(as_off(open), "a.off", options);
    EXPECT_TRUE(contains(message, "a.off: a hole is 1.1")) << message;
    EXPECT_TRUE(contains(message, " m wide, more than 1 m, through (")) << message;
    options.max_hole = 1.4;
    const CheckedSolid checked = solid_of(open, options);
    EXPECT_EQ(checked.facts.euler, 2);
    EXPECT_EQ(checked.facts.voxel_repair->max_hole, 1.4);
  }
}

// A ball passes a slit by its width, not by its length.
TEST(RepairMaxHole, IsTheWidthOfTheRim) {
  const std::vector<Vec3> rim{{0, 0, 1}, {10, 10, 1}, {9.9, 10.1, 1}, {-0.1, 0.1, 1}};
  EXPECT_NEAR(width_of({{0, 1, 2, 3}, true}, rim), std::hypot(0.1, 0.1), 1e-12);
  EXPECT_EQ(width_of({{0, 1, 0}, true}, rim), 0);
}

TEST(RepairByVoxels, LengthsAreScaled) {
  SolidOptions options = repair(Repair::voxel, 24);
  const CheckedSolid metres = solid_of(make_cube(2), options);
  options.scale = 0x1p-10;
  const CheckedSolid scaled = solid_of(make_cube(2), options);
  EXPECT_EQ(scaled.facts.voxel_repair->voxel, 0x1p-10 * metres.facts.voxel_repair->voxel);
  EXPECT_EQ(scaled.facts.voxel_repair->mesh_to_solid,
            0x1p-10 * metres.facts.voxel_repair->mesh_to_solid);
  EXPECT_EQ(scaled.facts.volume, 0x1p-30 * metres.facts.volume);
}

TEST(RepairByVoxels, IsTheSameForAnyThreads) {
  const Solid open = cut_open(make_icosphere(1, 3), 0.8);
  VoxelRepair done;
  set_thread_count(1);
  const Solid one = repair_by_winding_number(open, 40, done);
  set_thread_count(8);
  const Solid eight = repair_by_winding_number(open, 40, done);
  set_thread_count(0);
  EXPECT_EQ(one.vertices, eight.vertices);
  EXPECT_EQ(one.triangles, eight.triangles);
}

TEST(RepairByVoxels, RefusesWhatHoldsNoVoxelAndWrongResolutions) {
  const std::string message =
      refusal_of(as_off(synthetic::make_box(1, 1, 1e-3)), "a.off", repair(Repair::voxel, 16));
  EXPECT_TRUE(contains(message, "a.off: no voxel of 1/16")) << message;
  for (const int voxels : {0, -5, 7, 1025}) {
    const auto kind = kind_of_fault([&] { solid_of(make_cube(1), repair(Repair::voxel, voxels)); });
    EXPECT_EQ(kind, ErrorKind::invalid_argument) << voxels;
  }
}

TEST(RealMeshes, BadBunniesAreRepaired) {
  if (shared_mesh("bad_bunny_open.obj").empty()) GTEST_SKIP() << "the shared data is not here";
  const double bunny = 0.00075393;  // volume of the sound bunny, with other fillings below
  const CheckedSolid filled =
      make_solid(read_mesh(shared_mesh("bad_bunny_open.obj")), repair(Repair::holes));
  EXPECT_EQ(filled.facts.filled_holes.size(), 5U);
  EXPECT_NEAR(filled.facts.volume, bunny, 0.01 * bunny);
  for (const char* const name : {"bad_bunny_open.obj", "bad_bunny_nonmanifold.ply"}) {
    const CheckedSolid remeshed = make_solid(read_mesh(shared_mesh(name)), repair(Repair::voxel));
    EXPECT_EQ(remeshed.facts.euler, 2);
    EXPECT_NEAR(remeshed.facts.volume, bunny, 0.02 * bunny);
  }
}

TEST(Repair, ANewSurfaceHasNoVertexOfTheFile) {
  // STL lists each point once for each triangle; the joined ones are gone with the old surface.
  const std::string stl = as_binary_stl(synthetic::make_cube(0.5));
  const CheckedSolid checked = solid_of(stl, "a.stl", repair(Repair::voxel, 16));
  EXPECT_EQ(checked.facts.unused_vertices, 0U);
  for (const std::string& note : checked.notes) EXPECT_FALSE(contains(note, "without a triangle"));
}

TEST(Repair, WhatIsAdvisedMakesTheMeshPass) {
  // The corners of each triangle are off by up to 1e-5 of the size.
  const Solid cube = synthetic::make_cube(0.5);
  std::string soup;
  std::size_t count = 0;
  char line[120];
  for (const Triangle& t : cube.triangles) {
    for (const std::uint32_t corner : t) {
      const Vec3 p = cube.vertices[corner];
      const double off = 5e-6 * static_cast<double>(++count % 3) / 2;
      std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", p.x + off, p.y, p.z - off);
      soup += line;
    }
    soup += "f -3 -2 -1\n";
  }
  const std::string message = refusal_of(soup, "a.obj");
  EXPECT_TRUE(contains(message, "give `weld` 1e-05, which joins")) << message;
  SolidOptions options;
  options.weld = 1e-5;
  EXPECT_NEAR(solid_of(soup, "a.obj", options).facts.volume, 0.125, 1e-5);
}

// Returns a grid of n x n squares over the unit square, z by a function of x and y.
template <class Height>
Solid sheet(int n, const Height& height) {
  Solid solid;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      const double x = double{1} * i / n, y = double{1} * j / n;
      solid.vertices.push_back({x, y, height(x, y)});
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      solid.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      solid.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return solid;
}

// Returns the solid with every triangle apart from the others by this part of its size.
Solid shrunk_triangles(const Solid& solid, double gap) {
  Solid apart;
  for (const Triangle& t : solid.triangles) {
    const Vec3 middle = (solid.vertices[t[0]] + solid.vertices[t[1]] + solid.vertices[t[2]]) / 3;
    Triangle moved{};
    for (std::size_t k = 0; k < 3; ++k) {
      moved[k] = static_cast<std::uint32_t>(apart.vertices.size());
      apart.vertices.push_back(middle + (1 - gap) * (solid.vertices[t[k]] - middle));
    }
    apart.triangles.push_back(moved);
  }
  return apart;
}

Solid with_every_second_turned(Solid solid) {
  for (std::size_t k = 0; k < solid.triangles.size(); k += 2)
    std::swap(solid.triangles[k][0], solid.triangles[k][1]);
  return solid;
}

// Returns the unit cube's faces apart from each other, three of them turned.
Solid squares_facing_anywhere() {
  Solid apart;
  const Solid cube = make_cube(1);
  for (std::size_t k = 0; k < cube.triangles.size(); k += 2) {
    Solid face;
    face.vertices = cube.vertices;
    face.triangles = {cube.triangles[k], cube.triangles[k + 1]};
    const Triangle& t = face.triangles[0];
    const Vec3 normal =
        cross(face.vertices[t[1]] - face.vertices[t[0]], face.vertices[t[2]] - face.vertices[t[0]]);
    for (Vec3& p : face.vertices) p += 0.01 * normal;
    apart = together(apart, k % 4 == 0 ? turned_over(face) : face);
  }
  return apart;
}

// Returns the options that a refusal advises, nothing if it advises no repair.
std::optional<SolidOptions> advised(const std::string& refusal) {
  SolidOptions options = repair(Repair::none);
  if (contains(refusal, "give `weld` ")) {
    options.weld = std::stod(refusal.substr(refusal.find("give `weld` ") + 12));
  } else if (contains(refusal, "give `repair` voxel")) {
    options.repair = Repair::voxel;
  } else if (contains(refusal, "give `repair` flood")) {
    options.repair = Repair::flood;
    if (const auto at = refusal.find("`max_hole` "); at != refusal.npos)
      options.max_hole = std::stod(refusal.substr(at + 11));
  } else if (contains(refusal, "give `repair` to")) {
    options.repair = Repair::holes;
  } else {
    return std::nullopt;
  }
  return options;
}

TEST(Advice, MakesTheMeshPass) {
  const Solid ball = make_icosphere(1, 3), cube = make_cube(1);
  Solid finned = cube;
  finned.triangles.push_back({0, 1, 7});
  Solid open_cube = cube;
  open_cube.triangles.resize(10);
  struct Row {
    const char* name;
    Solid mesh;
    double volume;  // m^3, which the body that was meant has
  };
  const auto flat = [](double, double) { return 0.0; };
  const std::vector<Row> rows = {
      {"a cube without a face", open_cube, 1},
      {"inside out", turned_over(open_cube), 1},
      {"a small hole", cut_open(ball, 0.97), 4.1},
      {"a wide hole", cut_open(ball, 0.5), 3.5},
      {"a wide hole, facing anywhere", with_every_second_turned(cut_open(ball, 0.5)), 3.5},
      {"a fin", finned, 1},
      {"tiny gaps", shrunk_triangles(cube, 1e-5), 1},
      {"gaps", shrunk_triangles(ball, 0.02), 4.1},
      {"gaps, facing anywhere", with_every_second_turned(shrunk_triangles(ball, 0.02)), 4.1},
      {"wide triangles, facing anywhere", with_every_second_turned(shrunk_triangles(cube, .02)), 1},
      {"squares, facing anywhere", squares_facing_anywhere(), 1},
      {"open ones that cross", together(open_cube, moved(open_cube, {.3, .2, .1})), 1.4},
      {"a body beside a sheet", together(cube, moved(sheet(4, flat), {2, 0, 0})), 1},
  };
  for (const auto& [name, mesh, volume] : rows) {
    const std::string refusal = refusal_of(as_off(mesh), "a.off");
    const auto options = advised(refusal);
    EXPECT_TRUE(options) << name << ": " << refusal;
    if (!options) continue;
    try {
      EXPECT_NEAR(solid_of(as_off(mesh), "a.off", *options).facts.volume, volume, 0.25 * volume)
          << name << ": " << refusal;
    } catch (const Error& fault) {
      ADD_FAILURE() << name << ": " << refusal << "\n" << fault.what();
    }
  }
}

TEST(Advice, IsAChoiceWhereTryingTakesLong) {
  const std::string refusal = refusal_of(as_off(cut_open(make_icosphere(1, 6), 0.1)), "a.off");
  EXPECT_TRUE(contains(refusal, "`repair` holes, voxel or flood may close it")) << refusal;
}

TEST(Advice, NoRepairIsAdvisedForSheets) {
  for (const Solid& mesh :
       {sheet(1, [](double, double) { return 0.; }), sheet(8, [](double, double) { return 0.; }),
        sheet(16, [](double x, double y) { return .02 * std::sin(20 * x) * std::cos(20 * y); })}) {
    const std::string refusal = refusal_of(as_off(mesh), "a.off");
    EXPECT_TRUE(contains(refusal, "no `repair` closes it: give a sheet a thickness")) << refusal;
  }
}

}  // namespace
}  // namespace vpm::test
