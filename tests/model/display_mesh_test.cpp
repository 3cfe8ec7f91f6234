#include <gtest/gtest.h>

#include "libvpm/file/stream.h"
#include "libvpm/model/tool_model.h"
#include "tests/formats/golden_content.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

using DisplayMesh = test::InTemporaryFolder;

TEST_F(DisplayMesh, IsReadBackToFloatsAboutTheCentreOfMass) {
  ToolModel model = golden::cube_model();
  const Solid mesh{{{0.1, 0.2, 0.3}, {-1.0 / 3, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  write_tool_model(path("with.vpmg"), model, mesh);
  const Solid read = read_display_mesh(path("with.vpmg"));
  EXPECT_EQ(read.triangles, mesh.triangles);
  ASSERT_EQ(read.vertices.size(), mesh.vertices.size());
  for (std::size_t k = 0; k < mesh.vertices.size(); ++k)
    EXPECT_LT(norm(read.vertices[k] - mesh.vertices[k]), 1e-6);
  EXPECT_EQ(read_tool_model(path("with.vpmg")).spheres, model.spheres);
}

TEST_F(DisplayMesh, IsEmptyWhereTheFileKeepsNone) {
  write_tool_model(path("without.vpmg"), golden::cube_model());
  EXPECT_TRUE(read_display_mesh(path("without.vpmg")).triangles.empty());
}

TEST_F(DisplayMesh, OfVerticesThatAreNotThereIsRefused) {
  write_tool_model(path("bad.vpmg"), golden::cube_model(), {{{0, 0, 0}}, {{0, 0, 1}}});
  EXPECT_NE(test::refusal([&] { read_display_mesh(path("bad.vpmg")); }).find("not there"),
            std::string::npos);
}

}  // namespace
}  // namespace vpm
