// Imports clouds from files of sensors and programs, recognised by content: depth images as PNG,
// OpenEXR, TIFF, PGM, PFM and NPY, points as PCD and PLY.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "libvpm/cloud/camera_axes.h"
#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/orientation.h"
#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/depth_values.h"
#include "libvpm/import/intrinsics_file.h"
#include "libvpm/import/remark.h"
#include "libvpm/import/scan_facts.h"

namespace vpm {

struct ImportOptions {
  // Camera of the image or grid. If unset, that of an organised PCD is fitted to its points.
  std::optional<Intrinsics> intrinsics;
  std::uint32_t calibrated_width = 0,
                calibrated_height = 0;  // image of the intrinsics, px; 0 if it is not known
  std::optional<ImageRegion> calibrated_region;  // part of it that a driver cuts out
  DepthReading depth;                            // its unit holds for points too
  std::string channel;  // depth channel of an OpenEXR image; if empty, its name tells
  // Axes of the frame that `to_world` maps to the world, and of points.
  CameraAxes axes = CameraAxes::opencv;
  std::optional<Pose> to_world;  // if unset, a PCD's VIEWPOINT, or identity for this library's axes
  bool flip = false;             // turns the normals of points that have some and no camera
  // Turns those of them that face away from a place, world coordinates, or that disagree with their
  // neighbours, after `flip`.
  std::optional<Orientation> orient;
  NormalOptions normals;
  // Takes known solids out of the depth image that a camera took at `time`, s, and returns the
  // number of pixels. Points without a camera are refused then.
  std::function<std::size_t(CloudSensor& image, double time)> remove;
  double time = 0;
};

struct ImportedCloud {
  Cloud cloud;
  // Size of the image, or number of points and 1.
  std::uint32_t width = 0, height = 0;
  std::size_t invalid = 0;         // pixels or points without measurement
  std::size_t removed = 0;         // measured pixels that ImportOptions::remove took out
  std::size_t without_normal = 0;  // measured, but not in the cloud
  bool intrinsics_recovered = false;
  bool normals_estimated = false;  // false: taken from the file
  ScanFacts facts;
  Remarks remarks;
};

// Refusal of a valid depth image in which nothing was measured.
class NothingMeasured : public Error {
 public:
  NothingMeasured(const std::string& what, const std::string& name)
      : Error(ErrorKind::refused, what, name) {}
};

// Content of a file before normals are estimated: a depth image with its camera, or points.
struct ImportedScan {
  std::optional<CloudSensor> image;
  Cloud points;  // set if there is no image
  std::uint32_t width = 0, height = 0;
  std::size_t invalid = 0, removed = 0;
  std::size_t without_normal = 0;  // counts points
  bool intrinsics_recovered = false;
  bool looks_coded = false;  // values look coded, as remarks tell, so that depths may be others
  Remarks remarks;
};

// Reads the scan only, for callers that process images themselves; throws as import_cloud does.
ImportedScan import_scan(std::span<const std::byte> bytes, const std::string& name,
                         const ImportOptions& options);
// Returns the error to throw if an image gives no point.
NothingMeasured nothing_with_normal(const ImportedScan& scan, const std::string& name);

// Returns the cloud of a file. Depth images and organised PCD become clouds with a sensor, with
// normals estimated from depth whatever the file holds. Other PCD and PLY must have normals,
// pointing into free space, as must grids that fit no pinhole camera. Throws Error(refused) for
// files that are damaged, unknown, without normals or without any point (for depth:
// NothingMeasured), Error(invalid_argument) for depth images without intrinsics, Error(unavailable)
// for formats that this build lacks.
ImportedCloud import_cloud(std::span<const std::byte> bytes, const std::string& name,
                           const ImportOptions& options);

// Returns the cloud of a depth image that is in memory already. Estimates normals, says what is
// doubtful, and throws as import_cloud does for a file that holds the same values.
ImportedCloud import_depth(const RawDepth& raw, const std::string& name,
                           const ImportOptions& options);

}  // namespace vpm
