// Frames of real cameras, if the data set lies beside the repository.
#include <gtest/gtest.h>

#include <filesystem>
#include <span>
#include <string>

#include "libvpm/file/stream.h"
#include "libvpm/import/cloud_export.h"
#include "libvpm/import/import_cloud.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

struct Frame {
  std::string file;
  Intrinsics intrinsics;
  double units_per_metre;
  std::size_t width, height, measured;
};

class RealFrame : public testing::TestWithParam<Frame> {};

INSTANTIATE_TEST_SUITE_P(
    Frames, RealFrame,
    testing::Values(
        Frame{"tum_desk_depth.png", {525, 525, 319.5, 239.5}, 5000, 640, 480, 248250},
        Frame{
            "redkitchen_seq/frame-000460.depth.png", {585, 585, 320, 240}, 1000, 640, 480, 284734},
        Frame{
            "d435_000000080-transparent-depth-img.exr", {921, 921, 642, 359}, 1, 1280, 720, 796325},
        Frame{"d435_000000080-opaque-depth-img.exr", {921, 921, 642, 359}, 1, 1280, 720, 840522},
        Frame{"kinect_capture0001.pcd", {525, 525, 319.5, 239.5}, 1, 640, 480, 249647}),
    [](const auto& frame) { return test::test_name(frame.param.file); });

// Expects that what is exported of a cloud is read without a warning, as many points as it has.
void expect_to_come_back(const Cloud& cloud) {
  for (const std::string& file : {to_ply(cloud), to_pcd(cloud), to_pcd(without_camera(cloud))}) {
    const ImportedCloud back =
        import_cloud(std::as_bytes(std::span(file.data(), file.size())), "export", {});
    EXPECT_EQ(back.cloud.size(), cloud.size());
    for (const Remark& remark : back.remarks) EXPECT_FALSE(remark.is_warning) << remark.text;
  }
}

TEST_P(RealFrame, BecomesASoundCloud) {
  const Frame& frame = GetParam();
  const std::string path = VPM_SOURCE_DIR "/../shared/data/depth/" + frame.file;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
#ifndef VPM_TESTS_EXR
  if (path.ends_with(".exr")) GTEST_SKIP() << "built without OpenEXR";
#endif
  ImportOptions options;
  options.intrinsics = frame.intrinsics;
  options.depth.units_per_metre = frame.units_per_metre;
  const ImportedCloud imported = import_cloud(file::read_all(path), path, options);
  validate(imported.cloud, path);
  for (const Remark& remark : imported.remarks) EXPECT_FALSE(remark.is_warning) << remark.text;
  EXPECT_EQ(imported.width, frame.width);
  EXPECT_EQ(imported.height, frame.height);
  EXPECT_EQ(frame.width * frame.height - imported.invalid, frame.measured);
  expect_to_come_back(imported.cloud);
  // Nearly every measured pixel has enough neighbours.
  EXPECT_GT(static_cast<double>(imported.cloud.size()),
            0.999 * static_cast<double>(frame.measured));
}

TEST(RealCloud, TheKinectCloudTellsItsCamera) {
  const std::string path = VPM_SOURCE_DIR "/../shared/data/depth/kinect_capture0001.pcd";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const ImportedCloud imported = import_cloud(file::read_all(path), path, {});
  const Intrinsics& k = imported.cloud.sensor->camera.intrinsics;
  EXPECT_NEAR(k.fx, 525, 1e-3);
  EXPECT_NEAR(k.fy, 525, 1e-3);
  EXPECT_NEAR(k.cx, 319.5, 1e-3);
  EXPECT_NEAR(k.cy, 239.5, 1e-3);
}

}  // namespace
}  // namespace vpm
