// Golden files give the content listed beside them, and are written again byte by byte.
#include <gtest/gtest.h>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"
#include "tests/formats/content_dump.h"
#include "tests/formats/golden_content.h"
#include "tests/temporary_folder.h"

namespace vpm::golden {
namespace {

const std::string kGolden = VPM_SOURCE_DIR "/formats/golden/v1/";

using test::text_of;

void write_model(const std::string& path, const ToolModel& model) {
  write_tool_model(path, model);
}

template <class Content>
void expect_golden(const std::string& name, Content (*read)(const std::string&),
                   void (*write)(const std::string&, const Content&), const Content& made) {
  const Content content = read(kGolden + name);
  EXPECT_EQ(dump(content), nlohmann::json::parse(text_of(kGolden + name + ".json")));
  const file::TemporaryFolder folder;
  const std::string copy = folder.path(name);
  write(copy, content);
  EXPECT_EQ(text_of(copy), text_of(kGolden + name)) << "read and written again";
  write(copy, made);
  EXPECT_EQ(text_of(copy), text_of(kGolden + name)) << "made anew";
}

TEST(Golden, Packing) {
  expect_golden("cube.vpmp", read_packing, write_packing, cube_packing());
}
TEST(Golden, ToolModel) {
  expect_golden("cube.vpmg", read_tool_model, write_model, cube_model());
}
TEST(Golden, CalibratedToolModel) {
  expect_golden("calibrated.vpmg", read_tool_model, write_model, calibrated_cube_model());
}
TEST(Golden, ToolModelWithSurface) {
  expect_golden("surface.vpmg", read_tool_model, write_model, cube_model_with_surface());
}
TEST(Golden, ToolModelWithFaces) {
  expect_golden("faces.vpmg", read_tool_model, write_model, cube_model_with_faces());
}
TEST(Golden, CloudWithSensor) {
  expect_golden("wall.vpmc", read_cloud, write_cloud, wall_cloud());
}
TEST(Golden, CloudWithoutSensor) {
  expect_golden("scattered.vpmc", read_cloud, write_cloud, scattered_cloud());
}

}  // namespace
}  // namespace vpm::golden
