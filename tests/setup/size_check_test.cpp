// Sizes of tools and scenes, in the units that they have and in those that they are mistaken for.
#include "libvpm/setup/size_check.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/setup/test_setups.h"

namespace vpm {
namespace {

struct NamedTool {
  const char* name;
  double across;  // m
};
constexpr NamedTool kTools[] = {{"needle", 0.005}, {"burr", 0.02}, {"finger", 0.06},
                                {"hammer", 0.35},  {"link", 0.7},  {"arm", 1.6},
                                {"wand", 2},       {"table", 2.6}};

struct NamedScene {
  const char* name;
  Cloud cloud;
  bool is_small;  // a thing or a part of a room
};

// Returns scenes whose lengths are `unit` times those in metres.
std::vector<NamedScene> scenes(double unit) {
  std::vector<NamedScene> scenes;
  const auto add = [&](const char* name, Cloud cloud, bool is_small) {
    scenes.push_back({name, std::move(cloud), is_small});
  };
  add("wall near the camera", wall_at(0.2 * unit), true);
  add("narrow view", wall_at(1 * unit, 300), true);
  add("desk", wall_at(1.3 * unit), true);
  add("room", wall_at(4 * unit), true);
  add("street", wall_at(25 * unit, 500), false);
  add("scanned screw", scanned_cube(0.03 * unit, 0.001 * unit), true);
  add("scanned teeth", scanned_cube(0.06 * unit, 0.002 * unit), true);
  add("scanned bottle", scanned_cube(0.25 * unit, 0.01 * unit), true);
  add("scanned room", scanned_cube(8 * unit, 0.2 * unit), true);
  add("scanned hall", scanned_cube(60 * unit, 1 * unit), false);
  return scenes;
}

// Returns what is said of a tool before a scene; "" for nothing.
std::string said_of(double across, const Cloud& cloud, double scale = 1) {
  const ToolModel tool = cube_of(across, {}, scale);
  const ToolModel* const tools[] = {&tool};
  const auto remark = improbable_sizes(tools, checked_scene(cloud), false);
  return remark ? remark->text : "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

TEST(SizeCheck, SaysNothingOfSizesThatOccur) {
  for (const NamedScene& scene : scenes(1))
    for (const NamedTool& tool : kTools) {
      // Points of a hall that are 1 m apart show nothing of a hand's tool.
      if (std::string(scene.name) == "scanned hall" && tool.across < 0.6) continue;
      EXPECT_EQ(said_of(tool.across, scene.cloud), "") << tool.name << " before " << scene.name;
    }
}

TEST(SizeCheck, SaysNothingOfVehicles) {
  EXPECT_EQ(said_of(4.7, wall_at(4)), "");
  EXPECT_EQ(said_of(8.1, wall_at(1.4)), "");  // or models of no unit
  EXPECT_EQ(said_of(12, wall_at(25)), "");
  EXPECT_EQ(said_of(12, scanned_cube(60, 1)), "");
}

TEST(SizeCheck, NamesToolsInMillimetres) {
  for (const NamedScene& scene : scenes(1))
    for (const NamedTool& tool : kTools) {
      if (tool.across < 0.02 || (!scene.is_small && tool.across < 0.35)) continue;
      EXPECT_TRUE(has(said_of(1000 * tool.across, scene.cloud),
                      "if the mesh is in millimetres, give `scale` 0.001"))
          << tool.name << " before " << scene.name;
    }
}

TEST(SizeCheck, NamesToolsThatWereScaledTwice) {
  for (const NamedScene& scene : scenes(1))
    for (const NamedTool& tool : kTools) {
      // A tool that is as small as the points are dense may be one.
      if (0.001 * tool.across > checked_scene(scene.cloud).spacing) continue;
      if (size_of(checked_scene(scene.cloud)) < 0.1 * tool.across) continue;
      EXPECT_TRUE(has(said_of(0.001 * tool.across, scene.cloud, 0.001),
                      "if the mesh is in metres, give `scale` 1"))
          << tool.name << " before " << scene.name;
    }
}

TEST(SizeCheck, NamesScenesInMillimetres) {
  for (const NamedScene& scene : scenes(1000))
    for (const NamedTool& tool : kTools) {
      const CheckedScene checked = checked_scene(scene.cloud);
      if (size_of(checked) < 100 * tool.across || checked.spacing < 2 * tool.across) continue;
      EXPECT_TRUE(has(said_of(tool.across, scene.cloud),
                      "if the scene is in millimetres, give `import_cloud` `depth_scale` 1000"))
          << tool.name << " before " << scene.name;
    }
}

TEST(SizeCheck, NamesImagesThatWereDividedByAThousand) {
  for (const NamedScene& scene : scenes(0.001))
    for (const NamedTool& tool : kTools) {
      if (!scene.cloud.sensor || !scene.is_small || tool.across < 0.06) continue;
      EXPECT_TRUE(has(said_of(tool.across, scene.cloud),
                      "if the scene is in metres, give `import_cloud` `depth_scale` 1"))
          << tool.name << " before " << scene.name;
    }
}

TEST(SizeCheck, TellsTheScaleByTheOneThatWasGiven) {
  EXPECT_TRUE(has(said_of(346, wall_at(1), 1000), "if the mesh is in metres, give `scale` 1"));
  EXPECT_TRUE(has(said_of(60, wall_at(1), 0.0254), "give `scale` 2.54e-05"));
  EXPECT_TRUE(has(said_of(60, wall_at(1)), "the tool is 60 m across and the scene 1."));
}

TEST(SizeCheck, NamesTheOptionsOfFrames) {
  const ToolModel tool = cube_of(0.1);
  const ToolModel* const tools[] = {&tool};
  const auto remark = improbable_sizes(tools, checked_scene(wall_at(1300)), true);
  ASSERT_TRUE(remark);
  EXPECT_TRUE(remark->is_warning);
  EXPECT_TRUE(has(remark->text, "give `depth_scale` 1000"));
}

TEST(SizeCheck, SaysNothingOfASceneWithoutPoints) {
  const ToolModel tool = cube_of(1000);
  const ToolModel* const tools[] = {&tool};
  EXPECT_FALSE(improbable_sizes(tools, {}, false));
}

TEST(SizeCheck, MeasuresWhatACameraSeesFromItselfOn) {
  const Pose far{{}, {100, 0, 0}};
  EXPECT_NEAR(size_of(checked_scene(wall_at(1, 3000, far))), 1.05,
              0.02);  // a small patch, 1 m away
  EXPECT_NEAR(checked_scene(wall_at(2, 100, far)).spacing, 0.02, 0.001);
  EXPECT_NEAR(checked_scene(scanned_cube(1, 0.02)).spacing, 0.02, 0.015);
}

}  // namespace
}  // namespace vpm
