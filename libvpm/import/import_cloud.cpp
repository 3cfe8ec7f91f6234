#include "libvpm/import/import_cloud.h"

#include <algorithm>
#include <string_view>

#include "libvpm/cloud/scattered_points.h"
#include "libvpm/core/error.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/file_text.h"
#include "libvpm/import/pcd.h"
#include "libvpm/import/pinhole_fit.h"
#include "libvpm/import/ply_points.h"

namespace vpm {
namespace {

using std::string_view_literals::operator""sv;

enum class Format { png, exr, pcd, ply, unknown };

Format format_of(std::string_view text) {
  if (text.starts_with("\x89PNG\r\n\x1a\n"sv)) return Format::png;
  if (text.starts_with("\x76\x2f\x31\x01"sv)) return Format::exr;
  if (text.starts_with("ply\n"sv) || text.starts_with("ply\r"sv)) return Format::ply;
  for (const std::string_view start : {"# .PCD"sv, "VERSION"sv, "FIELDS"sv, "#"sv}) {
    if (text.starts_with(start)) return Format::pcd;
  }
  return Format::unknown;
}

std::size_t count_invalid(const DepthImage& depth) {
  return static_cast<std::size_t>(std::count_if(depth.depth.begin(), depth.depth.end(),
                                                [](float d) { return !is_measured(d); }));
}

ImportedScan scan_of_depth(DepthImage depth, const Intrinsics& k, const Pose& to_world,
                           const std::string& name) {
  ImportedScan scan;
  scan.width = depth.width;
  scan.height = depth.height;
  scan.invalid = count_invalid(depth);
  if (scan.invalid == depth.depth.size())
    throw NothingMeasured("no pixel holds a measurement", name);
  const Camera camera{k, depth.width, depth.height, to_world};
  scan.image = CloudSensor{camera, std::move(depth)};
  return scan;
}

ImportedScan scan_of_points(PointSet points, const std::string& name,
                            const ImportOptions& options) {
  const double scale = options.units_per_metre.value_or(1);
  Pose to_world = options.to_world.value_or(points.viewpoint);
  if (!options.to_world) to_world.translation = to_world.translation / scale;
  if (points.organised()) {
    if (options.intrinsics) check_pinhole(points, *options.intrinsics, name);
    const Intrinsics k = options.intrinsics ? *options.intrinsics : fit_pinhole(points, name);
    ImportedScan scan = scan_of_depth(depth_of(points, scale), k, to_world, name);
    scan.intrinsics_recovered = !options.intrinsics;
    return scan;
  }
  if (points.normals.empty()) {
    refuse("points without a grid need normals (PCD: normal_x normal_y normal_z; PLY: nx ny nz)",
           name, "estimate them first, or give the depth image");
  }
  for (Vec3& p : points.positions) p = p / scale;
  ImportedScan scan;
  scan.width = points.width;
  scan.height = points.height;
  scan.points = cloud_of_scattered_points(points.positions, points.normals, to_world, name);
  scan.invalid =
      static_cast<std::size_t>(std::count_if(points.positions.begin(), points.positions.end(),
                                             [](const Vec3& p) { return !is_finite(p); }));
  scan.without_normal = points.positions.size() - scan.invalid - scan.points.size();
  return scan;
}

}  // namespace

ImportedScan import_scan(std::span<const std::byte> bytes, const std::string& name,
                         const ImportOptions& options) {
  const Format format = format_of(as_text(bytes));
  if (format == Format::pcd) return scan_of_points(parse_pcd(bytes, name), name, options);
  if (format == Format::ply) return scan_of_points(parse_ply_points(bytes, name), name, options);
  if (format == Format::unknown) {
    refuse(bytes.empty() ? "the file is empty" : "neither PNG, OpenEXR, PCD nor PLY by its content",
           name, "give a depth image or a cloud");
  }
  if (!options.intrinsics) {
    throw Error(ErrorKind::invalid_argument,
                "a depth image needs `intrinsics` fx,fy,cx,cy (pixels)", name);
  }
  DepthImage depth =
      format == Format::png
          ? parse_png_depth(bytes, name, options.units_per_metre.value_or(kPngUnitsPerMetre))
          : parse_exr_depth(bytes, name, options.units_per_metre.value_or(1));
  return scan_of_depth(std::move(depth), *options.intrinsics, options.to_world.value_or(Pose{}),
                       name);
}

NothingMeasured nothing_with_normal(const ImportedScan& scan, const std::string& name) {
  const std::size_t measured = scan.image->depth.depth.size() - scan.invalid;
  return NothingMeasured("none of its " + std::to_string(measured) +
                             " measured pixels has neighbours enough for a normal",
                         name);
}

ImportedCloud import_cloud(std::span<const std::byte> bytes, const std::string& name,
                           const ImportOptions& options) {
  ImportedScan scan = import_scan(bytes, name, options);
  ImportedCloud imported;
  imported.width = scan.width;
  imported.height = scan.height;
  imported.invalid = scan.invalid;
  imported.intrinsics_recovered = scan.intrinsics_recovered;
  imported.normals_estimated = scan.image.has_value();
  if (!scan.image) {
    imported.cloud = std::move(scan.points);
    imported.without_normal = scan.without_normal;
    return imported;
  }
  const auto& [camera, depth] = *scan.image;
  imported.cloud = make_cloud(depth, camera, options.normals);
  if (imported.cloud.size() == 0) throw nothing_with_normal(scan, name);
  imported.without_normal = depth.depth.size() - scan.invalid - imported.cloud.size();
  return imported;
}

}  // namespace vpm
