#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/cloud/normals.h"
#include "tests/cloud/normal_scene.h"

namespace vpm {
namespace {

const Camera kCamera{{525, 500, 15.5, 11.5},
                     32,
                     24,
                     {rotation_from_quaternion({0.5, -0.5, 0.5, 0.5}), {1e7, -3, 2}}};

TEST(MakeCloud, PointsLieOnTheirRaysAboutTheCamera) {
  const Vec3 normal = Vec3{0.2, -0.4, -1} / norm({0.2, -0.4, -1});
  const DepthImage image = plane_image(kCamera, normal, 0.8);
  const Cloud cloud = make_cloud(image, kCamera, {});
  validate(cloud, "cloud");
  ASSERT_EQ(cloud.size(), image.depth.size());
  EXPECT_EQ(cloud.origin, kCamera.to_world.translation);
  const Rotation& rotation = kCamera.to_world.rotation;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    ASSERT_EQ(cloud.pixels[k], k);
    const Vec3 seen = unproject(kCamera.intrinsics, static_cast<double>(k % image.width),
                                static_cast<double>(k / image.width), image.depth[k]);
    ASSERT_EQ(cloud.positions[k], narrow(rotation * seen));
    ASSERT_LT(angle_between(cloud.normals[k], rotation * normal), 1e-4);
  }
}

TEST(MakeCloud, DisksOfNeighbouringPixelsCoverThePlane) {
  const Vec3 normal = Vec3{0.9, -0.5, -1} / norm({0.9, -0.5, -1});
  const DepthImage image = plane_image(kCamera, normal, 0.8);
  const Cloud cloud = make_cloud(image, kCamera, {});
  // The corners between four pixels are the places farthest from all pixels.
  for (std::uint32_t v = 0; v + 1 < image.height; ++v) {
    for (std::uint32_t u = 0; u + 1 < image.width; ++u) {
      const Vec3 ray = unproject(kCamera.intrinsics, u + 0.5, v + 0.5, 1);
      const Vec3 corner = kCamera.to_world.rotation * (ray * (-0.8 / dot(normal, ray)));
      bool covered = false;
      for (const std::size_t k : {image.index(u, v), image.index(u + 1, v), image.index(u, v + 1),
                                  image.index(u + 1, v + 1)})
        covered = covered || norm(widen(cloud.positions[k]) - corner) < cloud.radii[k];
      ASSERT_TRUE(covered) << u << " " << v;
    }
  }
}

TEST(MakeCloud, KeepsTheDepthImageAndOnlyPointsWithNormals) {
  DepthImage image = plane_image(kCamera, {0, 0, -1}, 1);
  image.depth[5] = std::nanf("");
  image.depth[6] = -2;
  for (std::uint32_t v = 0; v < image.height; ++v) {
    for (std::uint32_t u = 20; u < image.width; ++u)
      image.depth[image.index(u, v)] = u == 26 && v == 12 ? 1.0F : 0.0F;  // one pixel on its own
  }
  const Cloud cloud = make_cloud(image, kCamera, {});
  validate(cloud, "cloud");
  EXPECT_EQ(cloud.size(), 20U * 24 - 2);
  ASSERT_TRUE(cloud.sensor);
  EXPECT_EQ(cloud.sensor->depth.depth[5], 0);
  EXPECT_EQ(cloud.sensor->depth.depth[6], 0);
  EXPECT_EQ(cloud.sensor->depth.depth[image.index(26, 12)], 1) << "seen, though without a normal";
}

TEST(MakeCloud, GrazingDisksStayBounded) {
  // At 89 degrees off the ray the pixel's footprint would be 57 times its width.
  const double tilt = 89 * 3.14159265358979323846 / 180;
  const DepthImage image = plane_image({{5000, 5000, 15.5, 11.5}, 32, 24, {}},
                                       {std::sin(tilt), 0, -std::cos(tilt)}, 0.01);
  const Cloud cloud = make_cloud(image, {{5000, 5000, 15.5, 11.5}, 32, 24, {}}, {});
  ASSERT_GT(cloud.size(), 0U);
  for (std::size_t k = 0; k < cloud.size(); ++k)
    ASSERT_LT(cloud.radii[k], 10.01 * cloud.positions[k].z / 5000);
}

}  // namespace
}  // namespace vpm
