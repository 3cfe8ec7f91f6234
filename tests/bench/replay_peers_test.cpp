#include "tools/bench/replay_peers.h"

#include <gtest/gtest.h>

#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm::bench {
namespace {

// Sets up a wall at 1 m and a cube, half of which is behind it.
class ReplayPeers : public testing::Test {
 protected:
  const synthetic::Scene scene_ = synthetic::make_scene("wall");
  const PixelCloud cloud_ =
      make_pixel_cloud(synthetic::render(*scene_.surface, scene_.camera), scene_.camera);
  const Peers peers_{synthetic::make_cube(0.2)};
};

TEST_F(ReplayPeers, CountTheVolumeBehindTheImage) {
  for (const double deep : {0.0, 0.05, 0.15}) {
    const double volume = peers_.count_voxels(cloud_, {{}, {0, 0, 0.9 + deep}});
    EXPECT_NEAR(volume, 0.2 * 0.2 * deep, 0.015 * 0.2 * 0.2 * 0.2) << deep;
  }
}

TEST_F(ReplayPeers, PushTheToolBackFromTheWall) {
  const Wrench none = peers_.penalty(cloud_, {{}, {0, 0, 0.85}});
  EXPECT_EQ(none.force, (Vec3{}));
  const Wrench pushed = peers_.penalty(cloud_, {{}, {0, 0, 0.95}});
  EXPECT_LT(pushed.force.z, 0);
  EXPECT_NEAR(pushed.force.x, 0, 1e-3 * -pushed.force.z);
  // Each pixel's point has the depth of the nearest face of the cube.
  const Wrench deeper = peers_.penalty(cloud_, {{}, {0, 0, 0.98}});
  EXPECT_LT(deeper.force.z, pushed.force.z);
}

}  // namespace
}  // namespace vpm::bench
