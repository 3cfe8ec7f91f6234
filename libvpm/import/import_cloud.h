// Imports clouds from files of sensors, recognised by content: 16-bit PNG, OpenEXR, PCD, PLY.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"

namespace vpm {

struct ImportOptions {
  // If unset, an organised PCD gets its own by a fit.
  std::optional<Intrinsics> intrinsics;
  std::optional<double> units_per_metre;  // if unset, 1000 for PNG and 1 for others
  std::optional<Pose> to_world;           // if unset, a PCD's VIEWPOINT, or identity
  NormalOptions normals;
};

inline constexpr double kPngUnitsPerMetre = 1000;

struct ImportedCloud {
  Cloud cloud;
  // Size of the image, or number of points and 1.
  std::uint32_t width = 0, height = 0;
  std::size_t invalid = 0;         // pixels or points without measurement
  std::size_t without_normal = 0;  // measured, but not in the cloud
  bool intrinsics_recovered = false;
  bool normals_estimated = false;  // false: taken from the file
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
  std::size_t invalid = 0;
  std::size_t without_normal = 0;  // counts points
  bool intrinsics_recovered = false;
};

// Reads the scan only, for callers that process images themselves; throws as import_cloud does.
ImportedScan import_scan(std::span<const std::byte> bytes, const std::string& name,
                         const ImportOptions& options);
// Returns the error to throw if an image gives no point.
NothingMeasured nothing_with_normal(const ImportedScan& scan, const std::string& name);

// Returns the cloud of a file. Depth images and organised PCD become clouds with a sensor, with
// normals estimated from depth whatever the file holds. Other PCD and PLY must have normals,
// pointing into free space. Throws Error(refused) for files that are damaged, unknown, without
// normals or without any point (for depth: NothingMeasured), Error(invalid_argument) for depth
// images without intrinsics, Error(unavailable) for OpenEXR in builds without it.
ImportedCloud import_cloud(std::span<const std::byte> bytes, const std::string& name,
                           const ImportOptions& options);

}  // namespace vpm
