#include "libvpm/packing/packing_export.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <span>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"

namespace vpm {
namespace {

const std::vector<Sphere> kSpheres{{{0.1, -2.0 / 3, 3e-7}, 0.5}, {{10, 20, 30}, 1.0 / 300}};

TEST(PackingExport, ExtensionsChooseTheFormat) {
  EXPECT_EQ(export_format("a/b.csv"), ExportFormat::csv);
  EXPECT_EQ(export_format("b.ply"), ExportFormat::ply);
  EXPECT_EQ(export_format("b.yml"), ExportFormat::yml);
  EXPECT_EQ(export_format("b.yaml"), ExportFormat::yml);
  for (const char* const name : {"b", "b.CSV.txt", "csv", "-", ""}) {
    try {
      export_format(name);
      ADD_FAILURE() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
    }
  }
}

TEST(PackingExport, CsvHasAHeaderAndNineDigits) {
  EXPECT_EQ(packing_as_csv(kSpheres),
            "x,y,z,r\n0.1,-0.666666667,3e-07,0.5\n10,20,30,0.00333333333\n");
}

TEST(PackingExport, YmlListsTheSpheresOfALink) {
  EXPECT_EQ(packing_as_yml({kSpheres[0]}, "hand"),
            "collision_spheres:\n  \"hand\":\n"
            "    - \"center\": [0.1, -0.666666667, 3e-07]\n      \"radius\": 0.5\n");
}

TEST(PackingExport, PlyIsAMeshOfOneClosedBallPerSphere) {
  const std::string bytes = packing_as_ply(kSpheres);
  const CheckedSolid balls =
      make_solid(parse_mesh(std::as_bytes(std::span(bytes.data(), bytes.size())), "balls.ply"));
  EXPECT_EQ(balls.facts.shells, 2U);
  EXPECT_EQ(balls.facts.triangles, 160U);
  EXPECT_TRUE(balls.notes.empty());
  EXPECT_NEAR(balls.facts.high.z, 30 + 1.0 / 300, 1e-5);
  for (std::size_t k = 0; k < balls.solid.vertices.size(); ++k) {
    const Sphere& s = kSpheres[k / 42];
    EXPECT_NEAR(norm(balls.solid.vertices[k] - s.center), s.radius, 1e-5);
  }
}

}  // namespace
}  // namespace vpm
