#include "libvpm/import/scattered_scan.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <unordered_map>
#include <vector>

#include "libvpm/cloud/scattered_points.h"
#include "libvpm/core/error.h"

namespace vpm {
namespace {

std::string percent_text(std::size_t part, std::size_t whole) {
  char text[16];
  std::snprintf(text, sizeof text, "%.3g %%",
                100 * static_cast<double>(part) / static_cast<double>(whole));
  return text;
}

std::string metres_text(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g m", length);
  return text;
}

double median_radius(const Cloud& cloud) {
  std::vector<float> radii = cloud.radii;
  const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), middle, radii.end());
  return *middle;
}

void refuse_missing_normals(const PointSet& points, const std::string& name) {
  if (points.normals.empty()) {
    refuse("points without a grid need normals (PCD: normal_x normal_y normal_z; PLY: nx ny nz)",
           name, "estimate them first, or give the depth image");
  }
  if (std::all_of(points.normals.begin(), points.normals.end(),
                  [](const Vec3& n) { return n == Vec3{}; })) {
    refuse("all its normals are zero, as in files of 3D Gaussian splats", name,
           "estimate them first, or give the depth image");
  }
}

// Returns a warning if nearly all normals face away from the origin, where the sensor was.
Remarks facing_away(const PointSet& points) {
  std::size_t away = 0, all = 0;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    const double along = dot(points.positions[i], points.normals[i]);
    away += along > 0;
    all += along != 0 && std::abs(along) < HUGE_VAL;
  }
  constexpr double kNearlyAll = 0.9;
  if (all == 0 || static_cast<double>(away) < kNearlyAll * static_cast<double>(all)) return {};
  return {{true, percent_text(away, all) + " of its normals face away from its VIEWPOINT, and so "
                                           "from the sensor; normals must point into free "
                                           "space: give `flip` to turn them"}};
}

// Returns a warning if many normals are opposite to others in the same small cube.
Remarks facing_each_other(const Cloud& cloud) {
  constexpr double kCubeOfRadius = 2, kOpposite = -0.5, kMany = 0.1;
  const double side = kCubeOfRadius * median_radius(cloud);
  if (!(side > 0)) return {};
  const auto key = [&](const Vec3f& p) {
    std::size_t value = 0;
    for (const float coordinate : {p.x, p.y, p.z})
      value = value * 1'000'003 +
              static_cast<std::size_t>(static_cast<std::int64_t>(std::floor(coordinate / side)));
    return value;
  };
  std::unordered_map<std::size_t, Vec3f> first_of_cube;
  std::size_t opposite = 0;
  for (std::size_t k = 0; k < cloud.size(); ++k) {
    const Vec3f first =
        first_of_cube.try_emplace(key(cloud.positions[k]), cloud.normals[k]).first->second;
    opposite += dot(widen(first), widen(cloud.normals[k])) < kOpposite;
  }
  if (static_cast<double>(opposite) < kMany * static_cast<double>(cloud.size())) return {};
  return {{true, "normals of neighbouring points face opposite ways (" +
                     percent_text(opposite, cloud.size()) +
                     " do), as if they were never oriented; all must point into free space"}};
}

// Returns a warning if float32 coordinates of the file are too coarse for the points' spacing.
Remarks coarse_coordinates(const PointSet& points, const Cloud& cloud) {
  constexpr double kMostRounding = 1.0 / 16;  // part of the sampling radius
  if (!points.are_float32) return {};
  double farthest = 0;
  for (const Vec3& p : points.positions)
    if (is_finite(p)) farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() * farthest;
  if (rounding <= kMostRounding * median_radius(cloud)) return {};
  return {{true, "its coordinates are float32 up to " + metres_text(farthest) +
                     " from the origin, rounded there by up to " + metres_text(rounding) +
                     ", too much for the points' spacing: the shape is lost; write them as double, "
                     "or nearer to the origin"}};
}

}  // namespace

ScatteredScan scan_of_scattered(const PointSet& points, const Pose& to_world,
                                const std::string& name) {
  refuse_missing_normals(points, name);
  ScatteredScan scan;
  scan.cloud = cloud_of_scattered_points(points.positions, points.normals, to_world, name);
  scan.invalid =
      static_cast<std::size_t>(std::count_if(points.positions.begin(), points.positions.end(),
                                             [](const Vec3& p) { return !is_finite(p); }));
  scan.without_normal = points.positions.size() - scan.invalid - scan.cloud.size();
  if (scan.without_normal > 0)
    scan.remarks.push_back(
        {false, std::to_string(scan.without_normal) + " points have no normal and are left out"});
  if (points.viewpoint) append(scan.remarks, facing_away(points));
  append(scan.remarks, facing_each_other(scan.cloud));
  append(scan.remarks, coarse_coordinates(points, scan.cloud));
  return scan;
}

}  // namespace vpm
