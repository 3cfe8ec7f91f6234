#include "libvpm/import/point_scan.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/scattered_points.h"
#include "libvpm/core/error.h"
#include "libvpm/core/rounding.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/import/normal_checks.h"
#include "libvpm/import/pinhole_fit.h"
#include "libvpm/import/point_files.h"
#include "libvpm/import/remark.h"

namespace vpm {
namespace {

// Holds what a file tells of the frame that its points are in.
struct PointFrame {
  CameraAxes axes = CameraAxes::opencv;  // axes of the points
  std::optional<Pose> to_world;          // pose of those axes; translation in the file's unit
};

// Points of a grid, in their camera's frame, with that camera.
struct OrganisedView {
  PointSet points;
  PinholeFit fit;
  bool were_in_world = false;  // the file's points were in the world's frame
};

PointSet moved(PointSet points, const Pose& pose) {
  for (Vec3& p : points.positions) p = pose * p;
  for (Vec3& n : points.normals) n = pose.rotation * n;
  return points;
}

// Returns the points turned to this library's axes.
PointSet in_own_axes(PointSet points, CameraAxes axes) {
  if (axes == CameraAxes::opencv) return points;
  return moved(std::move(points), Pose{transpose(to_axes(axes)), {}});
}

PinholeFit fit(const PointSet& points, const std::optional<Intrinsics>& intrinsics) {
  return intrinsics ? fit_of(points, *intrinsics) : fit_pinhole(points);
}

// Throws if the points fit a camera with other axes than those that are told.
void refuse_other_axes(const PointSet& points, const PointFrame& frame,
                       const std::optional<Intrinsics>& intrinsics, const std::string& name) {
  for (const AxesName& other : kAxesNames) {
    if (other.axes == frame.axes || !fit(in_own_axes(points, other.axes), intrinsics).fits())
      continue;
    refuse(std::string("its points are those of a camera with ") + other.words, name,
           std::string("give `axes` ") + other.name);
  }
}

[[noreturn]] void refuse_fit(const PinholeFit& failed, const PointSet& points,
                             const PointFrame& frame, bool is_given, const std::string& name) {
  if (is_given)
    refuse("its points do not fit the intrinsics given: " + words_of(failed, points), name,
           "leave `intrinsics` out to have them recovered");
  refuse("the organised cloud fits no pinhole camera with x right, y down, z forward: " +
             words_of(failed, points),
         name, cure_of(points, frame.to_world.has_value()));
}

// Returns the view of the camera with these intrinsics, or else of one that is fitted. Points that
// fit only after `to_world` is undone were in the world's frame. Returns nothing if no camera fits
// points that have normals, since these need none. Throws Error(refused), naming other axes that
// fit or the residual, for other points that fit none.
std::optional<OrganisedView> find_view(const PointSet& points, const PointFrame& frame,
                                       const std::optional<Intrinsics>& intrinsics,
                                       const std::string& name) {
  OrganisedView view{in_own_axes(points, frame.axes), {}, false};
  view.fit = fit(view.points, intrinsics);
  if (view.fit.fits()) return view;
  if (frame.to_world) {
    OrganisedView back{
        moved(points, inverse(with_own_axes(*frame.to_world, frame.axes))), {}, true};
    back.fit = fit(back.points, intrinsics);
    if (back.fit.fits()) return back;
  }
  refuse_other_axes(points, frame, intrinsics, name);
  if (!points.normals.empty() && !intrinsics) return std::nullopt;
  if (intrinsics) find_view(points, frame, std::nullopt, name);  // throws where no others fit
  refuse_fit(view.fit, view.points, frame, intrinsics.has_value(), name);
}

struct ScatteredScan {
  Cloud cloud;
  std::size_t invalid = 0;         // points that are not finite
  std::size_t without_normal = 0;  // finite, but not in the cloud
  Remarks remarks;
};

void refuse_missing_normals(const PointSet& points, const std::string& name) {
  if (points.normals.empty()) {
    refuse("points without a grid need normals (normal_x normal_y normal_z, or nx ny nz)", name,
           "estimate them first, or give the depth image");
  }
  if (std::all_of(points.normals.begin(), points.normals.end(),
                  [](const Vec3& n) { return n == Vec3{}; })) {
    refuse("all its normals are zero, as in files of 3D Gaussian splats", name,
           "estimate them first, or give the depth image");
  }
}

// Returns a warning if the numbers that the points were written with, m, are too coarse for their
// spacing.
Remarks coarse_coordinates(const Coarseness& numbers, const Cloud& cloud) {
  constexpr double kMostRounding = 1.0 / 16;  // part of the sampling radius
  const double rounding = 0.5 * numbers.step;
  if (rounding <= kMostRounding * median_radius(cloud)) return {};
  return {{true, std::string("its coordinates are ") + numbers.numbers() + " up to " +
                     metres_text(numbers.farthest) + " from the origin, rounded there by up to " +
                     metres_text(rounding) +
                     ", too much for the points' spacing: the shape is lost; write them " +
                     (numbers.is_decimal ? "with more digits" : "as double") +
                     ", or nearer to the origin"}};
}

// Returns the cloud of points in metres. Throws Error(refused), naming `name`, for points without
// normals.
ScatteredScan scan_of_scattered(const PointSet& points, const Pose& to_world,
                                const std::string& name,
                                const std::optional<Orientation>& orientation) {
  refuse_missing_normals(points, name);
  ScatteredScan scan;
  scan.cloud = cloud_of_scattered_points(points.positions, points.normals, to_world, name);
  scan.invalid =
      static_cast<std::size_t>(std::count_if(points.positions.begin(), points.positions.end(),
                                             [](const Vec3& p) { return !is_finite(p); }));
  scan.without_normal = points.positions.size() - scan.invalid - scan.cloud.size();
  if (scan.without_normal > 0)
    scan.remarks.push_back(
        {false, std::to_string(scan.without_normal) + " points have no normal and are left out"});
  if (orientation)
    scan.remarks.push_back({false, std::to_string(orient(*orientation, scan.cloud)) + " of its " +
                                       std::to_string(scan.cloud.size()) + " normals turned"});
  append(scan.remarks, improbable_normals(scan.cloud, name));
  return scan;
}

bool is_identity(const Pose& pose) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  return pose.translation == Vec3{} && q.x == 0 && q.y == 0 && q.z == 0;
}

// Returns the pose as `camera_pose` takes it, in metres.
std::string text_of(const Pose& pose) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  const Vec3 t = pose.translation;
  char text[256];
  std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g", t.x, t.y, t.z, q.x, q.y,
                q.z, q.w);
  return text;
}

// Pose of the points' frame in the world, from the user or the file.
struct ToldPose {
  std::optional<Pose> pose;  // m
  bool is_viewpoint = false;
  bool is_among_points = false;  // points and viewpoint stand in the world's frame already
};

ToldPose told_pose(const PointSet& points, const ImportOptions& options, double units_per_metre) {
  if (options.to_world) return {options.to_world, false};
  if (!points.viewpoint || is_identity(*points.viewpoint)) return {};
  Pose pose = *points.viewpoint;
  pose.translation = pose.translation / units_per_metre;
  return {pose, true};
}

bool has_any_point(const PointSet& points) {
  return std::any_of(points.positions.begin(), points.positions.end(),
                     [](const Vec3& p) { return is_finite(p) && p != Vec3{}; });
}

RawDepth depth_of(const PointSet& points) {
  RawDepth raw;
  raw.width = points.width;
  raw.height = points.height;
  raw.values.reserve(points.positions.size());
  for (const Vec3& p : points.positions)
    raw.values.push_back(is_finite(p) ? static_cast<float>(p.z) : 0.0F);
  return raw;
}

ImportedScan scan_of_view(const OrganisedView& view, const ToldPose& told, const std::string& name,
                          const ImportOptions& options) {
  const Pose to_world = told.pose ? with_own_axes(*told.pose, options.axes) : Pose{};
  DepthReading reading = options.depth;
  reading.along_ray = false;
  reading.units_per_metre = options.depth.units_per_metre.value_or(1);
  ImportedScan scan =
      scan_of_depth(depth_of(view.points), view.fit.intrinsics, to_world, name, reading);
  scan.intrinsics_recovered = !options.intrinsics;
  if (view.were_in_world) {
    scan.remarks.push_back(
        {false, std::string("its points are in the world's frame: they fit a camera at ") +
                    (told.is_viewpoint ? "its VIEWPOINT" : "`camera_pose`")});
  }
  return scan;
}

ImportedScan scan_without_camera(PointSet points, const ToldPose& told, const std::string& name,
                                 const ImportOptions& options, double units_per_metre) {
  const Pose to_world = told.pose ? with_own_axes(*told.pose, options.axes) : Pose{};
  std::optional<Coarseness> numbers = coarseness_of(points.positions, 0);
  points = in_own_axes(std::move(points), options.axes);
  for (Vec3& p : points.positions) p = p / units_per_metre;
  if (options.flip)
    for (Vec3& n : points.normals) n = -n;
  ScatteredScan read = scan_of_scattered(points, to_world, name, options.orient);
  if (numbers) {
    numbers->farthest /= units_per_metre;
    numbers->step /= units_per_metre;
    append(read.remarks, coarse_coordinates(*numbers, read.cloud));
  }
  // A file with a viewpoint has its sensor at the origin of its frame, which normals must face.
  if (!told.is_among_points && !options.orient)
    append(read.remarks, facing_away(points, options.flip));
  ImportedScan scan;
  scan.width = points.width;
  scan.height = points.height;
  scan.invalid = read.invalid;
  scan.without_normal = read.without_normal;
  scan.points = std::move(read.cloud);
  scan.remarks = std::move(read.remarks);
  return scan;
}

// Returns warnings about options that only images use.
Remarks unused_options(const ImportOptions& options) {
  Remarks remarks;
  const DepthReading& depth = options.depth;
  const auto say = [&](bool is_given, const char* option) {
    if (is_given)
      remarks.push_back({true, "`" + std::string(option) +
                                   "` is not used: it holds points with normals, not an image"});
  };
  say(options.intrinsics.has_value(), "intrinsics");
  say(!depth.invalid.empty() || !depth.has_usual_markers, "invalid");
  say(depth.nearest > 0 || depth.farthest < HUGE_VAL, "range");
  say(depth.along_ray, "along_ray");
  const DepthDecoding& coding = depth.decoding;
  say(coding.swapped || coding.big_endian || coding.rotated || coding.disparity, "decode");
  return remarks;
}

}  // namespace

ImportedScan scan_of_points(PointSet points, const std::string& name,
                            const ImportOptions& options) {
  const double units_per_metre = options.depth.units_per_metre.value_or(1);
  ToldPose told = told_pose(points, options, units_per_metre);
  Remarks remarks = std::move(points.remarks);
  std::optional<OrganisedView> view;
  if (points.organised()) {
    if (!has_any_point(points)) throw NothingMeasured("no pixel holds a measurement", name);
    PointFrame frame{options.axes, told.pose};
    if (frame.to_world) frame.to_world->translation = units_per_metre * told.pose->translation;
    view = find_view(points, frame, options.intrinsics, name);
  }
  if (!view && told.is_viewpoint && are_in_world(points, options.flip)) {
    remarks.push_back({false,
                       "its points are in the world's frame, since their normals face its "
                       "VIEWPOINT there; `camera_pose` " +
                           text_of(*told.pose) + " takes them from the sensor's frame"});
    told = {std::nullopt, true, true};
  } else if (told.is_viewpoint) {
    remarks.push_back(
        {false, "its VIEWPOINT is taken for the pose of its points' frame in the world, " +
                    text_of(*told.pose) +
                    "; `camera_pose` 0,0,0,0,0,0,1 leaves the points where they are"});
  }
  if (!view && points.organised())
    remarks.push_back({false,
                       "its grid fits no pinhole camera: its points are read with their normals, "
                       "as of no camera"});
  ImportedScan scan =
      view ? scan_of_view(*view, told, name, options)
           : scan_without_camera(std::move(points), told, name, options, units_per_metre);
  if (!view) append(remarks, unused_options(options));
  if (view && options.depth.along_ray)
    remarks.push_back({true, "`along_ray` is not used: points tell their depth themselves"});
  scan.remarks.insert(scan.remarks.begin(), remarks.begin(), remarks.end());
  return scan;
}

}  // namespace vpm
