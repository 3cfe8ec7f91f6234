#include <gtest/gtest.h>

#include "libvpm/core/error.h"
#include "libvpm/file/temporary_folder.h"
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

// Coordinates are the world's where float32 holds them, and doubles never: some readers take those
// for floats or zeros.
TEST(CloudExport, PlacesAreOfTheWorldWhereFloat32HoldsThem) {
  for (const Vec3 origin : {Vec3{}, Vec3{1, -2, 0.5}, Vec3{60, 0, 0}, Vec3{3e5, 5e6, 100}}) {
    Cloud cloud = without_camera(seen_cloud());
    cloud.origin = origin;
    const bool is_near = norm(origin) < 100;
    for (const std::string& file : {to_ply(cloud), to_pcd(cloud)}) {
      EXPECT_EQ(file.find("vpm origin") == file.npos, is_near) << origin.x;
      EXPECT_EQ(file.find("double"), file.npos);
      const ImportedCloud back = import_cloud(bytes_of(file), "file", {});
      EXPECT_TRUE(back.remarks.empty()) << back.remarks.front().text;
      const std::size_t all = cloud.size();
      ASSERT_EQ(back.cloud.size(), all);
      for (std::size_t k = 0; k < all; ++k)
        EXPECT_LT(norm(back.cloud.origin + widen(back.cloud.positions[k]) - cloud.origin -
                       widen(cloud.positions[k])),
                  1e-5);
    }
  }
}

// What is written of a cloud that float32 does not hold is said, with the place to add.
TEST(CloudExport, ThePlaceToAddIsSaid) {
  const file::TemporaryFolder folder;
  Cloud cloud = without_camera(seen_cloud());
  cloud.origin = {1, 2, 3};
  EXPECT_TRUE(write_points(folder.path("near.ply"), cloud).empty());
  cloud.origin = {3e5, 5e6, 100};
  for (const char* const name : {"far.ply", "far.pcd"}) {
    const Remarks said = write_points(folder.path(name), cloud);
    ASSERT_EQ(said.size(), 1U);
    EXPECT_FALSE(said[0].is_warning);
    EXPECT_TRUE(says(said[0].text, "about 300000, 5000000, 100, which"));
  }
  const Cloud seen = seen_cloud();
  EXPECT_TRUE(write_points(folder.path("seen.pcd"), seen).empty());
}

TEST(CloudExport, OnlyKnownExtensions) {
  EXPECT_NO_THROW(check_points_path("a.ply"));
  EXPECT_THROW(check_points_path("a.xyz"), Error);
}

}  // namespace
}  // namespace vpm
