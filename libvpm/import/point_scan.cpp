#include "libvpm/import/point_scan.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/import/organised_points.h"
#include "libvpm/import/scattered_scan.h"

namespace vpm {
namespace {

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

// Pose of the points' frame that the user or the file tells.
struct ToldPose {
  std::optional<Pose> pose;  // m
  bool is_viewpoint = false;
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
  points = in_own_axes(std::move(points), options.axes);
  for (Vec3& p : points.positions) p = p / units_per_metre;
  if (options.flip)
    for (Vec3& n : points.normals) n = -n;
  ScatteredScan read = scan_of_scattered(points, to_world, name);
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
  return remarks;
}

}  // namespace

ImportedScan scan_of_points(PointSet points, const std::string& name,
                            const ImportOptions& options) {
  const double units_per_metre = options.depth.units_per_metre.value_or(1);
  const ToldPose told = told_pose(points, options, units_per_metre);
  Remarks remarks;
  if (told.is_viewpoint) {
    remarks.push_back(
        {false, "its VIEWPOINT is taken for the pose of its points' frame in the world, " +
                    text_of(*told.pose) +
                    "; `camera_pose` 0,0,0,0,0,0,1 leaves the points where they are"});
  }
  std::optional<OrganisedView> view;
  if (points.organised()) {
    if (!has_any_point(points)) throw NothingMeasured("no pixel holds a measurement", name);
    PointFrame frame{options.axes, told.pose};
    if (frame.to_world) frame.to_world->translation = units_per_metre * told.pose->translation;
    view = find_view(points, frame, options.intrinsics, name);
    if (!view)
      remarks.push_back({false,
                         "its grid fits no pinhole camera: its points are read with their normals, "
                         "as of no camera"});
  }
  ImportedScan scan =
      view ? scan_of_view(*view, told, name, options)
           : scan_without_camera(std::move(points), told, name, options, units_per_metre);
  if (!view) append(remarks, unused_options(options));
  scan.remarks.insert(scan.remarks.begin(), remarks.begin(), remarks.end());
  return scan;
}

}  // namespace vpm
