#include "libvpm/import/import_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "libvpm/core/error.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

const Intrinsics kPlaneCamera{100, 110, 9.5, 7.5};
constexpr std::uint32_t kWidth = 20, kHeight = 16;

// Returns a tilted plane seen by the camera, as organised PCD in text.
std::string organised_pcd(double bend = 0) {
  std::string file =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\n"
      "WIDTH 20\nHEIGHT 16\nVIEWPOINT 5 0 0 1 0 0 0\nPOINTS 320\nDATA ascii\n";
  for (std::uint32_t v = 0; v < kHeight; ++v) {
    for (std::uint32_t u = 0; u < kWidth; ++u) {
      const Vec3 p = unproject(kPlaneCamera, u + bend * u * u, v, 1 + 0.002 * u + 0.003 * v);
      char line[128];
      std::snprintf(line, sizeof line, u == 3 && v == 4 ? "nan nan nan\n" : "%.9g %.9g %.9g\n", p.x,
                    p.y, p.z);
      file += line;
    }
  }
  return file;
}

// Returns the same cloud with the coordinates of each point as `change` makes them.
template <class Change>
std::string changed_pcd(const Change& change) {
  std::string file = organised_pcd();
  const std::size_t data = file.find("ascii\n") + 6;
  std::string rows = file.substr(data);
  file.resize(data);
  for (std::size_t at = 0; at < rows.size(); at = rows.find('\n', at) + 1) {
    Vec3 p{};
    char line[128] = "nan nan nan\n";
    if (std::sscanf(rows.c_str() + at, "%lf %lf %lf", &p.x, &p.y, &p.z) == 3 && p.z > 0) {
      p = change(p);
      std::snprintf(line, sizeof line, "%.9g %.9g %.9g\n", p.x, p.y, p.z);
    }
    file += line;
  }
  return file;
}

std::string depth_png() {
  std::vector<std::uint16_t> values(std::size_t{kWidth} * kHeight, 2000);
  values[7] = 0;
  return make_png(kWidth, kHeight, 16, values);
}

ImportedCloud import(const std::string& file, const ImportOptions& options = {}) {
  return import_cloud(bytes_of(file), "file", options);
}
std::string refused(const std::string& file, const ImportOptions& options = {}) {
  return test::refusal([&] { import(file, options); });
}

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
    "0 0 0 0 0 1\n1 0 0 0 0 2\n0 1 0 0 0 1\nnan 1 0 0 0 1\n";

TEST(ImportCloud, RecoversTheCameraOfAnOrganisedCloud) {
  const ImportedCloud imported = import(organised_pcd());
  validate(imported.cloud, "cloud");
  EXPECT_TRUE(imported.intrinsics_recovered);
  EXPECT_TRUE(imported.normals_estimated);
  EXPECT_EQ(imported.invalid, 1U);
  EXPECT_EQ(imported.cloud.size(), 319U);
  const Camera& camera = imported.cloud.sensor->camera;
  EXPECT_NEAR(camera.intrinsics.fx, 100, 1e-5);
  EXPECT_NEAR(camera.intrinsics.fy, 110, 1e-5);
  EXPECT_NEAR(camera.intrinsics.cx, 9.5, 1e-5);
  EXPECT_NEAR(camera.intrinsics.cy, 7.5, 1e-5);
  EXPECT_EQ(imported.cloud.origin, (Vec3{5, 0, 0})) << "the VIEWPOINT";
}

// Returns points of a plane, written by a program that knows the sensor's place as a point among
// them or as the pose of their frame.
std::string plane_with_viewpoint(const std::string& viewpoint, double z, double normal_z) {
  std::string file =
      "VERSION 0.7\nFIELDS x y z normal_x normal_y normal_z\nSIZE 8 8 8 8 8 8\nTYPE F F F F F F\n"
      "COUNT 1 1 1 1 1 1\nWIDTH 320\nHEIGHT 1\nVIEWPOINT " +
      viewpoint + "\nPOINTS 320\nDATA ascii\n";
  for (int k = 0; k < 320; ++k) {
    char line[128];
    std::snprintf(line, sizeof line, "%.9g %.9g %.9g 0 0 %.9g\n", 0.01 * (k % 20), 0.01 * (k / 20),
                  z, normal_z);
    file += line;
  }
  return file;
}

TEST(ImportCloud, NormalsTellWhetherTheViewpointIsAPointOrAPose) {
  const auto height = [](const ImportedCloud& imported) {
    return imported.cloud.origin.z + imported.cloud.positions[0].z;
  };
  // Normals face the viewpoint among the points: they are in the world already.
  for (const char* const among : {"0 0 5 0 1 0 0", "0 0 5 1 0 0 0"}) {
    const ImportedCloud imported = import(plane_with_viewpoint(among, 1, 1));
    EXPECT_NEAR(height(imported), 1, 1e-6) << among;
    ASSERT_FALSE(imported.remarks.empty());
    EXPECT_TRUE(says(imported.remarks[0].text, "in the world's frame"));
    for (const Remark& remark : imported.remarks) EXPECT_FALSE(remark.is_warning) << remark.text;
  }
  EXPECT_NEAR(height(import(plane_with_viewpoint("0 0 2 1 0 0 0", 0, 1))), 0, 1e-6);
  // Normals face the origin of the points' frame, the sensor.
  const ImportedCloud of_sensor = import(plane_with_viewpoint("0 0 5 0 1 0 0", 1, -1));
  EXPECT_NEAR(height(of_sensor), 4, 1e-6);
  EXPECT_TRUE(says(of_sensor.remarks[0].text, "pose of its points' frame"));
  // With --flip the normals of the file are meant the other way.
  ImportOptions flipped;
  flipped.flip = true;
  EXPECT_NEAR(height(import(plane_with_viewpoint("0 0 5 0 1 0 0", 1, -1), flipped)), 1, 1e-6);
  // A pose that is given goes before all this.
  ImportOptions told;
  told.to_world = Pose{{}, {0, 0, 7}};
  EXPECT_NEAR(height(import(plane_with_viewpoint("0 0 5 0 1 0 0", 1, 1), told)), 8, 1e-6);
}

TEST(ImportCloud, RefusesAGridThatIsNoPinholeCameras) {
  EXPECT_TRUE(says(refused(organised_pcd(0.02)), "fits no pinhole camera"));
  EXPECT_TRUE(says(refused(organised_pcd(0.02)), "pixels from where"));
  ImportOptions options;
  options.intrinsics = Intrinsics{150, 150, 9.5, 7.5};
  EXPECT_TRUE(says(refused(organised_pcd(), options), "do not fit the intrinsics given"));
  options.intrinsics = kPlaneCamera;
  EXPECT_FALSE(import(organised_pcd(), options).intrinsics_recovered);
}

TEST(ImportCloud, TellsAGridThatIsTurnedOrMirrored) {
  const auto said = [](const auto& change) {
    const std::string without = refused(changed_pcd(change));
    ImportOptions options;
    options.intrinsics = kPlaneCamera;
    EXPECT_EQ(refused(changed_pcd(change), options), without) << "no camera would help";
    return without;
  };
  const std::string mirrored = said([](Vec3 p) { return Vec3{-p.x, p.y, p.z}; });
  EXPECT_TRUE(says(mirrored, "mirrored left to right; mirror the grid back")) << mirrored;
  EXPECT_TRUE(says(said([](Vec3 p) { return Vec3{p.x, -p.y, p.z}; }), "upside down, and so mir"));
  EXPECT_TRUE(says(said([](Vec3 p) {
                     return Vec3{p.y, p.x, p.z};
                   }),
                   "is transposed, and so mirrored; mir"));
  const std::string turned = said([](Vec3 p) { return Vec3{p.y, -p.x, p.z}; });
  EXPECT_TRUE(says(turned, "turned by 90 degrees; turn the grid back")) << turned;
  EXPECT_TRUE(says(said([](Vec3 p) { return Vec3{-p.x, -p.y, p.z}; }), "turned by 180 degrees"));
  // Points in the world's frame may look like a grid that is turned.
  std::string unplaced = changed_pcd([](Vec3 p) { return Vec3{p.y, -p.x, p.z}; });
  unplaced.replace(unplaced.find("VIEWPOINT 5"), 11, "VIEWPOINT 0");
  EXPECT_TRUE(says(refused(unplaced), "their camera's `camera_pose`"));
  const double half = std::sqrt(0.5);
  ImportOptions posed;
  posed.to_world = Pose{rotation_from_quaternion({0, 0, -half, half}), {}};
  EXPECT_TRUE(import(unplaced, posed).intrinsics_recovered);
  EXPECT_TRUE(says(said([](Vec3) { return Vec3{0, 0, 1}; }), "319 of its 320 points have z > 0"));
}

TEST(ImportCloud, LeavingIntrinsicsOutIsAdvisedWhereItHelps) {
  ImportOptions options;
  options.intrinsics = Intrinsics{150, 150, 9.5, 7.5};
  EXPECT_TRUE(says(refused(organised_pcd(), options), "leave `intrinsics` out"));
  const std::string none = refused(organised_pcd(0.02), options);
  EXPECT_FALSE(says(none, "leave `intrinsics` out")) << none;
  EXPECT_TRUE(says(none, "fits no pinhole camera")) << none;
}

TEST(ImportCloud, DepthImagesNeedIntrinsicsAndTakeScaleAndPose) {
  EXPECT_EQ(test::kind_of_fault([] { import(depth_png()); }), ErrorKind::invalid_argument);
  ImportOptions options;
  options.intrinsics = kPlaneCamera;
  options.to_world = Pose{{}, {1, 2, 3}};
  const ImportedCloud imported = import(depth_png(), options);
  EXPECT_EQ(imported.width, kWidth);
  EXPECT_EQ(imported.invalid, 1U);
  EXPECT_EQ(imported.cloud.positions[0].z, 2);
  EXPECT_EQ(imported.cloud.origin, (Vec3{1, 2, 3}));
  options.depth.units_per_metre = 4000;
  EXPECT_EQ(import(depth_png(), options).cloud.positions[0].z, 0.5F);
}

TEST(ImportCloud, ScatteredPointsKeepTheirNormals) {
  const ImportedCloud imported = import(kPly);
  validate(imported.cloud, "cloud");
  EXPECT_FALSE(imported.normals_estimated);
  EXPECT_FALSE(imported.cloud.sensor);
  EXPECT_EQ(imported.cloud.size(), 3U);
  EXPECT_EQ(imported.invalid, 1U);
  EXPECT_EQ(imported.cloud.normals[1], (Vec3f{0, 0, 1}));
}

// Returns all that is said about the file.
std::string said(const std::string& file, const ImportOptions& options = {}) {
  std::string text;
  for (const Remark& remark : import(file, options).remarks) text += remark.text + "\n";
  return text;
}

TEST(ImportCloud, CommentsAloneMakeNoPcd) {
  EXPECT_TRUE(says(refused("# made by hand\nmtllib a.mtl\nv 0 0 0\n"), "neither PNG"));
  EXPECT_TRUE(says(refused("# made by hand\n\nVERSION 0.7\n"), "PCD header"));
}

TEST(ImportCloud, SaysThatIntrinsicsAreThoseOfAnotherImage) {
  const auto said_with = [](const Intrinsics& k) {
    ImportOptions options;
    options.intrinsics = k;
    return said(depth_png(), options);
  };
  // The image has 20 x 16 pixels.
  EXPECT_FALSE(says(said_with({15, 15, 9.5, 7.5}), "intrinsics"));
  EXPECT_FALSE(says(said_with({15, 16, 11, 6}), "intrinsics"));
  EXPECT_TRUE(
      says(said_with({30, 30, 19.5, 15.5}),
           "lies far from the middle of the image of 20 x 16 pixels; if that was scaled from "
           "40 x 32, give `intrinsics` 15,15,9.5,7.5"));
  EXPECT_TRUE(says(said_with({60, 60, 39.5, 31.5}), "lies outside of the image"));
  EXPECT_TRUE(says(said_with({60, 60, 39.5, 31.5}), "give `intrinsics` 15,15,9.5,7.5"));
  EXPECT_TRUE(says(said_with({7.5, 7.5, 4.5, 3.5}), "give `intrinsics` 15,15,9.5,7.5"));
  EXPECT_TRUE(says(said_with({15, 15, 0, 0}), "lies far from the middle"));
  EXPECT_TRUE(says(said_with({15, 9.5, 15, 7.5}), "is their order fx,fy,cx,cy?"));
}

// Returns a PLY of a wall whose points are 10 mm apart, moved by `offset`, in this format of
// printf.
std::string wall_text(Vec3 offset, const char* format) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\n"
      "property double z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n";
  for (int k = 0; k < 400; ++k) {
    const Vec3 p = offset + Vec3{0.01 * (k % 20), 0.01 * (k / 20), 1};
    for (const double c : {p.x, p.y, p.z}) {
      char number[40];
      std::snprintf(number, sizeof number, format, c);
      text += number + std::string(" ");
    }
    text += "0 0 -1\n";
  }
  return text;
}

TEST(ImportCloud, SaysThatNumbersAreTooCoarseForThePoints) {
  const Vec3 far{10000.123, 5000.321, 0.5};
  EXPECT_TRUE(says(said(wall_text(far, "%.6g")), "numbers of six digits up to 1e+04 m"));
  EXPECT_TRUE(says(said(wall_text(far, "%.6g")), "write them with more digits"));
  EXPECT_EQ(said(wall_text(far, "%.12g")), "");
  EXPECT_EQ(said(wall_text({0.123, 0.321, 0.5}, "%.6g")), "");
}

TEST(ImportCloud, SaysWhichOptionsAreNotUsed) {
  ImportOptions options;
  options.intrinsics = kPlaneCamera;
  options.axes = CameraAxes::opengl;
  EXPECT_TRUE(says(said(depth_png(), options), "`axes` is not used"));
  options.to_world = Pose{};
  EXPECT_FALSE(says(said(depth_png(), options), "`axes`"));
  ImportOptions of_points;
  of_points.channel = "Z";
  of_points.depth.decoding.swapped = true;
  EXPECT_TRUE(says(said(kPly, of_points), "`channel` is not used"));
  EXPECT_TRUE(says(said(kPly, of_points), "`decode` is not used"));
}

// Returns a wall at z = 1 with this normal, as points without a viewpoint.
std::string wall_ply(const char* normal) {
  std::string file =
      "ply\nformat ascii 1.0\nelement vertex 25\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n";
  for (int k = 0; k < 25; ++k)
    file += std::to_string(0.1 * (k % 5 - 2)) + " " + std::to_string(0.1 * (k / 5 - 2)) + " 1 " +
            normal + "\n";
  return file;
}

TEST(ImportCloud, NormalsThatFaceAwayAreSaidWhereThatCanBeJudged) {
  EXPECT_TRUE(says(said(wall_ply("0 0 1")), "give `flip` to turn them"));
  EXPECT_EQ(said(wall_ply("0 0 -1")), "");
  ImportOptions flips;
  flips.flip = true;
  EXPECT_EQ(said(wall_ply("0 0 1"), flips), "");
  EXPECT_TRUE(says(said(wall_ply("0 0 -1"), flips), "leave `flip` out"));
  EXPECT_FALSE(says(said(kPly), "face away"));  // points about the origin
}

TEST(ImportCloud, TheSizeOfACalibrationTellsWhatWasDone) {
  ImportOptions options;
  options.intrinsics = Intrinsics{100, 100, 19.5, 15.5};
  options.calibrated_width = 40;
  options.calibrated_height = 32;
  EXPECT_TRUE(says(refused(depth_png(), options), "if it was scaled"));
  options.calibrated_region = ImageRegion{10, 5, kWidth, kHeight};
  EXPECT_TRUE(says(refused(depth_png(), options), "`intrinsics` 100,100,9.5,10.5"));
  options.calibrated_region.reset();
  options.calibrated_height = 20;
  EXPECT_TRUE(says(refused(depth_png(), options), "another shape"));
}

TEST(ImportCloud, SaysWhyNothingIsMeasured) {
  ImportOptions options;
  options.intrinsics = kPlaneCamera;
  EXPECT_TRUE(
      says(refused(make_png(20, 16, 16, std::vector<std::uint16_t>(320)), options), "all are 0"));
  options.depth.nearest = 100;
  options.depth.farthest = 5000;
  EXPECT_TRUE(says(refused(depth_png(), options), "its depths are from 2 m to 2 m"));
  std::string negative = "Pf\n2 1\n-1.0\n";
  append(negative, -1.F);
  append(negative, -2.F);
  EXPECT_TRUE(says(refused(negative, options), "all are negative"));
  ImportOptions metres_per_unit;
  metres_per_unit.intrinsics = kPlaneCamera;
  metres_per_unit.depth.units_per_metre = 0.001;
  std::vector<std::uint16_t> near(320, 500);
  EXPECT_TRUE(says(said(make_png(20, 16, 16, near), metres_per_unit), "give 1000"));
}

TEST(ImportCloud, RefusesWhatHoldsNoCloud) {
  EXPECT_TRUE(says(refused(""), "empty"));
  EXPECT_TRUE(
      says(refused("OF\n0 0 0\n"), "neither PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD nor PLY"));
  for (const char* const table : {"0 0 1 0 0 -1\n1 0 1 0 0 -1\n", "//X Y Z\n0 0 1\n1 0 1\n",
                                  "0.5;0.5;0.5;0.5\n0.5;0.5;0.5;0.5\n"})
    EXPECT_TRUE(says(refused(table), "a table of numbers in text; save points as PLY or PCD"));
  EXPECT_TRUE(
      says(refused("OFF\n0 0 0\n"), "this is a mesh in OFF; give a depth image or a cloud"));
  EXPECT_TRUE(says(refused("P7\nWIDTH 2\n"), "a PAM picture; save it as PGM"));
  EXPECT_TRUE(says(refused("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                           "property float y\nproperty float z\nend_header\n1 2 3\n"),
                   "need normals"));
  ImportOptions options;
  options.intrinsics = kPlaneCamera;
  std::vector<std::uint16_t> nothing(320, 0);
  EXPECT_TRUE(
      says(refused(make_png(20, 16, 16, nothing), options), "no pixel holds a measurement"));
  nothing[100] = 1000;
  EXPECT_TRUE(says(refused(make_png(20, 16, 16, nothing), options), "neighbours enough"));
}

}  // namespace
}  // namespace vpm
