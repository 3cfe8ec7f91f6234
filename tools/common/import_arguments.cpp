#include "tools/common/import_arguments.h"

#include <vpm/error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "libvpm/core/number_list.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/import/intrinsics_file.h"
#include "libvpm/recording/pose_reader.h"
#include "tools/common/error_text.h"
#include "tools/common/length_units.h"
#include "tools/common/number_checks.h"
#include "tools/common/remarks.h"

namespace vpm::tools {
namespace {

// Returns the numbers of a list; empty if the text is none.
std::vector<double> numbers_in(const std::string& text) {
  try {
    return numbers_from_text(text);
  } catch (const Error&) {
    return {};
  }
}

// True if the text begins with a number, so that it names no file.
bool begins_with_number(const std::string& text) {
  const std::size_t first = std::min(text.find_first_not_of(" [\t"), text.size());
  return file::to_number(text.substr(first, text.find_first_of(", ]\t", first) - first))
      .has_value();
}

void declare_axes(CLI::App& app, ImportArguments& a) {
  app.add_option("--axes", a.axes,
                 "Axes of that frame: opencv (x right, y down, z forward), opengl (x right, y up, "
                 "z backward) or ros (x forward, "
                 "y left, z up)")
      ->check(CLI::IsMember({"opencv", "opengl", "ros"}))
      ->capture_default_str();
}

void declare_values(CLI::App& app, ImportArguments& a) {
  begin_group(app, "How values are read");
  app.add_option(
         "--depth-scale", a.depth_scale,
         "Units of the file per metre; if not given, 1000 for integers and 1 for floats and points")
      ->option_text("S");
  app.add_option("--unit", a.unit, "Unit of the file instead: m, cm, mm, um, in or ft")
      ->check(CLI::IsMember(names_of_units()));
  app.add_option("--invalid", a.invalid,
                 "Values of the file that mean \"not measured\", such as 65535,4095, beside the "
                 "usual 0, 65535, 65504 and 1e10; "
                 "none: 0 only")
      ->join(',')
      ->type_name("FLOAT")
      ->option_text("V,...");
  app.add_option("--range", a.range, "Take depths from NEAR to FAR metres only: near,far")
      ->join(',')
      ->type_name("FLOAT")
      ->option_text("NEAR,FAR");
  app.add_flag(
      "--along-ray", a.along_ray,
      "The file holds distances along the ray; otherwise depth along the optical axis (z)");
  app.add_option("--decode", a.decode,
                 "Undo a coding of 16-bit values: rotated (SUN3D, APC), disparity (raw Kinect, "
                 "NYU), swapped bytes, or big-endian: a PGM's bytes as its standard says, which "
                 "otherwise are looked at")
      ->join(',')
      ->option_text("HOW");
  app.add_option("--channel", a.channel,
                 "Channel of an OpenEXR image that holds depth, if its name does not tell")
      ->option_text("NAME");
  app.add_flag("--flip", a.flip,
               "Turn the normals of points around: they must point into free space");
  app.add_option("--orient", a.orient,
                 "Turn those normals of points that face away from the sensor at a place in the "
                 "world, or so that neighbours agree and solids are inside: x,y,z or neighbours")
      ->join(',')
      ->option_text("HOW");
}

void declare_normals(CLI::App& app, ImportArguments& a) {
  begin_group(app, "Normals", Group::rare);
  app.add_option("--method", a.method,
                 "Estimate normals by inverse-depth, or by pca as printed in 2017")
      ->check(CLI::IsMember({"inverse-depth", "pca"}))
      ->capture_default_str();
  app.add_option("--window", a.window,
                 "Side in pixels of the window that a normal is estimated from: odd, 3 to 31")
      ->check(whole_number_in(0, std::numeric_limits<int>::max()))
      ->capture_default_str();
  app.add_option(
         "--edge-gate", a.edge_gate,
         "Largest relative difference of inverse depth within one surface; 0 finds no edges")
      ->capture_default_str()
      ->option_text("F");
}

std::optional<double> units_per_metre(const ImportArguments& a) {
  if (a.depth_scale && !a.unit.empty())
    refuse_usage("--depth-scale and --unit exclude each other: leave one of them out");
  if (a.depth_scale && !(*a.depth_scale > 0 && std::isfinite(*a.depth_scale)))
    refuse_usage("--depth-scale must be finite and greater than 0");
  if (const std::optional<double> metres = metres_of_unit(a.unit)) return 1 / *metres;
  return a.depth_scale;
}

DepthReading depth_reading(const ImportArguments& a) {
  DepthReading reading;
  reading.units_per_metre = units_per_metre(a);
  reading.along_ray = a.along_ray;
  if (!a.decode.empty()) reading.decoding = decoding_from_text(a.decode);
  reading.has_usual_markers = a.invalid != "none";
  if (!a.invalid.empty() && reading.has_usual_markers) {
    reading.invalid = numbers_in(a.invalid);
    if (reading.invalid.empty())
      refuse_usage("--invalid " + a.invalid +
                   ": give values with commas, such as 65535,4095, or none");
  }
  if (a.range.empty()) return reading;
  const std::vector<double> range = numbers_in(a.range);
  if (range.size() != 2 || !(range[0] >= 0 && range[1] > range[0]))
    refuse_usage("--range " + a.range + ": give near,far in metres, far greater than near");
  reading.nearest = range[0];
  reading.farthest = range[1];
  return reading;
}

void read_intrinsics(const Program& program, const ImportArguments& a, const std::string& image,
                     ImportOptions& options) {
  if (a.intrinsics.empty()) return;
  const std::vector<double> n = numbers_in(a.intrinsics);
  if (begins_with_number(a.intrinsics)) {
    if (n.size() != 4)
      refuse_usage("--intrinsics " + a.intrinsics +
                   ": give four numbers fx,fy,cx,cy, or a file with them");
    options.intrinsics = {n[0], n[1], n[2], n[3]};
  } else {
    const IntrinsicsFile read = parse_intrinsics(file::read_all(a.intrinsics), a.intrinsics, image);
    say(program, a.intrinsics, read.remarks);
    say(program, a.intrinsics, unused_factor(read.factor, options.depth.units_per_metre));
    options.intrinsics = read.intrinsics;
    options.calibrated_width = read.width;
    options.calibrated_height = read.height;
    options.calibrated_region = read.region;
  }
  check_intrinsics(*options.intrinsics);
}

void read_pose(const Program& program, const ImportArguments& a, ImportOptions& options) {
  options.axes = axes_named(a.axes).value_or(CameraAxes::opencv);
  if (a.camera_pose.empty()) return;
  double deviation = 0;
  options.to_world =
      begins_with_number(a.camera_pose)
          ? naming("--camera-pose", [&] { return pose_from_text(a.camera_pose, &deviation); })
          : read_camera_pose(a.camera_pose, &deviation);
  if (deviation > kRotationRounding)
    program.note("--camera-pose: its rotation is not exact and has been normalised");
}

}  // namespace

void declare_camera(CLI::App& app, ImportArguments& a) {
  app.add_option("--intrinsics", a.intrinsics,
                 "Intrinsics of the camera: fx,fy,cx,cy in pixels, or a file with them (text, ROS "
                 "camera_info, RealSense, "
                 "Open3D). An organised PCD needs none")
      ->join(',')
      ->type_name("FLOAT")
      ->option_text("FX,FY,CX,CY or FILE");
  app.add_option("--camera-pose", a.camera_pose,
                 "Pose of the camera, or of the cloud's frame, in the world: tx,ty,tz,qx,qy,qz,qw, "
                 "or a file with it (4x4, TUM, "
                 "JSON)")
      ->join(',')
      ->type_name("FLOAT")
      ->option_text("POSE or FILE");
}

void declare(CLI::App& app, ImportArguments& a) {
  begin_group(app, "Camera and its frame");
  declare_camera(app, a);
  declare_axes(app, a);
  declare_values(app, a);
  declare_normals(app, a);
}

ImportOptions import_options(const Program& program, const ImportArguments& a,
                             const std::string& image) {
  ImportOptions options;
  options.normals = {normal_method_from_text(a.method), a.window, a.edge_gate};
  check_normal_options(options.normals);
  options.depth = depth_reading(a);
  options.channel = a.channel;
  options.flip = a.flip;
  if (!a.orient.empty()) options.orient = orientation_from_text(a.orient);
  read_intrinsics(program, a, image, options);
  read_pose(program, a, options);
  return options;
}

}  // namespace vpm::tools
