// Difficult meshes, each with the expected verdict: refused with a reason, or a solid of known
// volume whose packing is certified and agrees with a count of voxels.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/validation.h"
#include "tests/packing/test_solids.h"
#include "tests/test_name.h"

namespace vpm::test {
namespace {

using synthetic::make_box;
using synthetic::make_cube;
using synthetic::make_icosphere;
using synthetic::make_torus;

// A reason for a refusal, or a volume with a tolerance.
struct Verdict {
  Verdict(const char* refusal) : reason(refusal) {}
  Verdict(double volume_, double tolerance_ = 1e-9) : volume(volume_), tolerance(tolerance_) {}
  std::string reason;
  double volume = 0, tolerance = 0;
};

struct Hostile {
  const char* name;
  std::function<Solid()> make;
  Verdict as_it_is, with_holes_filled, from_voxels;
};

// Joins equal vertices, as in a file that lists each point once.
Solid welded(Solid solid) {
  for (Triangle& t : solid.triangles) {
    for (std::uint32_t& corner : t) {
      std::uint32_t first = 0;
      while (solid.vertices[first] != solid.vertices[corner]) ++first;
      corner = first;
    }
  }
  return solid;
}

Solid without(Solid solid, const std::function<bool(Vec3)>& all_corners) {
  std::erase_if(solid.triangles, [&](const Triangle& t) {
    return all_corners(solid.vertices[t[0]]) && all_corners(solid.vertices[t[1]]) &&
           all_corners(solid.vertices[t[2]]);
  });
  return solid;
}

Solid no_top(Solid solid) {
  return without(std::move(solid), [](Vec3 p) { return p.z > 0.99; });
}

// Cuts a corner of the cube off by an edge with a vertex on one of its sides only.
Solid t_junction() {
  Solid cube = make_cube(2);
  const auto [a, b, c] = cube.triangles[0];
  const auto middle = static_cast<std::uint32_t>(cube.vertices.size());
  cube.vertices.push_back(0.5 * (cube.vertices[a] + cube.vertices[b]));
  cube.triangles[0] = {a, middle, c};
  cube.triangles.push_back({middle, b, c});
  return cube;
}

Solid divided_box() {
  Solid two = welded(joined(make_cube(2), shifted(make_cube(2), {2, 0, 0})));
  // Leaves the wall between the halves once instead of twice.
  std::vector<Triangle> kept;
  int wall = 0;
  for (const Triangle& t : two.triangles) {
    const auto on_wall = [&](std::uint32_t v) { return two.vertices[v].x == 1; };
    const bool is_wall = on_wall(t[0]) && on_wall(t[1]) && on_wall(t[2]);
    if (!is_wall || ++wall <= 2) kept.push_back(t);
  }
  two.triangles = kept;
  return two;
}

Solid moebius_band() {
  Solid band;
  constexpr std::uint32_t kAround = 24;
  for (std::uint32_t k = 0; k < kAround; ++k) {
    const double angle = 2 * kPi * k / kAround;
    for (const double w : {-0.2, 0.2}) {
      const double r = 1 + w * std::cos(angle / 2);
      band.vertices.push_back({r * std::cos(angle), r * std::sin(angle), w * std::sin(angle / 2)});
    }
  }
  for (std::uint32_t k = 0; k < kAround; ++k) {
    const bool last = k + 1 == kAround;
    const std::uint32_t a = 2 * k, b = 2 * k + 1, c = last ? 1 : a + 2, d = last ? 0 : b + 2;
    band.triangles.push_back({a, c, b});
    band.triangles.push_back({b, c, d});
  }
  return band;
}

// Returns a torus whose tube is thicker than its ring. The lens about the axis is enclosed twice,
// in opposite senses, so the volume is that of Pappus' theorem.
Solid spindle_torus() {
  return make_torus(0.3, 0.5, 64, 32);
}
double polygon_torus(double ring, double tube, int around, int across) {
  const double disk = 0.5 * across * std::sin(2 * kPi / across) * tube * tube;
  return disk * ring * around * std::sin(2 * kPi / around);
}

Solid fin(Solid solid) {
  const auto tip = static_cast<std::uint32_t>(solid.vertices.size());
  solid.vertices.push_back({3, 3, 0.4});
  solid.triangles.push_back({solid.triangles[0][0], solid.triangles[0][1], tip});
  return solid;
}

Solid flipped_some(Solid solid) {
  for (std::size_t k = 0; k < solid.triangles.size(); k += 3)
    std::swap(solid.triangles[k][0], solid.triangles[k][1]);
  return solid;
}

const char* const kOpen = "the mesh is open";
const char* const kEdges = "non-manifold";
const double kPair = 16, kBall = mass_properties(make_icosphere(1, 2)).volume;

const Hostile kMeshes[] = {
    {"NoTop", [] { return no_top(make_cube(2)); }, kOpen, 8, {8, 1.5}},
    {"TwoFacesGone",
     [] { return without(no_top(make_cube(2)), [](Vec3 p) { return p.z < -0.99; }); },
     kOpen,
     8,
     {8, 3}},
    {"TJunction", t_junction, kOpen, 8, {8, 0.2}},
    {"Bowl",
     [] { return without(make_icosphere(1, 2), [](Vec3 p) { return p.z > -0.1 + p.x * p.x; }); },
     kOpen,
     kOpen,
     {0.5 * kBall, 0.3 * kBall}},
    {"SharedEdge",
     [] {
       return welded(joined(make_cube(2), shifted(make_cube(2), {2, 2, 0})));
     },
     kEdges,
     kEdges,
     {kPair, 0.5}},
    {"SharedVertex",
     [] {
       return welded(joined(make_cube(2), shifted(make_cube(2), {2, 2, 2})));
     },
     kEdges,
     kEdges,
     {kPair, 0.7}},
    {"WallInside", divided_box, kEdges, kEdges, {kPair, 0.5}},
    {"Fin", [] { return fin(make_cube(2)); }, kEdges, kEdges, {8, 0.8}},
    {"RepeatedFaces",
     [] {
       Solid cube = make_cube(2);
       cube.triangles.insert(cube.triangles.end(), {cube.triangles[1], cube.triangles[7]});
       return cube;
     },
     kEdges,
     8,
     {8, 1.5}},
    {"FlippedFaces", [] { return flipped_some(make_icosphere(1, 2)); }, kBall, kBall, {kBall, 0.1}},
    {"InsideOut", [] { return reversed(make_cube(2)); }, 8, 8, {8, 0.2}},
    {"Moebius", moebius_band, kOpen, kOpen, "one-sided"},
    {"Triangle",
     [] {
       return Solid{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
     },
     kOpen, "encloses no volume", "no voxel"},
    {"Pillow",
     [] {
       return Solid{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
     },
     "encloses no volume", "encloses no volume", "no voxel"},
    {"Cross", [] { return joined(make_box(3, 1, 1), make_box(1, 3, 1)); }, 5, 5, {5, 0.3}},
    {"SameBodyTwice", [] { return joined(make_cube(2), make_cube(2)); }, 8, 8, {8, 0.2}},
    {"Stacked",
     [] {
       return joined(make_cube(2), shifted(make_cube(1), {0, 0, 1.5}));
     },
     9,
     9,
     {9, 0.3}},
    {"Cavity", [] { return joined(make_cube(2), reversed(make_cube(1))); }, 7, 7, {7, 0.3}},
    {"BodyInside", [] { return joined(make_cube(2), make_cube(1)); }, 8, 8, {8, 0.2}},
    {"BodyInCavity",
     [] { return joined(joined(make_cube(2), reversed(make_cube(1))), make_icosphere(0.3, 2)); },
     7 + 0.027 * kBall,
     7 + 0.027 * kBall,
     {7 + 0.027 * kBall, 0.3}},
    {"PocketFlushWithAFace",
     [] {
       return joined(make_cube(2), reversed(shifted(make_cube(1), {0, 0, 0.5})));
     },
     7,
     7,
     {7, 0.3}},
    {"CavityThatReachesOut",
     [] {
       return joined(make_cube(2), reversed(shifted(make_box(0.5, 0.5, 4), {0, 0, -1.2})));
     },
     8 - 0.25 * 1.8,
     8 - 0.25 * 1.8,
     {8 - 0.25 * 1.8, 0.3}},
    {"SpindleTorus",
     spindle_torus,
     polygon_torus(0.3, 0.5, 64, 32),
     polygon_torus(0.3, 0.5, 64, 32),
     {polygon_torus(0.3, 0.5, 64, 32), 0.1}},
    {"Plate", [] { return make_box(1, 1, 1e-3); }, {1e-3, 1e-15}, {1e-3, 1e-15}, "no voxel"},
    {"FarAway",
     [] {
       return shifted(make_cube(0.25), {1e7, -1e7, 1e7});
     },
     {0x1p-6, 1e-9},
     {0x1p-6, 1e-9},
     {0x1p-6, 1e-3}},
};

constexpr int kVoxels = 32;       // resolution of repairs, and of counts without fine details
constexpr int kFineVoxels = 128;  // resolution for real parts

void expect_certified(const CheckedSolid& checked, int voxels) {
  const PackResult result = pack(checked.solid, {.spheres = 15});
  ASSERT_FALSE(result.spheres.empty());
  EXPECT_TRUE(certify(checked.solid, result.spheres).holds);
  EXPECT_LE(result.coverage, 1);
  const Validation counted = validate_packing(checked.solid, result.spheres, voxels);
  EXPECT_NEAR(counted.coverage, result.coverage, counted.coverage_error);
  EXPECT_LE(counted.max_protrusion, 0);
  EXPECT_LE(counted.max_overlap, 0);
}

void expect_verdict(const Hostile& hostile, Repair repair, const Verdict& verdict) {
  SCOPED_TRACE(repair == Repair::none ? "as it is" : repair == Repair::holes ? "holes" : "voxel");
  try {
    SolidOptions options;
    options.repair = repair;
    options.repair_voxels = kVoxels;
    const CheckedSolid checked = make_solid(raw(hostile.make()), options);
    EXPECT_EQ(verdict.reason, "") << "but it was accepted";
    EXPECT_NEAR(checked.facts.volume, verdict.volume, verdict.tolerance);
    if (repair != Repair::holes) expect_certified(checked, kVoxels);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::refused);
    EXPECT_FALSE(verdict.reason.empty()) << error.what();
    EXPECT_NE(std::string(error.what()).find(verdict.reason), std::string::npos) << error.what();
  }
}

class HostileMesh : public testing::TestWithParam<Hostile> {};

TEST_P(HostileMesh, GetsItsVerdict) {
  expect_verdict(GetParam(), Repair::none, GetParam().as_it_is);
  expect_verdict(GetParam(), Repair::holes, GetParam().with_holes_filled);
  expect_verdict(GetParam(), Repair::voxel, GetParam().from_voxels);
}

INSTANTIATE_TEST_SUITE_P(Made, HostileMesh, testing::ValuesIn(kMeshes),
                         [](const auto& tested) { return std::string(tested.param.name); });

struct Shared {
  const char* name;
  Repair repair;
};

std::string name_of(const testing::TestParamInfo<Shared>& tested) {
  constexpr const char* kRepaired[] = {"", "_holes_filled", "_from_voxels"};
  return test_name(tested.param.name) + kRepaired[static_cast<std::size_t>(tested.param.repair)];
}

class SharedMesh : public testing::TestWithParam<Shared> {};

TEST_P(SharedMesh, IsPackedAndCertified) {
  const std::string path =
      std::string(VPM_SOURCE_DIR) + "/../shared/data/meshes/" + GetParam().name;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "the shared data is not here";
  SolidOptions options;
  if (GetParam().repair != Repair::none) {
    EXPECT_THROW(make_solid(read_mesh(path)), Error);
    options.repair = GetParam().repair;
    options.repair_voxels = kVoxels;
  }
  expect_certified(make_solid(read_mesh(path), options), kFineVoxels);
}

INSTANTIATE_TEST_SUITE_P(Files, SharedMesh,
                         testing::Values(Shared{"bad_bunny_open.obj", Repair::holes},
                                         Shared{"bad_bunny_open.obj", Repair::voxel},
                                         Shared{"bad_bunny_nonmanifold.ply", Repair::voxel},
                                         Shared{"bad_blobby_misoriented.off", Repair::none},
                                         Shared{"cow.off", Repair::none},
                                         Shared{"featuretype.STL", Repair::none},
                                         Shared{"plate_holes.STL", Repair::none}),
                         name_of);

}  // namespace
}  // namespace vpm::test
