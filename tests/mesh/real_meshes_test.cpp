// Real files: scans, CAD parts and artists' models, with facts that others computed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/mesh/mesh_files.h"
#include "tests/refusal.h"
#include "tests/test_name.h"

namespace vpm::test {
namespace {

struct Sound {
  const char* name;
  std::size_t vertices, triangles;
  std::int64_t euler;
  double volume;
  std::size_t self_intersections;  // pairs, by CGAL
};

class SoundMesh : public testing::TestWithParam<Sound> {};

TEST_P(SoundMesh, IsAcceptedWithTheFactsOfOthers) {
  const Sound& truth = GetParam();
  const std::string path = shared_mesh(truth.name);
  if (path.empty()) GTEST_SKIP() << "the shared data is not here";
  const CheckedSolid checked = make_solid(read_mesh(path));
  EXPECT_EQ(checked.facts.vertices, truth.vertices);
  EXPECT_EQ(checked.facts.triangles, truth.triangles);
  EXPECT_EQ(checked.facts.euler, truth.euler);
  EXPECT_EQ(checked.facts.shells, 1U);
  EXPECT_NEAR(checked.facts.volume, truth.volume, 5e-4 * truth.volume);
  EXPECT_EQ(checked.facts.self_intersections, truth.self_intersections);
  // Those in millimetres are so large that a warning asks for their scale.
  const Vec3 sides = checked.facts.high - checked.facts.low;
  const bool is_large = std::max({sides.x, sides.y, sides.z}) >= 5;
  EXPECT_EQ(checked.warnings.size(),
            (truth.self_intersections > 0 ? 1U : 0U) + (is_large ? 1U : 0U));
}

INSTANTIATE_TEST_SUITE_P(Shared, SoundMesh,
                         testing::Values(Sound{"bunny.off", 3485, 6966, 2, 0.00075393, 0},
                                         Sound{"armadillo.obj", 43243, 86482, 2, 0.068619, 0},
                                         Sound{"spot.obj", 2930, 5856, 2, 0.71826, 0},
                                         Sound{"fandisk.obj", 6475, 12946, 2, 20.243, 0},
                                         Sound{"knot.ply", 1440, 2880, 0, 1.0535e6, 0},
                                         Sound{"fuze_bottle.ply", 502, 1000, 2, 0.00060669, 0},
                                         Sound{"plate_holes.STL", 618, 1252, -8, 7.6736e5, 0},
                                         Sound{"franka_fer_link5.stl", 152, 300, 2, 0.0034191, 0},
                                         Sound{"featuretype.STL", 1722, 3476, -16, 11.628, 0},
                                         Sound{"cow.off", 2762, 5520, 2, 0.05348, 118},
                                         Sound{"bad_blobby_misoriented.off", 2027, 4050, 2, 0.0501,
                                               0}),
                         [](const auto& tested) { return test_name(tested.param.name); });

std::string refusal_of_file(const std::string& path, const SolidOptions& options = {}) {
  return refusal([&] { make_solid(read_mesh(path), options); });
}

TEST(RealMeshes, TheRepairedOneSaysSo) {
  const std::string path = shared_mesh("bad_blobby_misoriented.off");
  if (path.empty()) GTEST_SKIP() << "the shared data is not here";
  const CheckedSolid checked = make_solid(read_mesh(path));
  ASSERT_EQ(checked.notes.size(), 1U);
  EXPECT_NE(checked.notes[0].find("3069 edges"), std::string::npos);
}

TEST(RealMeshes, BadOnesAreRefusedWithTheCountsOfOthers) {
  const std::string open = shared_mesh("bad_bunny_open.obj");
  if (open.empty()) GTEST_SKIP() << "the shared data is not here";
  EXPECT_NE(refusal_of_file(open).find("open: 223 edges"), std::string::npos);
  const std::string message = refusal_of_file(shared_mesh("bad_bunny_nonmanifold.ply"));
  EXPECT_NE(message.find("open: 123 edges"), std::string::npos) << message;
  EXPECT_NE(message.find("non-manifold: 150 edges"), std::string::npos) << message;
  EXPECT_NE(message.find("87 triangles are listed more than once"), std::string::npos) << message;
}

TEST(RealMeshes, ThePartWithNoisyZerosIsOpenWithoutTheWeld) {
  const std::string path = shared_mesh("featuretype.STL");
  if (path.empty()) GTEST_SKIP() << "the shared data is not here";
  SolidOptions exact;
  exact.weld = 0;
  EXPECT_NE(refusal_of_file(path, exact).find("open: 576 edges"), std::string::npos);
}

}  // namespace
}  // namespace vpm::test
