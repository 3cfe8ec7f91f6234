#include "libvpm/import/cloud_export.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/normal_checks.h"

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

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// Returns the place that coordinates of float32 are written about: the world's origin, where they
// hold the points to a small part of their spacing, and the cloud's origin where they do not.
Vec3 written_about(const Cloud& cloud) {
  constexpr double kMostRounding = 1.0 / 256;  // part of the median radius of the disks
  if (cloud.size() == 0) return {};
  double farthest = 0;
  for (const Vec3f& p : cloud.positions) {
    const Vec3 there = cloud.origin + widen(p);
    farthest = std::max({farthest, std::abs(there.x), std::abs(there.y), std::abs(there.z)});
  }
  const double rounding = std::ldexp(farthest, -std::numeric_limits<float>::digits);
  return rounding <= kMostRounding * median_radius(cloud) ? Vec3{} : cloud.origin;
}

// Returns the place of a point about another place.
Vec3f place_about(const Vec3& about, const Cloud& cloud, std::size_t point) {
  return about == cloud.origin ? cloud.positions[point]
                               : narrow(cloud.origin + widen(cloud.positions[point]) - about);
}

// Returns the header before binary data; `frame` is a line that tells where the points are, or "".
std::string pcd_header(std::size_t width, std::size_t height, const std::string& frame) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
         "FIELDS x y z normal_x normal_y normal_z\nSIZE 4 4 4 4 4 4\nTYPE F F F F F F\n"
         "COUNT 1 1 1 1 1 1\n" +
         formatted("WIDTH %zu\nHEIGHT %zu\n", width, height) + frame +
         formatted("POINTS %zu\nDATA binary\n", width * height);
}

// Returns the line of a header that tells what the points are written about; "" for the world.
std::string origin_line(const char* comment, const Vec3& about) {
  return about == Vec3{}
             ? ""
             : comment + formatted(" vpm origin %.17g %.17g %.17g\n", about.x, about.y, about.z);
}

std::string viewpoint_line(const Pose& pose) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  const Vec3 t = pose.translation;
  return formatted("VIEWPOINT %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", t.x, t.y, t.z, q.w, q.x,
                   q.y, q.z);
}

std::string to_organised_pcd(const Cloud& cloud) {
  const auto& [camera, depth] = *cloud.sensor;
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3f> normals(depth.depth.size(), Vec3f{kNaN, kNaN, kNaN});
  const Rotation to_camera = transpose(camera.to_world.rotation);
  for (std::size_t k = 0; k < cloud.size(); ++k)
    normals[cloud.pixels[k]] = narrow(to_camera * widen(cloud.normals[k]));
  std::string bytes = pcd_header(depth.width, depth.height, viewpoint_line(camera.to_world));
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
  const Vec3 about = written_about(cloud);
  std::string bytes = "ply\nformat binary_little_endian 1.0\n" + origin_line("comment", about) +
                      "element vertex " + std::to_string(cloud.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
                      "property float ny\nproperty float nz\nproperty float radius\nend_header\n";
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    append(bytes, place_about(about, cloud, k));
    append(bytes, cloud.normals[k]);
    append(bytes, cloud.radii[k]);
  }
  return bytes;
}

std::string to_pcd(const Cloud& cloud) {
  if (cloud.sensor) return to_organised_pcd(cloud);
  const Vec3 about = written_about(cloud);
  std::string bytes = pcd_header(cloud.size(), 1, origin_line("#", about));
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    append(bytes, place_about(about, cloud, k));
    append(bytes, cloud.normals[k]);
  }
  return bytes;
}

void check_points_path(const std::string& path) {
  if (!path.ends_with(".ply") && !path.ends_with(".pcd"))
    throw Error(ErrorKind::invalid_argument, "the name must end in .ply or .pcd",
                "`export` " + path);
}

Remarks write_points(const std::string& path, const Cloud& cloud) {
  check_points_path(path);
  const bool is_ply = path.ends_with(".ply");
  file::write_all(path, is_ply ? to_ply(cloud) : to_pcd(cloud));
  const Vec3 about = is_ply || !cloud.sensor ? written_about(cloud) : Vec3{};
  if (about == Vec3{}) return {};
  return {{false, "float32 does not hold its points in the world: they are written about " +
                      formatted("%.15g, %.15g, %.15g", about.x, about.y, about.z) +
                      ", which other programs must add"}};
}

}  // namespace vpm
