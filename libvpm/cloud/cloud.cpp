#include "libvpm/cloud/cloud.h"

#include <cmath>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/file/container.h"

namespace vpm {
namespace {

// Tolerance for normals stored as floats; those further from unit length were not normalised.
constexpr double kNormalTolerance = 1e-3;

constexpr file::ChunkId kOrigin("ORIG"), kPositions("POSN"), kNormals("NRML"), kRadii("RADI");
constexpr file::ChunkId kPixels("PIXL"), kCamera("CAMR"), kDepth("DPTH");

// Deviation up to which a camera's rotation is exact but for decimal rounding in the writer.
constexpr double kWrittenRotation = 1e-9;

struct CameraRecord {
  Intrinsics intrinsics;
  Pose to_world;  // three rows of the rotation, then the translation
  std::uint32_t width, height;
};
static_assert(sizeof(CameraRecord) == 136 && sizeof(Vec3) == 24 && sizeof(Vec3f) == 12,
              "chunks hold these types as they lie in memory");

template <class T>
T read_one(const file::Reader& reader, file::ChunkId id) {
  const std::vector<T> values = reader.read<T>(id, 0);
  if (values.size() != 1)
    reader.refuse_file("chunk " + std::string(id.name, sizeof(id.name)) +
                       " must hold one record; make the file again");
  return values[0];
}

CloudSensor read_sensor(const file::Reader& reader) {
  const CameraRecord record = read_one<CameraRecord>(reader, kCamera);
  CloudSensor sensor{{record.intrinsics, record.width, record.height, record.to_world},
                     {record.width, record.height, reader.read<float>(kDepth, 0)}};
  Rotation& rotation = sensor.camera.to_world.rotation;
  if (is_rotation(rotation, kWrittenRotation)) rotation = exact_rotation(rotation);
  for (const float depth : sensor.depth.depth) {
    if (depth != 0 && !is_measured(depth))
      reader.refuse_file("the depth image holds values that are negative or not finite");
  }
  return sensor;
}

Cloud cloud_of(const file::Reader& reader) {
  Cloud cloud;
  cloud.origin = read_one<Vec3>(reader, kOrigin);
  cloud.positions = reader.read<Vec3f>(kPositions, 0);
  cloud.normals = reader.read<Vec3f>(kNormals, 0);
  cloud.radii = reader.read<float>(kRadii, 0);
  if (reader.has(kCamera, 0)) {
    cloud.sensor = read_sensor(reader);
    cloud.pixels = reader.read<std::uint32_t>(kPixels, 0);
  }
  cloud.provenance = reader.header().value("provenance", nlohmann::json());
  validate(cloud, reader.name());
  return cloud;
}

}  // namespace

Cloud without_camera(Cloud cloud) {
  cloud.sensor.reset();
  cloud.pixels.clear();
  return cloud;
}

Cloud without_removed(Cloud cloud) {
  const std::vector<float>& depth = cloud.sensor->depth.depth;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    if (is_removed(depth[cloud.pixels[k]])) continue;
    cloud.positions[kept] = cloud.positions[k];
    cloud.normals[kept] = cloud.normals[k];
    cloud.radii[kept] = cloud.radii[k];
    cloud.pixels[kept++] = cloud.pixels[k];
  }
  cloud.positions.resize(kept);
  cloud.normals.resize(kept);
  cloud.radii.resize(kept);
  cloud.pixels.resize(kept);
  return cloud;
}

void validate(const Camera& camera, const std::string& name) {
  const Intrinsics& k = camera.intrinsics;
  if (!are_sound(k))
    refuse(
        "the camera's intrinsics are not finite or beyond 2^40 pixels, or a focal length is not "
        "positive",
        name);
  const std::uint64_t pixels = std::uint64_t{camera.width} * camera.height;
  if (pixels == 0 || pixels > std::numeric_limits<std::uint32_t>::max())
    refuse("the camera's image is empty or has more than 2^32 - 1 pixels", name);
  if (!is_rotation(camera.to_world.rotation, kRotationExact) ||
      !is_finite(camera.to_world.translation))
    refuse("the camera's pose is not finite, or not a rotation and a translation", name,
           "make its rotation with rotation_from_matrix or rotation_from_quaternion");
}

void validate(const Cloud& cloud, const std::string& name) {
  const std::size_t n = cloud.size();
  if (n > std::numeric_limits<std::uint32_t>::max()) refuse("more than 2^32 - 1 points", name);
  if (cloud.normals.size() != n || cloud.radii.size() != n ||
      (cloud.sensor ? cloud.pixels.size() != n : !cloud.pixels.empty()))
    refuse("positions, normals, radii and pixels differ in number", name);
  if (!is_finite(cloud.origin)) refuse("the cloud's origin is not finite", name);
  if (cloud.sensor) {
    const auto& [camera, depth] = *cloud.sensor;
    validate(camera, name);
    if (depth.width != camera.width || depth.height != camera.height ||
        depth.depth.size() != std::size_t{camera.width} * camera.height)
      refuse("the depth image is not as large as the camera's", name);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto refuse_point = [&](const char* defect) {
      refuse("point " + std::to_string(i) + " " + defect, name);
    };
    if (!is_finite(cloud.positions[i])) refuse_point("is not finite");
    if (!(cloud.radii[i] >= 0) || !std::isfinite(cloud.radii[i]))
      refuse_point("has a sampling radius that is negative or not finite");
    if (!(std::abs(norm(widen(cloud.normals[i])) - 1) <= kNormalTolerance))
      refuse_point("has a normal that is not of unit length");
    if (cloud.sensor && cloud.pixels[i] >= cloud.sensor->depth.depth.size())
      refuse_point("lies outside of the camera's image");
  }
}

Cloud read_cloud(const std::string& path) {
  return cloud_of(file::Reader(path, file::Kind::cloud));
}

Cloud parse_cloud(std::vector<std::byte> bytes, const std::string& name) {
  return cloud_of(file::Reader(std::move(bytes), name, file::Kind::cloud));
}

void write_cloud(const std::string& path, const Cloud& cloud) {
  validate(cloud, path);
  file::Writer writer(file::Kind::cloud, {{"unit", "m"}, {"provenance", cloud.provenance.json()}});
  writer.add(kOrigin, 0, std::span(&cloud.origin, 1));
  writer.add(kPositions, 0, std::span(cloud.positions));
  writer.add(kNormals, 0, std::span(cloud.normals));
  writer.add(kRadii, 0, std::span(cloud.radii));
  if (cloud.sensor) {
    const Camera& camera = cloud.sensor->camera;
    const CameraRecord record{camera.intrinsics, camera.to_world, camera.width, camera.height};
    writer.add(kPixels, 0, std::span(cloud.pixels));
    writer.add(kCamera, 0, std::span(&record, 1));
    std::vector<float> depth = cloud.sensor->depth.depth;
    for (float& value : depth) value = kept_depth(value);
    writer.add(kDepth, 0, std::span(std::as_const(depth)));
  }
  writer.write(path);
}

}  // namespace vpm
