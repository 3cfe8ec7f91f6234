#include "libvpm/import/cloud_export.h"

#include <cstdio>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"

namespace vpm {
namespace {

template <class Value>
void append(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append(std::string& bytes, Vec3f v) {
  append(bytes, v.x);
  append(bytes, v.y);
  append(bytes, v.z);
}

std::string pcd_header(std::size_t width, std::size_t height, const Pose& viewpoint) {
  const Quaternion q = quaternion_from_rotation(viewpoint.rotation);
  const Vec3 t = viewpoint.translation;
  char text[640];
  std::snprintf(text, sizeof text,
                "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
                "FIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n"
                "COUNT 1 1 1 1 1 1\nWIDTH %zu\nHEIGHT %zu\n"
                "VIEWPOINT %.17g %.17g %.17g %.17g %.17g %.17g %.17g\nPOINTS %zu\nDATA binary\n",
                width, height, t.x, t.y, t.z, q.w, q.x, q.y, q.z, width * height);
  return text;
}

std::string to_organised_pcd(const Cloud& cloud) {
  const auto& [camera, depth] = *cloud.sensor;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3f> normals(depth.depth.size(), Vec3f{kNaN, kNaN, kNaN});
  const Rotation to_camera = transpose(camera.to_world.rotation);
  for (std::size_t k = 0; k < cloud.size(); ++k)
    normals[cloud.pixels[k]] = narrow(to_camera * widen(cloud.normals[k]));
  std::string bytes = pcd_header(depth.width, depth.height, camera.to_world);
  for (std::size_t i = 0; i < depth.depth.size(); ++i) {
    const std::size_t column = i % depth.width, row = i / depth.width;
    const double u = static_cast<double>(column), v = static_cast<double>(row);
    append(bytes, is_measured(depth.depth[i])
                      ? narrow(unproject(camera.intrinsics, u, v, depth.depth[i]))
                      : Vec3f{kNaN, kNaN, kNaN});
    append(bytes, normals[i]);
  }
  return bytes;
}

}  // namespace

std::string to_ply(const Cloud& cloud) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(cloud.size()) +
      "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\n"
      "property float ny\nproperty float nz\nproperty float radius\nend_header\n";
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Vec3 position = cloud.origin + widen(cloud.positions[k]);
    append(bytes, position.x);
    append(bytes, position.y);
    append(bytes, position.z);
    append(bytes, cloud.normals[k]);
    append(bytes, cloud.radii[k]);
  }
  return bytes;
}

std::string to_pcd(const Cloud& cloud) {
  if (cloud.sensor) return to_organised_pcd(cloud);
  std::string bytes = pcd_header(cloud.size(), 1, Pose{{}, cloud.origin});
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    append(bytes, cloud.positions[k]);
    append(bytes, cloud.normals[k]);
  }
  return bytes;
}

void check_points_path(const std::string& path) {
  if (!path.ends_with(".ply") && !path.ends_with(".pcd"))
    throw Error(ErrorKind::invalid_argument, "the name must end in .ply or .pcd",
                "`export` " + path);
}

void write_points(const std::string& path, const Cloud& cloud) {
  check_points_path(path);
  file::write_all(path, path.ends_with(".ply") ? to_ply(cloud) : to_pcd(cloud));
}

}  // namespace vpm
