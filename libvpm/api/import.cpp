#include <vpm/import.h>
#include <vpm/version.h>

#include <cmath>
#include <nlohmann/json.hpp>

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
  options.normals = parameters.normals;
  return options;
}

// Tells what vpm-normals tells too, by which SetupCheck knows how the points came to their place.
nlohmann::json provenance_of(const ImportParameters& parameters) {
  nlohmann::json told{{"axes", name_of(parameters.axes)}};
  if (parameters.camera_pose) {
    const Vec3 t = parameters.camera_pose->translation;
    const Quaternion q = quaternion_from_rotation(parameters.camera_pose->rotation);
    told["camera-pose"] = {t.x, t.y, t.z, q.x, q.y, q.z, q.w};
  }
  return {{"tool", "vpm::import_cloud"}, {"version", VPM_VERSION}, {"parameters", told}};
}

}  // namespace

PointCloud import_cloud(const std::string& path, const ImportParameters& parameters,
                        Remarks* remarks) {
  const ImportOptions options = options_of(parameters);
  const std::string name = path == "-" ? "standard input" : path;
  ImportedCloud imported = import_cloud(file::read_all(path), name, options);
  imported.cloud.provenance = provenance_of(parameters);
  if (remarks != nullptr) append(*remarks, imported.remarks);
  return HandleAccess::make<PointCloud>(std::move(imported.cloud));
}

}  // namespace vpm
