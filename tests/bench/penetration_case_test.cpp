#include "tools/bench/penetration_case.h"

#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/synthetic/scenes.h"

namespace vpm::bench {
namespace {

TEST(Path, StartsClearAndGoesDeeperAllTheWay) {
  const Rotation turned = rotation_from_quaternion({0.18, -0.37, 0.29, std::sqrt(1 - 0.2534)});
  for (const char* scene_name : {"wall", "inverted-ball", "ball", "groove"}) {
    const synthetic::Scene scene = synthetic::make_scene(scene_name);
    for (const char* shape : {"cube", "torus"}) {
      SCOPED_TRACE(std::string(shape) + " into " + scene_name);
      const synthetic::TrueSolid tool(make_shape(shape));
      const auto path = make_path(tool, turned, *scene.surface, 12);
      const auto truth = truth_along(tool, path, *scene.surface);
      ASSERT_EQ(truth.size(), 12u);
      EXPECT_EQ(truth[0].volume, 0);
      for (std::size_t k = 1; k < truth.size(); ++k)
        EXPECT_GE(truth[k].volume, truth[k - 1].volume - truth[k].error);
      EXPECT_GT(truth.back().volume, 0.5 * tool.mass().volume);
      EXPECT_LT(truth.back().volume, 0.99 * tool.mass().volume);
    }
  }
}

TEST(Path, FirstContactIsWhereTheShapeTouches) {
  const synthetic::Scene scene = synthetic::make_scene("wall");
  const synthetic::TrueSolid cube(make_shape("cube"));
  const auto path = make_path(cube, {}, *scene.surface, 18);  // steps of 5 % of the height
  EXPECT_NEAR(path[1].translation.z, 0.9, 1e-6);
  EXPECT_NEAR(path.back().translation.z, 0.9 + 0.2 * kDeepest, 1e-6);
}

TEST(Shape, UnknownNameIsRefused) {
  EXPECT_THROW(make_shape("teapot"), Error);
}

}  // namespace
}  // namespace vpm::bench
