// A point cloud with normals, as a depth camera or a scanner saw a surface. formats/cloud.md.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"

namespace vpm {

// What an organised cloud keeps of its sensor: where it stood and what it saw, also where no normal
// was found.
struct CloudSensor {
  Camera camera;
  DepthImage depth;
};

struct Cloud {
  Vec3 origin;  // world; positions are relative to it so that far scenes lose no digits
  std::vector<Vec3f> positions;  // metres
  std::vector<Vec3f> normals;    // unit, into free space
  std::vector<float>
      radii;  // sampling radius: the disk of this radius is the point's part of the surface
  std::vector<std::uint32_t> pixels;  // v * width + u of each point; empty where there is no sensor
  std::optional<CloudSensor> sensor;
  nlohmann::json provenance;

  std::size_t size() const { return positions.size(); }
};

// The same points, of which nobody knows any more what saw them.
Cloud without_camera(Cloud cloud);

// Refuses what no query could use, naming the first offending point: sizes that differ, positions
// or radii that are not finite, radii < 0, normals that are not of unit length (tolerance 1e-3),
// pixels outside of the image.
void validate(const Cloud& cloud, const std::string& name);
// What it asks of the camera alone. Its rotation comes from the functions of pose.h, so it is exact
// (kRotationExact).
void validate(const Camera& camera, const std::string& name);

}  // namespace vpm
