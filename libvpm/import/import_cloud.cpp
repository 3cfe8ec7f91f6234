#include "libvpm/import/import_cloud.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/sniff.h"
#include "libvpm/file/text.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/point_files.h"
#include "libvpm/import/point_scan.h"

namespace vpm {
namespace {

using file::ScanFormat;

// Throws Error(refused), naming `name` and what the file seems to be, if it is none of these.
ScanFormat format_of(std::span<const std::byte> bytes, const std::string& name) {
  if (bytes.empty()) refuse("the file is empty", name, "give a depth image or a cloud");
  const auto content = file::sniff(bytes);
  if (content && content->scan) return *content->scan;
  if (content)
    refuse("this is " + content->what, name,
           content->holds == file::Holds::mesh
               ? "give a depth image or a cloud, or the mesh to vpm-pack"
               : content->next);
  if (file::is_table_of_numbers(file::as_text(bytes)))
    refuse("this is a table of numbers in text", name,
           "save points as PLY or PCD, with their normals, and a depth image as NPY, PFM, TIFF or "
           "16-bit PNG");
  refuse("neither PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD nor PLY by its content", name,
         "give a depth image or a cloud");
}

std::size_t count_invalid(const DepthImage& depth) {
  return static_cast<std::size_t>(std::count_if(depth.depth.begin(), depth.depth.end(),
                                                [](float d) { return !is_measured(d); }));
}

RawDepth parse_depth(ScanFormat format, std::span<const std::byte> bytes, const std::string& name,
                     const ImportOptions& options) {
  switch (format) {
    case ScanFormat::exr:
      return parse_exr_depth(bytes, name, options.channel);
    case ScanFormat::tiff:
      return parse_tiff_depth(bytes, name);
    case ScanFormat::netpbm:
      return parse_netpbm_depth(bytes, name);
    case ScanFormat::npy:
      return parse_npy_depth(bytes, name);
    case ScanFormat::compressed_depth:
      return parse_compressed_depth(bytes, name);
    default:
      return parse_png_depth(bytes, name);
  }
}

// Throws Error(refused), telling the intrinsics scaled to this image, if the calibration is of
// another size.
void check_calibrated_size(const RawDepth& image, const ImportOptions& options,
                           const std::string& name) {
  const double width = options.calibrated_width, height = options.calibrated_height;
  if (width == 0 || height == 0 || (width == image.width && height == image.height)) return;
  const Intrinsics& k = *options.intrinsics;
  const double across = image.width / width, down = image.height / height;
  constexpr double kSameShape = 0.01;
  const Intrinsics scaled{across * k.fx, down * k.fy, across * (k.cx + 0.5) - 0.5,
                          down * (k.cy + 0.5) - 0.5};
  const std::optional<ImageRegion>& region = options.calibrated_region;
  std::string cure = "give the intrinsics of this image: it is of another shape, and so was cut";
  if (region && region->width == image.width && region->height == image.height)
    cure =
        "it has the size of the region of interest in that file; if it is that, give "
        "`intrinsics` " +
        intrinsics_text({k.fx, k.fy, k.cx - region->left, k.cy - region->top});
  else if (std::abs(across / down - 1) < kSameShape)
    cure = "if it was scaled to that, give `intrinsics` " + intrinsics_text(scaled);
  refuse("the intrinsics are of an image of " + std::to_string(options.calibrated_width) + " x " +
             std::to_string(options.calibrated_height) + " pixels; this one has " +
             std::to_string(image.width) + " x " + std::to_string(image.height),
         name, cure);
}

ImportedScan scan_of_image(const RawDepth& raw, const std::string& name,
                           const ImportOptions& options) {
  if (!options.intrinsics) {
    throw Error(ErrorKind::invalid_argument,
                "a depth image needs `intrinsics`: fx,fy,cx,cy in pixels, or a file with them",
                name);
  }
  check_calibrated_size(raw, options, name);
  const Pose to_world = options.to_world ? with_own_axes(*options.to_world, options.axes) : Pose{};
  ImportedScan scan = scan_of_depth(raw, *options.intrinsics, to_world, name, options.depth);
  if (options.axes != CameraAxes::opencv && !options.to_world)
    scan.remarks.push_back({true,
                            "`axes` is not used: without `camera_pose` the world has the axes of "
                            "the camera, x right, y down, z forward; `camera_pose` 0,0,0,0,0,0,1 "
                            "gives it the others"});
  return scan;
}

}  // namespace

namespace {

// Returns why no value of an image counts as a depth.
std::string why_nothing(const RawDepth& raw, const Intrinsics& k, const DepthReading& reading,
                        const std::string& name) {
  DepthReading everything = reading;
  everything.nearest = 0;
  everything.farthest = HUGE_VAL;
  Remarks unsaid;
  const DepthImage depth = depth_in_metres_of(raw, k, everything, name, unsaid);
  if (const auto range = range_of(depth))
    return "its depths are from " + metres_text(range->nearest) + " to " +
           metres_text(range->farthest) + ", all outside of `range`, which is in metres";
  const auto count = [&](auto is_so) {
    return std::count_if(raw.values.begin(), raw.values.end(), is_so);
  };
  const auto all = static_cast<std::ptrdiff_t>(raw.values.size());
  if (count([](float v) { return v == 0; }) == all) return "all are 0";
  if (count([](float v) { return std::isnan(v); }) == all) return "none is a number";
  if (count([](float v) { return v > 0 && v < HUGE_VALF; }) == 0 &&
      count([](float v) { return v < 0; }) > 0)
    return "all are negative, or 0; a camera that looks along -z writes such: change the sign";
  if (count([](float v) { return v > 0 && v < HUGE_VALF; }) == 0)
    return "all are 0, infinite, negative or not a number";
  return "its values mean \"not measured\", or depths that no camera measures; `invalid`, `decode` "
         "and `depth_scale` tell what they mean";
}

// Takes out what the options do; of points there is nothing to be taken.
void remove_solids(ImportedScan& scan, const std::string& name, const ImportOptions& options) {
  if (!options.remove) return;
  if (!scan.image)
    refuse("points without a camera: `remove` takes pixels out of depth images", name,
           "give the depth image");
  scan.removed = options.remove(*scan.image, options.time);
}

}  // namespace

ImportedScan scan_of_depth(const RawDepth& raw, const Intrinsics& k, const Pose& to_world,
                           const std::string& name, const DepthReading& reading) {
  ImportedScan scan;
  DepthImage depth = depth_in_metres_of(raw, k, reading, name, scan.remarks, &scan.looks_coded);
  scan.width = depth.width;
  scan.height = depth.height;
  scan.invalid = count_invalid(depth);
  if (scan.invalid == depth.depth.size())
    throw NothingMeasured("no pixel holds a measurement: " + why_nothing(raw, k, reading, name),
                          name);
  const Camera camera{k, depth.width, depth.height, to_world};
  scan.image = CloudSensor{camera, std::move(depth)};
  return scan;
}

ImportedScan import_scan(std::span<const std::byte> bytes, const std::string& name,
                         const ImportOptions& options) {
  const ScanFormat format = format_of(bytes, name);
  const bool holds_points = format == ScanFormat::pcd || format == ScanFormat::ply;
  ImportedScan scan =
      holds_points ? scan_of_points(format == ScanFormat::pcd ? parse_pcd(bytes, name)
                                                              : parse_ply_points(bytes, name),
                                    name, options)
                   // The image comes first: a file that is none must not be refused for want of
                   // intrinsics.
                   : scan_of_image(parse_depth(format, bytes, name, options), name, options);
  if (!options.channel.empty() && format != ScanFormat::exr)
    scan.remarks.push_back({true, "`channel` is not used: it is no OpenEXR image"});
  remove_solids(scan, name, options);
  return scan;
}

NothingMeasured nothing_with_normal(const ImportedScan& scan, const std::string& name) {
  const std::size_t measured = scan.image->depth.depth.size() - scan.invalid - scan.removed;
  if (measured == 0)
    return NothingMeasured(
        "all of its " + std::to_string(scan.removed) + " measured pixels are removed with solids",
        name);
  return NothingMeasured("none of its " + std::to_string(measured) +
                             " measured pixels has neighbours enough for a normal",
                         name);
}

namespace {

// Returns the cloud of a scan, with its facts and what is to be said of it.
ImportedCloud cloud_of(ImportedScan scan, const std::string& name, const ImportOptions& options) {
  ImportedCloud imported;
  imported.width = scan.width;
  imported.height = scan.height;
  imported.invalid = scan.invalid;
  imported.removed = scan.removed;
  imported.intrinsics_recovered = scan.intrinsics_recovered;
  imported.normals_estimated = scan.image.has_value();
  if (scan.image) {
    const auto& [camera, depth] = *scan.image;
    imported.cloud = make_cloud(depth, camera, options.normals);
    if (imported.cloud.size() == 0) throw nothing_with_normal(scan, name);
    imported.without_normal =
        depth.depth.size() - scan.invalid - scan.removed - imported.cloud.size();
    append(imported.remarks, improbable_intrinsics(camera));
  } else {
    imported.cloud = std::move(scan.points);
    imported.without_normal = scan.without_normal;
  }
  append(imported.remarks, scan.remarks);
  imported.facts =
      facts_of(imported.cloud, imported.invalid, std::size_t{imported.width} * imported.height);
  if (!scan.looks_coded)  // of several causes one is said
    append(imported.remarks, improbable_depths(imported.facts, options.depth.units_per_metre));
  for (const auto& [is_given, option] :
       {std::pair(options.flip, "flip"), std::pair(options.orient.has_value(), "orient")})
    if (is_given && scan.image)
      imported.remarks.push_back({true, "`" + std::string(option) +
                                            "` is not used: normals estimated from depth face the "
                                            "camera"});
  return imported;
}

}  // namespace

ImportedCloud import_cloud(std::span<const std::byte> bytes, const std::string& name,
                           const ImportOptions& options) {
  return cloud_of(import_scan(bytes, name, options), name, options);
}

ImportedCloud import_depth(const RawDepth& raw, const std::string& name,
                           const ImportOptions& options) {
  check_image_size(raw.width, raw.height, name);
  return cloud_of(scan_of_image(raw, name, options), name, options);
}

}  // namespace vpm
