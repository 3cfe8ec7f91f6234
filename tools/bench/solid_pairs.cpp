#include "tools/bench/solid_pairs.h"

#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "libvpm/core/box.h"
#include "libvpm/file/stream.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm::bench {
namespace {

using synthetic::make_box;
using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_torus;

constexpr std::size_t kQuickTriangles = 2000;

// Returns a ball with bumps, as a scanned body has.
Solid bumpy_ball(double radius, int subdivisions) {
  Solid ball = make_icosphere(radius, subdivisions);
  for (Vec3& v : ball.vertices) {
    const Vec3 u = v / radius;
    v = (1 + .12 * std::sin(5 * u.x + 1) * std::sin(6 * u.y + 2) * std::sin(4 * u.z + 3)) * v;
  }
  return ball;
}

// Returns a gear with straight teeth about the z axis.
Solid gear(double radius, double tooth, double height, std::uint32_t teeth) {
  Solid solid;
  const std::uint32_t corners = 4 * teeth, center = corners, upper = corners + 1;
  for (const double z : {-height / 2, height / 2}) {
    for (std::uint32_t i = 0; i < corners; ++i) {
      constexpr double kPhase[4]{0, .2, .5, .7};
      const double angle = 2 * M_PI * (i / 4 + kPhase[i % 4]) / teeth;
      const double r = i % 4 == 1 || i % 4 == 2 ? radius : radius - tooth;
      solid.vertices.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
    solid.vertices.push_back({0, 0, z});
  }
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t j = (i + 1) % corners;
    solid.triangles.push_back({center, j, i});
    solid.triangles.push_back({center + upper, i + upper, j + upper});
    solid.triangles.push_back({i, j, j + upper});
    solid.triangles.push_back({i, j + upper, i + upper});
  }
  return solid;
}

// Returns a box of this size with the part's surface as a cavity.
Solid mould_of(const Solid& part, double size) {
  Solid mould = make_cube(size);
  const auto first = static_cast<std::uint32_t>(mould.vertices.size());
  mould.vertices.insert(mould.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [i, j, k] : part.triangles)
    mould.triangles.push_back({first + i, first + k, first + j});
  return mould;
}

// Returns the mesh of a file, its longest side scaled to `size`.
Solid mesh_of(const std::string& path, double size) {
  Solid solid = make_solid(parse_mesh(file::read_all(path), path), {}).solid;
  Box box;
  for (const Vec3& v : solid.vertices) box.add(v);
  const double scale = size / coordinate(box.size(), box.longest_axis());
  for (Vec3& v : solid.vertices) v = scale * (v - 0.5 * (box.low + box.high));
  return solid;
}

std::vector<PairOfSolids> made_pairs() {
  const Solid cube = make_cube(.1), ball = make_icosphere(.05, 3), plate = make_box(.1, .1, .001),
              torus = make_torus(.04, .015, 64, 32), wheel = gear(.05, .012, .02, 18),
              part = bumpy_ball(.05, 3);
  const Solid knot = synthetic::make_torus_knot(2, 3, .035, .014, .007, 290, 12),
              bumpy = bumpy_ball(.05, 4);
  const Vec3 turned{.3, .5, .2}, aslant{1, .3, .2};
  return {
      {"cubes, flush", cube, cube, {}, {1, 0, 0}},
      {"cubes, turned", cube, cube, turned, aslant},
      {"balls", ball, ball, turned, aslant},
      {"tetrahedron-cube", synthetic::make_tetrahedron(.12), cube, {.7, -.2, .4}, {.3, 1, .2}},
      {"octahedron-plate", synthetic::make_octahedron(.1), plate, {.2, .3, .1}, {.2, .1, 1}},
      {"tori", torus, torus, {1.4, .2, .1}, {1, .1, .3}},
      {"torus-cube", torus, cube, {.2, .9, .3}, {.2, .3, 1}},
      {"plate-cube", plate, cube, {.4, .1, .2}, {1, .1, .4}},
      {"plates, crossed", plate, plate, {1.2, .3, .1}, {.3, .2, 1}},
      {"needle-ball", make_box(.002, .002, .2), ball, {.4, .3, 0}, {1, .1, .2}},
      {"gears, caps flush", wheel, wheel, {0, 0, .12}, {1, 0, 0}},
      {"gears, turned", wheel, wheel, {.4, .2, .12}, {1, .2, .1}},
      {"small torus-large box", make_torus(.03, .01, 32, 16), make_cube(.2), {.5, .2, .9}, aslant},
      {"part-its mould", part, mould_of(part, .13), {}, {.2, 1, .1}},
      {"twins", part, part, {}, {.4, 1, .3}},
      {"twisted torus-ball", synthetic::make_twisted_torus(.04, .02, 3, 64), ball, turned, aslant},
      {"knot-cube", knot, cube, {.1, .8, .4}, {1, .2, .5}},
      {"knot-bumpy ball", knot, bumpy, {.2, 1.5, .3}, {1, .4, .2}},
      {"bumpy balls, large", bumpy_ball(.05, 6), bumpy, {.1, .6, .2}, {1, .2, -.3}}};
}

struct PairOfFiles {
  const char *a, *b;
  double size_a, size_b;  // longest sides, m
  Vec3 turn, way;
};

constexpr PairOfFiles kPairsOfFiles[]{
    {"bunny.off", "spot.obj", .1, .1, {.2, 1.5, .3}, {1, .4, .2}},
    {"fandisk.obj", "spot.obj", .09, .1, {.6, .3, 1.1}, {.3, 1, -.2}},
    {"knot.ply", "bunny.off", .1, .1, {.1, .8, .4}, {1, .2, .5}},
    {"armadillo.obj", "bunny.off", .12, .1, {.1, .6, .2}, {1, .2, -.3}},
    {"armadillo.obj", "armadillo.obj", .12, .12, {.3, 2.1, .2}, {1, .1, .2}}};

}  // namespace

std::vector<PairOfSolids> pairs_of_solids(bool quick, const std::string& meshes) {
  std::vector<PairOfSolids> pairs = made_pairs();
  if (quick)
    std::erase_if(pairs, [](const PairOfSolids& pair) {
      return pair.a.triangles.size() + pair.b.triangles.size() > kQuickTriangles;
    });
  if (meshes.empty()) return pairs;
  const auto stem = [](const std::string& name) { return name.substr(0, name.find('.')); };
  for (const PairOfFiles& files : kPairsOfFiles) {
    const std::string a = meshes + "/" + files.a, b = meshes + "/" + files.b;
    if (!std::filesystem::exists(a) || !std::filesystem::exists(b)) continue;
    pairs.push_back({stem(files.a) + "-" + stem(files.b), mesh_of(a, files.size_a),
                     mesh_of(b, files.size_b), files.turn, files.way});
  }
  return pairs;
}

}  // namespace vpm::bench
