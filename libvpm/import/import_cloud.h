// A cloud of whatever a sensor left behind, told by its content: 16-bit PNG, OpenEXR, PCD, PLY.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "libvpm/cloud/cloud.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/device/device.h"

namespace vpm {

struct ImportOptions {
  std::optional<Intrinsics> intrinsics;   // an organised PCD tells its own where this is not given
  std::optional<double> units_per_metre;  // otherwise 1000 for PNG, 1 for the rest
  std::optional<Pose> to_world;           // otherwise a PCD's VIEWPOINT, or identity
  NormalOptions normals;
  Device device;  // where normals are computed; changes none
};

inline constexpr double kPngUnitsPerMetre = 1000;

struct ImportedCloud {
  Cloud cloud;
  std::uint32_t width = 0, height = 0;  // of the image; of a list of points, its number and 1
  std::size_t invalid = 0;              // pixels or points without measurement
  std::size_t without_normal = 0;       // measured, but not in the cloud
  bool intrinsics_recovered = false;
  bool normals_estimated = false;  // false: taken from the file
};

// A sound depth image in which nothing was seen.
class NothingMeasured : public Error {
 public:
  explicit NothingMeasured(const std::string& message) : Error(ErrorKind::refused, message) {}
};

// What a file holds before normals are estimated: a depth image with its camera, or points.
struct ImportedScan {
  std::optional<CloudSensor> image;
  Cloud points;  // where there is no image
  std::uint32_t width = 0, height = 0;
  std::size_t invalid = 0;
  std::size_t without_normal = 0;  // of the points
  bool intrinsics_recovered = false;
};

// The first half of import_cloud(), for those who make something else of an image.
ImportedScan import_scan(std::span<const std::byte> bytes, const std::string& name,
                         const ImportOptions& options);
// To be thrown where an image gives no point.
NothingMeasured nothing_with_normal(const ImportedScan& scan, const std::string& name);

// Depth images and organised PCD become clouds with a sensor, their normals estimated from the
// depth whatever the file holds. Other PCD and PLY need normals, which must point into free space.
// Throws Error: refused for what is damaged, unknown, without normals or without any point (of
// depth: NothingMeasured); usage for depth images without intrinsics; unavailable for OpenEXR in a
// build without it.
ImportedCloud import_cloud(std::span<const std::byte> bytes, const std::string& name,
                           const ImportOptions& options);

}  // namespace vpm
