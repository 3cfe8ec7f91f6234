#include "libvpm/import/intrinsics_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

IntrinsicsFile parsed(const std::string& text) {
  return parse_intrinsics(bytes_of(text), "file");
}
std::string refused_file(const std::string& text) {
  return test::refusal([&] { parsed(text); });
}

void expect_camera(const std::string& text, std::uint32_t width = 0, std::uint32_t height = 0) {
  const IntrinsicsFile read = parsed(text);
  EXPECT_EQ(read.intrinsics.fx, 525) << text;
  EXPECT_EQ(read.intrinsics.fy, 526) << text;
  EXPECT_EQ(read.intrinsics.cx, 319.5) << text;
  EXPECT_EQ(read.intrinsics.cy, 239.5) << text;
  EXPECT_EQ(read.width, width) << text;
  EXPECT_EQ(read.height, height) << text;
}

TEST(IntrinsicsFile, ReadsText) {
  expect_camera("525 526 319.5 239.5\n");
  expect_camera("# fx fy cx cy\r525,526,+319.5,239.5\r");
  expect_camera("525 0 319.5\r\n0 526 239.5\r\n0 0 1\r\n");
  expect_camera("[[525, 0, 319.5], [0, 526, 239.5], [0, 0, 1]]");
  expect_camera("525 0 319.5 0  0 526 239.5 0  0 0 1 0");
  expect_camera("525 0 319.5 0\n0 526 239.5 0\n0 0 1 0\n0 0 0 1\n");  // ScanNet
  expect_camera(
      "\xEF\xBB\xBF"
      "525 526 319.5 239.5\n");
}

TEST(IntrinsicsFile, ReadsNumbersWithNames) {
  expect_camera("fx = 525\nfy = 526\ncx = 319.5\ncy = 239.5\n");
  expect_camera("fx 525\r\nfy 526\r\n\r\ncx 319.5\r\ncy 239.5  # px\r\nwidth 640\r\nheight 480",
                640, 480);
  expect_camera("width,height,fx,fy,cx,cy\n640,480,525,526,319.5,239.5\n", 640, 480);
  expect_camera("fx: 525, fy: 526, cx: 319.5, cy: 239.5");
  const std::string p = "525 0 319.5 ", q = " 0 526 239.5 0 0 0 1 ";
  expect_camera("calibrated: 9\nP0: " + p + "0" + q + "0\n");  // KITTI
  expect_camera("K_00: 525 0 319.5 0 526 239.5 0 0 1\nD_00: 0 0 0 0 0\n");
#ifdef VPM_TESTS_YAML
  expect_camera("calib_time: 09-Jan-2012 13:57:47\nK_00: 525 0 319.5 0 526 239.5 0 0 1\n");
#endif
  EXPECT_TRUE(
      says(refused_file("P2: " + p + "45" + q + "0.003\n"), "`intrinsics` 525,526,319.5,239.5"));
  EXPECT_TRUE(says(refused_file("P0: " + p + "0" + q + "0\nP1: " + p + "-386" + q + "0\n"),
                   "several cameras: P0, P1"));
  EXPECT_TRUE(says(refused_file("fx 1\nfx 2\nfy 1\ncx 1\ncy 1\n"), "gives fx twice"));
}

TEST(IntrinsicsFile, PixelsOfNerfstudioHaveTheirCentresAtHalves) {
  const IntrinsicsFile read = parsed(R"({"fl_x": 525, "fl_y": 526, "cx": 320, "cy": 240})");
  EXPECT_EQ(read.intrinsics.cx, 319.5);
  EXPECT_EQ(read.intrinsics.cy, 239.5);
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_FALSE(read.remarks[0].is_warning);
  EXPECT_TRUE(says(read.remarks[0].text, "525,526,319.5,239.5 here"));
}

TEST(IntrinsicsFile, RefusesMatricesOfDisplacedCameras) {
  for (const char* text :
       {"525 0 319.5 45  0 526 239.5 0  0 0 1 0", "525 0 319.5 0  0 526 239.5 0  0 0 1 0.1",
        "525 0 319.5 0  0 526 239.5 2  0 0 1 0  0 0 0 1",
        "525 0 319.5 0  0 526 239.5 0  0 0 1 0  0 0 0 2",
        R"({"K": [525, 0, 319.5, 45, 0, 526, 239.5, 0, 0, 0, 1, 0]})"}) {
    EXPECT_TRUE(says(refused_file(text), "is not 0")) << text;
    EXPECT_TRUE(says(refused_file(text), "`intrinsics` 525,526,319.5,239.5")) << text;
  }
  EXPECT_TRUE(says(refused_file("0 1 0 0  -1 0 0 0  0 0 1 0  0 0 0 1"), "its 16 numbers"));
}

TEST(IntrinsicsFile, ReadsJson) {
  expect_camera(
      R"({"width": 640, "height": 480, "fx": 525, "fy": 526, "ppx": 319.5, "ppy": 239.5})", 640,
      480);
  expect_camera(
      R"({"width": 640, "height": 480, "intrinsic_matrix": [525,0,0, 0,526,0, 319.5,239.5,1]})",
      640, 480);
  expect_camera(R"({"K": [525,0,319.5, 0,526,239.5, 0,0,1], "P": [1,0,0,0, 0,1,0,0, 0,0,1,0]})");
  expect_camera(
      R"({"color": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "depth": {"fx": 525, "fy": 526, "cx": 319.5, "cy": 239.5}})");
}

constexpr const char* kMatrix = "[525,0,319.5, 0,526,239.5, 0,0,1]";

TEST(IntrinsicsFile, ComparesKeysWithoutCaseAndUnderscores) {
  for (const char* key :
       {"K", "k", "K1", "M1", "m1", "cameraMatrix", "Camera_Matrix", "CAMERA_MATRIX", "cam_K",
        "intrinsicMatrix", "Intrinsic_Matrix", "intrinsic", "intrinsics", "Camera.K"})
    expect_camera(std::string("{\"") + key + "\": " + kMatrix + "}");
  expect_camera(R"({"FX": 525, "Fy": 526, "CX": 319.5, "c_y": 239.5, "Image_Width": 640})", 640);
}

TEST(IntrinsicsFile, ReadsMatricesAndListsOfIntrinsics) {
  for (const char* value :
       {"[525, 526, 319.5, 239.5]", "[[525, 0, 319.5], [0, 526, 239.5], [0, 0, 1]]",
        "[[525, 0, 319.5, 0], [0, 526, 239.5, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"}) {
    expect_camera(std::string(R"({"intrinsics": )") + value + "}");
    expect_camera(std::string(R"({"cam0": {"intrinsic": )") + value +
                      R"(, "camera_model": "pinhole", "resolution": [640, 480]}})",
                  640, 480);
  }
  EXPECT_TRUE(
      says(refused_file(R"({"camera_model": "omni", "intrinsics": [0.9, 1, 1, 1, 1]})"), "omni"));
  EXPECT_TRUE(
      says(refused_file(R"({"camera_model": "eucm", "intrinsics": [0.9, 1, 1, 1]})"), "eucm"));
}

TEST(IntrinsicsFile, RefusesSeveralCamerasOfOneObjectByTheirNames) {
  const std::string m = kMatrix, other = "[524,0,319.5, 0,526,239.5, 0,0,1]";
  const std::string list = R"({"intrinsics": [1, 1, 1, 1]})",
                    second = R"({"intrinsics": [1, 2, 1, 1]})";
  EXPECT_TRUE(
      says(refused_file(R"({"M1": )" + m + R"(, "M2": )" + other + "}"), "cameras: M1, M2"));
  EXPECT_TRUE(
      says(refused_file(R"({"cam0": )" + list + R"(, "cam1": )" + second + "}"), "cam0, cam1"));
  EXPECT_TRUE(
      says(refused_file(R"({"Camera1.fx": 1, "Camera1.fy": 1, "Camera1.cx": 1, "Camera1.cy": 1,
                               "Camera2.fx": 2, "Camera2.fy": 1, "Camera2.cx": 1, "Camera2.cy": 1})"),
           "camera1, camera2"));
  expect_camera(R"({"M0": [525,0,319.5, 0,526,239.5, 0,0,1], "M1": "none"})");
}

TEST(IntrinsicsFile, RefusesWhatTellsNoCamera) {
  EXPECT_TRUE(says(refused_file("1 2 3\n"), "3 numbers"));
  EXPECT_TRUE(says(refused_file(R"({"fx": 525})"), "no camera's intrinsics"));
  EXPECT_TRUE(says(
      refused_file(
          R"({"left": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "right": {"fx": 1, "fy": 1, "cx": 2, "cy": 1}})"),
      "left, right"));
  EXPECT_TRUE(says(refused_file("0 526 319.5 239.5"), "focal lengths"));
  EXPECT_TRUE(says(refused_file(std::string("fx = 1\0", 8)), "not a text"));
}

TEST(IntrinsicsFile, RefusesACameraThatWasNeverCalibrated) {
  const std::string nine = "[0,0,0, 0,0,0, 0,0,0]", twelve = "[0,0,0,0, 0,0,0,0, 0,0,0,0]";
  for (const std::string& text : std::vector<std::string>{
           R"({"width": 640, "height": 480, "K": )" + nine + R"(, "P": )" + twelve + "}",
           R"({"camera_matrix": {"rows": 3, "cols": 3, "data": )" + nine + "}}",
           R"({"K": [[0,0,0],[0,0,0],[0,0,0]]})", R"({"depth": {"k": )" + nine + "}}"}) {
    EXPECT_TRUE(says(refused_file(text), "is all zeros")) << refused_file(text);
    EXPECT_TRUE(says(refused_file(text), "calibrate the camera")) << refused_file(text);
  }
  // Another matrix in it serves.
  expect_camera(R"({"K": )" + nine + R"(, "P": [525,0,319.5,0, 0,526,239.5,0, 0,0,1,0]})");
}

TEST(IntrinsicsFile, RefusesOtherFormatsByTheirNames) {
  for (const std::string start : {"", "\xEF\xBB\xBF", "\n "}) {
    EXPECT_TRUE(says(refused_file(start + "<?xml version=\"1.0\"?>\n<opencv_storage/>"), "XML"));
    EXPECT_TRUE(says(refused_file(start + "<opencv_storage/>"), ".yml"));
  }
  EXPECT_TRUE(says(refused_file("\x1f\x8b"), "gzip"));
}

TEST(IntrinsicsFile, SaysThatDistortionIsNotUsed) {
  const IntrinsicsFile read =
      parsed(R"({"K": [525,0,319.5, 0,526,239.5, 0,0,1], "D": [0.1, 0, 0, 0, 0]})");
  ASSERT_EQ(read.remarks.size(), 1U);
  EXPECT_TRUE(read.remarks[0].is_warning);
}

// Returns a camera with one more key.
std::string with(const std::string& more, const std::string& before = "") {
  std::string text = "{";
  for (const char* key : {"fx", "fy", "cx", "cy"}) text += '"' + before + key + "\": 100, ";
  return text + more + "}";
}

TEST(IntrinsicsFile, SaysThatDistortionOfSeparateKeysIsNotUsed) {
  for (const char* key : {"k1", "k2", "k3", "p1", "p2", "K1", "k_1"}) {
    for (const std::string before : {"", "Camera.", "Camera1."}) {
      const std::string name = '"' + before + key + "\": ";
      const Remarks remarks = parsed(with(name + "0.26", before)).remarks;
      ASSERT_EQ(remarks.size(), 1U) << name;
      EXPECT_TRUE(remarks[0].is_warning);
      EXPECT_TRUE(says(remarks[0].text, "distortion in it is not used"));
      EXPECT_TRUE(parsed(with(name + "0", before)).remarks.empty()) << name;
    }
  }
  for (const char* key : {"distCoeffs", "distortionCoefficients", "Distortion_Coefficients"})
    EXPECT_EQ(parsed(with('"' + std::string(key) + "\": [0, 0.1]")).remarks.size(), 1U) << key;
  const std::string m = R"({"M1": [525,0,319.5, 0,526,239.5, 0,0,1], "D1": )";
  EXPECT_EQ(parsed(m + "[0.1, 0, 0, 0]}").remarks.size(), 1U);
  EXPECT_TRUE(parsed(m + "[0, 0, 0, 0]}").remarks.empty());
}

// Returns what is said of a factor in a file, where `given` was given.
std::string said_of(const std::string& factor, std::optional<double> given = std::nullopt) {
  std::string said;
  for (const Remark& remark : unused_factor(parsed(with(factor)).factor, given))
    said += (remark.is_warning ? "warning: " : "note: ") + remark.text;
  return said;
}

TEST(IntrinsicsFile, SaysThatADepthFactorIsNotUsed) {
  for (const char* key :
       {"DepthMapFactor", "RGBD.DepthMapFactor", "depth_scale", "png_depth_scale", "scale"}) {
    const std::string factor = '"' + std::string(key) + "\": 5000.0";
    EXPECT_EQ(said_of(factor), "warning: it tells a depth factor, " + std::string(key) +
                                   " 5000, which is not used; give `depth_scale` 5000");
    EXPECT_EQ(said_of(factor, 5000), "");
    EXPECT_TRUE(says(said_of(factor, 1000), "note: ")) << key;
  }
  EXPECT_TRUE(says(said_of(R"("scale": 6553.5)"), "`depth_scale` 6553.5"));
  EXPECT_TRUE(says(said_of(R"("depth_scale": 0.1)"),
                   "if it is in millimetres per unit, give `depth_scale` 10000"));
  EXPECT_TRUE(says(said_of(R"("depth_scale": 0.00025)"),
                   "if it is in metres per unit, give `depth_scale` 4000"));
  EXPECT_TRUE(says(said_of(R"("DepthMapFactor": 200)"), "`depth_scale` 200"));
}

TEST(IntrinsicsFile, SaysNothingOfFactorsThatAreTheDefault) {
  for (const char* factor :
       {R"("name": 1)", R"("depth_scale": 1)", R"("depth_scale": 0.001)", R"("depth_scale": 1000)",
        R"("DepthMapFactor": 1)", R"("DepthMapFactor": 0)", R"("DepthMapFactor": "x")",
        R"("scale": 0.33)", R"("depth_scale": -1)", R"("depth_scale": 1e-320)"})
    EXPECT_EQ(said_of(factor), "") << factor;
}

TEST(IntrinsicsFile, FindsTheDepthFactorBesideTheCamera) {
  const IntrinsicsFile read =
      parsed(R"({"depth_scale": 0.1, "depth": )" + with("\"w\": 640") + "}");
  ASSERT_TRUE(read.factor);
  EXPECT_EQ(read.factor->units_per_metre, 10000);
}

TEST(IntrinsicsFile, TakesTheRectifiedCameraWhereTheLensDistorts) {
  const std::string k = R"("K": [500,0,300, 0,500,200, 0,0,1], )",
                    p = R"("P": [525,0,319.5,-40, 0,526,239.5,0, 0,0,1,0])";
  expect_camera("{" + k + R"("D": [0.1, 0, 0, 0, 0], )" + p + "}");
  const IntrinsicsFile both = parsed("{" + k + R"("D": [0.1, 0, 0, 0, 0], )" + p + "}");
  ASSERT_EQ(both.remarks.size(), 1U);
  EXPECT_TRUE(says(both.remarks[0].text, "its P is used, 525,526,319.5,239.5"));
  const IntrinsicsFile plain = parsed("{" + k + R"("D": [0, 0, 0, 0, 0], )" + p + "}");
  EXPECT_EQ(plain.intrinsics.fx, 500);
  ASSERT_EQ(plain.remarks.size(), 1U);
  EXPECT_TRUE(says(plain.remarks[0].text, "its K is used"));
  const IntrinsicsFile empty = parsed("{" + k + R"("D": [0.1], "P": [0,0,0,0, 0,0,0,0, 0,0,0,0]})");
  EXPECT_EQ(empty.intrinsics.fx, 500);
}

TEST(IntrinsicsFile, ReadsTheRegionOfInterest) {
  const std::string k = R"({"K": [500,0,300, 0,500,200, 0,0,1], "roi": )";
  const auto region =
      parsed(k + R"({"x_offset": 10, "y_offset": 0, "width": 140, "height": 110}})").region;
  ASSERT_TRUE(region);
  EXPECT_EQ(region->left, 10U);
  EXPECT_EQ(region->top, 0U);
  EXPECT_EQ(region->width, 140U);
  EXPECT_FALSE(parsed(k + R"({"x_offset": 0, "y_offset": 0, "width": 0, "height": 0}})").region);
}

#ifdef VPM_TESTS_YAML
TEST(IntrinsicsFile, ReadsYaml) {
  expect_camera(
      "camera_name: 'D435'\nxres: 640  # px\nyres: 480\nfx: 525\nfy: 526\ncx: 319.5\ncy: 239.5\n",
      640, 480);
  expect_camera(
      "image_width: 640\nimage_height: 480\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
      "  data: [525, 0, 319.5, 0, 526, 239.5, 0, 0, 1]\n"
      "distortion_coefficients:\n  data: [0, 0, 0, 0, 0]\n",
      640, 480);
  expect_camera(
      "%YAML:1.0\n---\nCamera.fx: 525.0\nCamera.fy: 526.0\nCamera.cx: 319.5\nCamera.cy: 239.5\n");
  expect_camera(
      "height: 480\nwidth: 640\nk: [525.0, 0.0, 319.5, 0.0, 526.0, 239.5, 0.0, 0.0, 1.0]\n---\n",
      640, 480);
  expect_camera(
      "%YAML:1.0\ncameraMatrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
      "   data: [525., 0., 319.5, 0., 526., 239.5, 0., 0., 1.]\n");  // iai_kinect2
  expect_camera(
      "\xEF\xBB\xBF"
      "camera_model: pinhole\nresolution: [640, 480]\n"
      "intrinsics: [525, 526, 319.5, 239.5] #fu, fv, cu, cv\n",
      640, 480);  // EuRoC
  EXPECT_TRUE(says(refused_file("a: [1\n"), "not YAML"));
}
#endif

// Returns BOP's scene_camera.json of these images, numbered 0, 5, 10, ….
std::string scene_camera(std::size_t images, bool differ) {
  std::string text = "{";
  for (std::size_t k = 0; k < images; ++k)
    text += (k == 0 ? "\"" : ", \"") + std::to_string(5 * k) + "\": {\"cam_K\": [" +
            std::to_string(525 + (differ ? k : 0)) +
            ", 0, 319.5, 0, 526, 239.5, 0, 0, 1], \"depth_scale\": 0.1}";
  return text + "}";
}

TEST(IntrinsicsFile, CamerasThatAreTheSameAreOne) {
  for (const std::size_t images : {1U, 2U, 1000U}) {
    const IntrinsicsFile read = parsed(scene_camera(images, false));
    EXPECT_EQ(read.intrinsics.fx, 525);
    ASSERT_TRUE(read.factor);
    EXPECT_EQ(read.factor->units_per_metre, 10000);
    EXPECT_TRUE(read.remarks.empty());
  }
}

TEST(IntrinsicsFile, TheNumberOfTheImageChooses) {
  const std::string text = scene_camera(1000, true);
  for (const char* const image : {"scene/depth/000035.png", "35.png", "frame-35.depth.png"}) {
    const IntrinsicsFile read = parse_intrinsics(bytes_of(text), "file", image);
    EXPECT_EQ(read.intrinsics.fx, 532);
    ASSERT_EQ(read.remarks.size(), 1U);
    EXPECT_TRUE(
        says(read.remarks[0].text, "of its 1000 cameras, that under the image's number, 35"));
  }
  for (const char* const image : {"", "-", "000036.png", "depth.png"}) {
    const std::string fault =
        test::refusal([&] { parse_intrinsics(bytes_of(text), "file", image); });
    EXPECT_TRUE(says(fault, "several cameras: 0, 10, 100, 1000, 1005 and 995 more")) << fault;
    EXPECT_LT(fault.size(), 200U);
  }
  // A key that only ends in a number is a camera's, not an image's.
  const std::string stereo =
      R"({"cam0": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "cam1": {"fx": 2, "fy": 1, "cx": 1, "cy": 1}})";
  EXPECT_NE(test::refusal([&] { parse_intrinsics(bytes_of(stereo), "file", "0001.png"); }), "");
}

TEST(IntrinsicsFile, ReadsUtf16AndArrays) {
  for (const bool is_big : {false, true}) {
    std::string wide = is_big ? "\xFE\xFF" : "\xFF\xFE";
    for (const char letter : std::string(R"({"fx": 525, "fy": 526, "cx": 319.5, "cy": 239.5})"))
      wide += is_big ? std::string{'\0', letter} : std::string{letter, '\0'};
    expect_camera(wide);
  }
  const auto npy = [](const std::string& shape, const std::vector<double>& numbers) {
    const std::string header =
        "{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }\n";
    std::string bytes("\x93NUMPY\1\0", 8);
    append(bytes, static_cast<std::uint16_t>(header.size()));
    bytes += header;
    for (const double number : numbers) append(bytes, number);
    return bytes;
  };
  expect_camera(npy("(3, 3)", {525, 0, 319.5, 0, 526, 239.5, 0, 0, 1}));
  expect_camera(npy("(4,)", {525, 526, 319.5, 239.5}));
  EXPECT_TRUE(
      says(refused_file(npy("(5, 4)", std::vector<double>(20, 1))), "an array of 5 x 4 is no"));
}

TEST(IntrinsicsFile, OtherFilesAreNamed) {
  for (const auto& [start, name] : std::vector<std::pair<std::string, std::string>>{
           {"MATLAB 5.0 MAT-file, Platform: posix", "a MATLAB file"},
           {"MATLAB 7.3 MAT-file, Platform: posix", "a MATLAB file (HDF5)"},
           {"\x89HDF\r\n\x1a\n", "an HDF5 file"},
           {"\x1a\x45\xdf\xa3", "a Matroska recording"},
           {"\x89PNG\r\n", "a PNG picture"},
           {"ply\n", "a PLY file"}}) {
    EXPECT_TRUE(says(refused_file(start), "this is " + name)) << start;
    EXPECT_TRUE(says(refused_file(start), "`intrinsics` fx,fy,cx,cy")) << start;
  }
}

}  // namespace
}  // namespace vpm
