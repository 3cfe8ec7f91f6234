#include "tests/setup/test_setups.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/scattered_points.h"

namespace vpm {

ToolModel cube_of(double across, Vec3 center, double scale) {
  constexpr int kPieces = 8;  // along each side
  const double side = across / std::sqrt(3.0), piece = side / kPieces;
  ToolModel model;
  model.volume = side * side * side;
  model.center_of_mass = center;
  model.radius = across / 2;
  model.spheres = {{center, side / 2}};
  Level level;
  level.sphere_count = 1;
  for (int k = 0; k < kPieces * kPieces * kPieces; ++k) {
    const auto place = [&](int i) { return (i + 0.5) * piece - side / 2; };
    const Vec3 at{place(k % kPieces), place(k / kPieces % kPieces), place(k / kPieces / kPieces)};
    level.samples.push_back(
        {narrow(at), static_cast<float>(piece / 2), 1.0 / (kPieces * kPieces * kPieces)});
  }
  model.levels.push_back(std::move(level));
  model.provenance.json()["packing"]["parameters"]["scale"] = scale;
  return model;
}

Cloud seen_by_camera(double focal, const std::function<double(double u, double v)>& depth,
                     const Pose& camera_to_world) {
  const Camera camera{{focal, focal, 31.5, 23.5}, 64, 48, camera_to_world};
  DepthImage image{camera.width, camera.height, {}};
  for (std::uint32_t v = 0; v < camera.height; ++v)
    for (std::uint32_t u = 0; u < camera.width; ++u)
      image.depth.push_back(static_cast<float>(depth(u, v)));
  return make_cloud(image, camera, {});
}

Cloud wall_at(double depth, double focal, const Pose& camera_to_world) {
  return seen_by_camera(
      focal, [&](double u, double) { return depth * (1 + 0.1 * (u - 31.5) / 64); },
      camera_to_world);
}

Cloud scanned_cube(double across, double spacing) {
  const double half = across / std::sqrt(3.0) / 2;
  const int most = static_cast<int>(half / spacing);
  std::vector<Vec3> positions, normals;
  for (int u = -most; u <= most; ++u)
    for (int v = -most; v <= most; ++v)
      for (const double to : {-1.0, 1.0}) {
        positions.insert(positions.end(), {{u * spacing, v * spacing, to * half},
                                           {u * spacing, to * half, v * spacing},
                                           {to * half, u * spacing, v * spacing}});
        normals.insert(normals.end(), {{0, 0, to}, {0, to, 0}, {to, 0, 0}});
      }
  return cloud_of_scattered_points(std::move(positions), std::move(normals), Pose{}, "points");
}

Cloud told(Cloud cloud, const std::string& key, const nlohmann::json& value) {
  cloud.provenance.json()["parameters"][key] = value;
  return cloud;
}

}  // namespace vpm
