#include <vpm/import.h>
#include <vpm/version.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/import_cloud.h"

namespace vpm {
namespace {

void check(bool is_good, const std::string& what) {
  if (!is_good) throw Error(ErrorKind::invalid_argument, what);
}

DepthReading reading_of(const ImportParameters& parameters) {
  DepthReading reading;
  const std::optional<double>& scale = parameters.depth_scale;
  check(!scale || (*scale > 0 && std::isfinite(*scale)),
        "`depth_scale` must be finite and greater than 0");
  const auto& [nearest, farthest] = parameters.range;
  check(nearest >= 0 && farthest > nearest, "`range` must go from 0 m or more to a farther depth");
  reading.units_per_metre = scale;
  if (!parameters.decode.empty()) reading.decoding = decoding_from_text(parameters.decode);
  reading.invalid = parameters.invalid;
  reading.has_usual_markers = parameters.usual_invalid;
  reading.nearest = nearest;
  reading.farthest = farthest;
  reading.along_ray = parameters.along_ray;
  return reading;
}

ImportOptions options_of(const ImportParameters& parameters) {
  check_normal_options(parameters.normals);
  if (parameters.intrinsics) check_intrinsics(*parameters.intrinsics);
  ImportOptions options;
  options.intrinsics = parameters.intrinsics;
  options.depth = reading_of(parameters);
  options.channel = parameters.channel;
  options.axes = parameters.axes;
  options.to_world = parameters.camera_pose;
  options.flip = parameters.flip;
  if (!parameters.orient.empty()) options.orient = orientation_from_text(parameters.orient);
  options.normals = parameters.normals;
  return options;
}

// Tells what vpm-normals tells too, by which SetupCheck knows how the points came to their place.
nlohmann::json provenance_of(const ImportParameters& parameters, const char* function) {
  nlohmann::json told{{"axes", name_of(parameters.axes)}};
  if (parameters.camera_pose) {
    const Vec3 t = parameters.camera_pose->translation;
    const Quaternion q = quaternion_from_rotation(parameters.camera_pose->rotation);
    told["camera-pose"] = {t.x, t.y, t.z, q.x, q.y, q.z, q.w};
  }
  return {{"tool", function}, {"version", VPM_VERSION}, {"parameters", told}};
}

// Returns the handle of a cloud that `function` has imported, and hands on what is said of it.
PointCloud handle_of(ImportedCloud imported, const ImportParameters& parameters,
                     const char* function, Remarks* remarks) {
  imported.cloud.provenance = provenance_of(parameters, function);
  if (remarks != nullptr) append(*remarks, imported.remarks);
  return HandleAccess::make<PointCloud>(std::move(imported.cloud));
}

template <class Value>
PointCloud cloud_of_image(std::span<const Value> values, std::uint32_t width, std::uint32_t height,
                          const ImportParameters& parameters, Remarks* remarks) {
  constexpr bool kCounts = std::is_same_v<Value, std::uint16_t>;
  const ImportOptions options = options_of(parameters);
  check(values.size() == std::uint64_t{width} * height,
        std::to_string(width) + " x " + std::to_string(height) + " pixels, but " +
            std::to_string(values.size()) + " values");
  RawDepth raw;
  raw.width = width;
  raw.height = height;
  raw.values.assign(values.begin(), values.end());
  raw.are_integers = raw.are_16_bit = kCounts;
  return handle_of(import_depth(raw, "the depth image", options), parameters, "vpm::import_depth",
                   remarks);
}

}  // namespace

PointCloud import_cloud(const std::string& path, const ImportParameters& parameters,
                        Remarks* remarks) {
  const ImportOptions options = options_of(parameters);
  const std::string name = path == "-" ? "standard input" : path;
  return handle_of(import_cloud(file::read_all(path), name, options), parameters,
                   "vpm::import_cloud", remarks);
}

PointCloud import_depth(std::span<const std::uint16_t> values, std::uint32_t width,
                        std::uint32_t height, const ImportParameters& parameters,
                        Remarks* remarks) {
  return cloud_of_image(values, width, height, parameters, remarks);
}

PointCloud import_depth(std::span<const float> values, std::uint32_t width, std::uint32_t height,
                        const ImportParameters& parameters, Remarks* remarks) {
  return cloud_of_image(values, width, height, parameters, remarks);
}

}  // namespace vpm
