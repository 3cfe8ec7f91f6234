#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/import/cloud_export.h"
#include "libvpm/import/import_cloud.h"
#include "tests/import/test_files.h"

namespace vpm {
namespace {

Cloud seen_cloud() {
  DepthImage depth{20, 16, std::vector<float>(320, 1.25F)};
  for (std::size_t i = 0; i < depth.depth.size(); ++i)
    depth.depth[i] += 0.01F * static_cast<float>(i % 20);
  depth.depth[33] = 0;
  const Pose pose{rotation_from_quaternion({0.5, 0.5, -0.5, 0.5}), {1, -2, 0.5}};
  return make_cloud(depth, {{100, 110, 9.5, 7.5}, 20, 16, pose}, {});
}

TEST(CloudExport, AnOrganisedPcdComesBackAsTheSameCloud) {
  const Cloud cloud = seen_cloud();
  ImportOptions options;
  options.intrinsics = cloud.sensor->camera.intrinsics;
  const Cloud back = import_cloud(bytes_of(to_pcd(cloud)), "file", options).cloud;
  EXPECT_EQ(back.sensor->depth.depth, cloud.sensor->depth.depth);
  EXPECT_EQ(back.pixels, cloud.pixels);
  EXPECT_EQ(back.origin, cloud.origin);
  ASSERT_EQ(back.size(), cloud.size());
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    EXPECT_LT(norm(widen(back.positions[k]) - widen(cloud.positions[k])), 1e-6);
    EXPECT_LT(norm(widen(back.normals[k]) - widen(cloud.normals[k])), 1e-6);
  }
}

TEST(CloudExport, PlyAndScatteredPcdComeBackAtTheSamePlaces) {
  Cloud cloud = without_camera(seen_cloud());
  cloud.origin = {1e7, 0, 0};
  for (const std::string& file : {to_ply(cloud), to_pcd(cloud)}) {
    const Cloud back = import_cloud(bytes_of(file), "file", {}).cloud;
    ASSERT_EQ(back.size(), cloud.size());
    for (std::size_t k = 0; k < cloud.size(); ++k) {
      const Vec3 there = back.origin + widen(back.positions[k]);
      EXPECT_LT(norm(there - (cloud.origin + widen(cloud.positions[k]))), 4e-9 + 1e-7);
      EXPECT_LT(norm(widen(back.normals[k]) - widen(cloud.normals[k])), 1e-6);
    }
  }
}

TEST(CloudExport, OnlyKnownExtensions) {
  EXPECT_NO_THROW(check_points_path("a.ply"));
  EXPECT_THROW(check_points_path("a.xyz"), Error);
}

}  // namespace
}  // namespace vpm
