#include "libvpm/model/tool_model.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "tests/formats/golden_content.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

TEST(ToolModel, LevelsAreFoundBySphereCount) {
  const ToolModel model = golden::cube_model();
  EXPECT_EQ(model.level(4).sphere_count, 4U);
  EXPECT_EQ(model.level(8).sphere_count, 8U);
  EXPECT_EQ(model.level(0).sphere_count, 8U) << "0 is the finest";
}

TEST(ToolModel, AMissingLevelIsWrongUsageAndTheLevelsAreListed) {
  const auto fault = test::fault_of([] { golden::cube_model().level(5); });
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->kind(), ErrorKind::invalid_argument);
  EXPECT_STREQ(fault->what(), "the tool model has no level of 5 spheres; it has 4, 8");
}

TEST(ToolModel, SoundModelsAreValid) {
  EXPECT_NO_THROW(validate(golden::cube_model(), "model"));
}

// The writer refuses the same content as the reader.
TEST(ToolModel, UnsoundModelsAreNotWritten) {
  const auto expect_refused = [](const char* defect, auto spoil) {
    ToolModel model = golden::cube_model();
    spoil(model);
    EXPECT_THROW(validate(model, "model"), Error) << defect;
    EXPECT_THROW(write_tool_model("/dev/null", model), Error) << defect;
  };
  expect_refused("no spheres", [](ToolModel& m) { m.spheres.clear(); });
  expect_refused("no levels", [](ToolModel& m) { m.levels.clear(); });
  expect_refused("no nodes", [](ToolModel& m) { m.levels[0].hierarchy.nodes.clear(); });
  expect_refused("no row offsets", [](ToolModel& m) { m.levels[0].graph.begin.clear(); });
  expect_refused("loop", [](ToolModel& m) { m.levels[0].graph.neighbors[0] = 0; });
  expect_refused("missing leaf", [](ToolModel& m) {
    m.levels[0].hierarchy.leaves.pop_back();
    --m.levels[0].hierarchy.nodes[1].end;
  });
  expect_refused("missing share", [](ToolModel& m) { m.levels[1].cell_volume.pop_back(); });
  expect_refused("orphaned samples", [](ToolModel& m) { m.levels[1].samples.push_back({}); });
  expect_refused("empty grid", [](ToolModel& m) { m.levels[1].grid.nz = 0; });
  expect_refused("surface of another volume", [](ToolModel& m) {
    m.surface = golden::cube_packing().solid;
    m.surface.vertices[0] = {-0.09, -0.1, -0.1};
  });
  expect_refused("open surface", [](ToolModel& m) {
    m.surface = golden::cube_packing().solid;
    m.surface.triangles.pop_back();
  });
  expect_refused("vertices without triangles", [](ToolModel& m) {
    m.surface.vertices = {{0, 0, 0}};
  });
  expect_refused("sphere of another level", [](ToolModel& m) { m.levels[0].grid.spheres[3] = 5; });
}

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
