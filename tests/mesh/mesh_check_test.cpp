#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/mesh/mesh_files.h"
#include "tests/refusal.h"

namespace vpm::test {
namespace {

using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_torus;

bool says(const std::vector<std::string>& messages, const std::string& part) {
  for (const std::string& message : messages) {
    if (message.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(MeshCheck, AcceptsAClosedMeshAsItIs) {
  const Solid cube = make_cube(2);
  const CheckedSolid checked = solid_of(cube);
  EXPECT_EQ(checked.solid.vertices, cube.vertices);
  EXPECT_EQ(checked.solid.triangles, cube.triangles);
  EXPECT_TRUE(checked.notes.empty());
  EXPECT_TRUE(checked.warnings.empty());
  EXPECT_DOUBLE_EQ(checked.facts.volume, 8);
  EXPECT_DOUBLE_EQ(checked.facts.area, 24);
  EXPECT_EQ(checked.facts.euler, 2);
  EXPECT_EQ(solid_of(make_torus(1, 0.3, 24, 12)).facts.euler, 0);
}

TEST(MeshCheck, TurnsAnInwardMeshAndSaysSo) {
  const CheckedSolid checked = solid_of(turned_over(make_cube(2)));
  EXPECT_DOUBLE_EQ(checked.facts.volume, 8);
  EXPECT_TRUE(says(checked.notes, "faced inward"));
}

TEST(MeshCheck, RepairsRandomOrientation) {
  const Solid torus = make_torus(1, 0.3, 24, 12);
  Solid shuffled = torus;
  std::mt19937 random(1);
  for (Triangle& t : shuffled.triangles) {
    if (random() % 2 == 0) std::swap(t[0], t[1]);
  }
  const CheckedSolid checked = solid_of(shuffled);
  EXPECT_DOUBLE_EQ(checked.facts.volume, mass_properties(torus).volume);
  EXPECT_TRUE(says(checked.notes, "opposite orientation"));
}

TEST(MeshCheck, ScaleMultipliesLengths) {
  const CheckedSolid checked = solid_of(make_cube(2), {.scale = 0.001});
  EXPECT_DOUBLE_EQ(checked.facts.volume, 8e-9);
  EXPECT_DOUBLE_EQ(checked.facts.high.x, 0.001);
}

TEST(MeshCheck, SizesThatFewToolsHaveAreWarnedOf) {
  const auto warnings_of = [](double edge, std::optional<double> scale) {
    return solid_of(make_cube(edge), {.scale = scale}).warnings;
  };
  for (const double edge : {0.002, 0.05, 0.3, 1.6, 3.0, 4.9})  // tools, and links of robots
    EXPECT_TRUE(warnings_of(edge, std::nullopt).empty()) << edge;
  for (const double edge : {5.0, 15.0, 50.0, 300.0, 5000.0}) {  // the same in millimetres
    EXPECT_TRUE(says(warnings_of(edge, std::nullopt),
                     "m across: if its unit is the millimetre, give `scale` 0.001"))
        << edge;
    EXPECT_TRUE(warnings_of(edge, 0.001).empty()) << edge;
    EXPECT_EQ(warnings_of(edge, 1).empty(), edge < 100) << edge << ": said to be metres";
  }
  EXPECT_TRUE(says(warnings_of(300, 1), "give `scale` 0.001"));
  EXPECT_TRUE(says(warnings_of(0.05, 0.001), "give `scale` 1"));
  EXPECT_TRUE(says(warnings_of(0.0005, std::nullopt),
                   "0.0005 m across: if it was scaled to metres twice, give `scale` 1000"));
}

TEST(MeshCheck, WarningsOfSizeKnowTheUnitOfTheFormat) {
  RawMesh mesh = parse(as_off(make_cube(50)), "a.off");
  const auto says_of = [&](MeshFormat format, const std::string& words) {
    mesh.format = format;
    return says(make_solid(mesh).warnings, words);
  };
  for (const MeshFormat format :
       {MeshFormat::obj, MeshFormat::off, MeshFormat::ply, MeshFormat::stl})
    EXPECT_TRUE(says_of(format, "50 m across: if its unit is the millimetre, give `scale` 0.001"));
  EXPECT_TRUE(says_of(MeshFormat::gltf,
                      "50 m across, as glTF's unit is the metre: if its program wrote millimetres, "
                      "give `scale` 0.001"));
  struct Unit {
    double metres;
    std::string cure;
  };
  for (const MeshFormat format : {MeshFormat::dae, MeshFormat::threemf, MeshFormat::fbx}) {
    const std::string told = "50 m across by the unit of its file: if ";
    for (const auto& [metres, cure] :
         {Unit{1, "that should be the millimetre, give `scale` 0.001"},
          Unit{0.01, "that should be the millimetre, give `scale` 0.1"},
          Unit{0.0254, "that should be the millimetre, give `scale` 0.0393701"},
          Unit{0.001, "it was scaled to millimetres twice, give `scale` 0.001"}}) {
      mesh.metres_per_unit = metres;
      EXPECT_TRUE(says_of(format, told + cure)) << metres;
    }
  }
}

TEST(MeshCheck, ACavityIsLeftOut) {
  const Solid hollow = together(make_cube(2), turned_over(make_cube(1)));
  const CheckedSolid checked = solid_of(hollow);
  EXPECT_DOUBLE_EQ(checked.facts.volume, 7);
  EXPECT_EQ(checked.facts.shells, 2U);
  EXPECT_EQ(checked.facts.cavities, 1U);
  EXPECT_TRUE(checked.notes.empty());
  // A body turned inside out is the same body.
  EXPECT_DOUBLE_EQ(solid_of(turned_over(hollow)).facts.volume, 7);
}

TEST(MeshCheck, WithoutConsistencyNestedShellsAlternate) {
  Solid nested = together(together(make_cube(4), make_cube(2)), make_cube(1));
  std::swap(nested.triangles[0][0], nested.triangles[0][1]);
  EXPECT_DOUBLE_EQ(solid_of(nested).facts.volume, 64 - 8 + 1);
}

TEST(MeshCheck, ASolidWithinASolidIsDropped) {
  const CheckedSolid checked = solid_of(together(make_cube(2), make_cube(1)));
  EXPECT_EQ(checked.solid.triangles, make_cube(2).triangles);
  EXPECT_EQ(checked.solid.vertices, make_cube(2).vertices);
  EXPECT_DOUBLE_EQ(checked.facts.volume, 8);
  EXPECT_EQ(checked.facts.inner_shells, 1U);
  EXPECT_EQ(checked.facts.shells, 1U);
  EXPECT_TRUE(says(checked.notes, "1 shell inside of the solid dropped"));
  // A hole within a dropped shell is filled too; a hole through both stays.
  const Solid filled = together(together(make_cube(3), make_cube(2)), turned_over(make_cube(1)));
  EXPECT_DOUBLE_EQ(solid_of(filled).facts.volume, 27);
  const CheckedSolid hollow =
      solid_of(together(filled, turned_over(moved(make_cube(0.5), {0.1, 0, 0}))));
  EXPECT_DOUBLE_EQ(hollow.facts.volume, 27 - 0.125);
  EXPECT_EQ(hollow.facts.inner_shells, 2U);
}

TEST(MeshCheck, EachOfSeveralBodiesFacesOutward) {
  const Solid pair = together(make_cube(2), turned_over(moved(make_cube(1), {5, 0, 0})));
  const CheckedSolid checked = solid_of(pair);
  EXPECT_DOUBLE_EQ(checked.facts.volume, 9);
  EXPECT_TRUE(says(checked.notes, "1 of 2 shells"));
}

TEST(MeshCheck, OverlapsOfBodiesCountOnce) {
  const Solid pair = together(make_cube(2), moved(make_cube(2), {1, 0.9, 0.8}));
  const CheckedSolid checked = solid_of(pair);
  EXPECT_GT(checked.facts.self_intersections, 0U);
  EXPECT_TRUE(says(checked.warnings, "intersects itself"));
  EXPECT_NEAR(checked.facts.volume, 16 - 1 * 1.1 * 1.2, 1e-13);
  // Bodies count whichever way they face.
  EXPECT_NEAR(solid_of(together(make_cube(2), turned_over(moved(make_cube(2), {1, 0.9, 0.8}))))
                  .facts.volume,
              16 - 1 * 1.1 * 1.2, 1e-13);
}

TEST(MeshCheck, RefusesAnOpenMeshWithCountAndPlace) {
  Solid open = make_cube(2);
  open.triangles.pop_back();
  const std::string message = refusal_of(open);
  EXPECT_TRUE(contains(message, "open: 3 edges")) << message;
  EXPECT_TRUE(contains(message, "(1, 1, 1)") || contains(message, "1, ")) << message;
}

TEST(MeshCheck, RefusesNonManifoldEdges) {
  // Two cubes share an edge by index.
  Solid pair = together(make_cube(2), moved(make_cube(2), {2, 2, 0}));
  SolidOptions weld;
  weld.weld = 1e-9;
  const std::string message = refusal_of(as_off(pair), "a.off", weld);
  EXPECT_TRUE(contains(message, "non-manifold: 1 edge belongs")) << message;
  EXPECT_TRUE(contains(message, "(1, 1, ")) << message;
}

TEST(MeshCheck, RefusesAPinchedVertex) {
  const Solid pair = together(make_cube(2), moved(make_cube(2), {2, 2, 2}));
  SolidOptions weld;
  weld.weld = 0;
  const std::string message = refusal_of(as_off(pair), "a.off", weld);
  EXPECT_TRUE(contains(message, "touches itself in 1 vertex, at (1, 1, 1)")) << message;
}

TEST(MeshCheck, RefusesDuplicateFaces) {
  Solid twice = make_cube(2);
  twice.triangles.push_back(twice.triangles[0]);
  EXPECT_TRUE(contains(refusal_of(twice), "1 triangle is listed more than once"));
}

TEST(MeshCheck, RefusesAKleinBottle) {
  Solid bottle;
  const std::uint32_t n = 8;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j)
      bottle.vertices.push_back({double(i), double(j), std::sin(double(3 * i + 5 * j))});
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return i < n ? n * i + j % n : (n - j % n) % n;  // the last row meets the first one mirrored
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      bottle.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      bottle.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  EXPECT_TRUE(contains(refusal_of(bottle), "one-sided")) << refusal_of(bottle);
}

TEST(MeshCheck, RefusesWhatEnclosesNothing) {
  Solid sheet;
  sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_TRUE(contains(refusal_of(sheet), "encloses no volume"));
  Solid point;
  point.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
  point.triangles = {{0, 1, 2}};
  EXPECT_TRUE(contains(refusal_of(point), "in one point"));
  EXPECT_TRUE(contains(refusal_of("OFF\n0 0 0\n", "a.off"), "no faces"));
  EXPECT_TRUE(contains(refusal_of("v 0 0 0\nv 1 0 0\nf 1 2 1\n", "a.obj"), "two equal corners"));
}

TEST(MeshCheck, RefusesExtentsBeyondDoubles) {
  EXPECT_TRUE(contains(refusal_of(make_cube(1e200)), "range"));
  EXPECT_TRUE(contains(refusal_of(make_cube(1e-200)), "range"));
}

TEST(MeshCheck, RefusesWrongOptionsAsUsage) {
  for (const SolidOptions& options :
       {SolidOptions{.scale = 0}, SolidOptions{.scale = -1}, SolidOptions{.scale = NAN},
        SolidOptions{.scale = 1, .weld = -1e-9}, SolidOptions{.scale = 1, .weld = 0.5}}) {
    EXPECT_EQ(kind_of_fault([&] { solid_of(make_cube(1), options); }), ErrorKind::invalid_argument);
  }
}

TEST(MeshCheck, UnusedVerticesAndCollapsedTrianglesAreDropped) {
  Solid cube = make_cube(2);
  cube.vertices.insert(cube.vertices.begin(), {7, 7, 7});
  for (Triangle& t : cube.triangles) {
    for (std::uint32_t& corner : t) ++corner;
  }
  cube.triangles.push_back({1, 1, 2});
  const CheckedSolid checked = solid_of(cube);
  EXPECT_EQ(checked.solid.vertices.size(), 8U);
  EXPECT_EQ(checked.solid.triangles.size(), 12U);
  EXPECT_TRUE(says(checked.notes, "1 vertex without a triangle"));
  EXPECT_TRUE(says(checked.notes, "1 triangle with two equal corners"));
}

TEST(MeshCheck, SeamsOfAnIndexedMeshAreClosedWithANote) {
  // A ball is given as a soup of triangles in an indexed format.
  const Solid ball = make_icosphere(1, 1);
  Solid soup;
  for (const Triangle& t : ball.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t corner : t) soup.vertices.push_back(ball.vertices[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  const CheckedSolid checked = solid_of(soup);
  EXPECT_EQ(checked.solid.vertices.size(), ball.vertices.size());
  EXPECT_TRUE(says(checked.notes, "closed after joining"));
  SolidOptions off;
  off.weld = 0;
  EXPECT_EQ(solid_of(soup, off).solid.vertices.size(), ball.vertices.size());
}

TEST(MeshCheck, StlIsWeldedWithinTheTolerance) {
  Solid cube = make_cube(2);
  std::string content = as_ascii_stl(cube);
  const std::size_t at = content.find("vertex 1");
  content.replace(at, 8, "vertex 1.0000000005");  // 1.4e-10 of the diagonal
  EXPECT_EQ(solid_of(content, "a.stl").solid.vertices.size(), 8U);
  SolidOptions exact;
  exact.weld = 0;
  EXPECT_TRUE(contains(refusal_of(content, "a.stl", exact), "open"));
}

TEST(MeshCheck, TheOriginMayLieFarAway) {
  const CheckedSolid checked = solid_of(moved(make_cube(1), {1e7, -1e7, 1e7}));
  EXPECT_NEAR(checked.facts.volume, 1, 1e-8);
  EXPECT_TRUE(checked.warnings.empty());
}

}  // namespace
}  // namespace vpm::test
