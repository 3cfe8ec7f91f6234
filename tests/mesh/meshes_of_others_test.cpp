// Meshes after public reports and by exporters of other projects (../shared/data/reports3), with
// their known volumes.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"

namespace vpm::test {
namespace {

struct MeshOfOthers {
  const char* file;
  double volume;     // m^3
  double tolerance;  // m^3
  double low_x, high_x;
};

TEST(MeshesOfOthers, HaveTheirVolumes) {
  const std::string folder = std::string(VPM_SOURCE_DIR) + "/../shared/data/reports3/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  constexpr double kExact = 1e-9, kFloat = 1e-7;
  const std::vector<MeshOfOthers> rows = {
      {"C07/a.3mf", .006, kExact, 0, .1},
      {"C08/a.3mf", .006, kExact, 0, .1},
      {"written-by-others/three-mirrored-cube.stl", .001, kFloat, -.05, .05},
      {"written-by-others/three-plain-and-mirrored-cubes.stl", .002, kFloat, -.05, .35},
      {"written-by-others/gltf-transform-mirrored-node.glb", .001, kFloat, -.05, .05},
      {"written-by-others/gltf-transform-quantized-box.glb", .00024, kFloat, .9, 1.1},
      {"written-by-others/gltf-transform-two-instances.glb", .002, kFloat, -.05, .55},
  };
  for (const MeshOfOthers& row : rows) {
    try {
      const MeshFacts facts = make_solid(read_mesh(folder + row.file)).facts;
      EXPECT_NEAR(facts.volume, row.volume, row.tolerance) << row.file;
      EXPECT_NEAR(facts.low.x, row.low_x, 1e-5) << row.file;
      EXPECT_NEAR(facts.high.x, row.high_x, 1e-5) << row.file;
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::unavailable) ADD_FAILURE() << fault.what();
    }
  }
}

}  // namespace
}  // namespace vpm::test
