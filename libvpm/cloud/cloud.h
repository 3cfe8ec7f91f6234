// Point cloud with normals, as a depth camera or a scanner sees a surface. Specified in
// formats/cloud.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/file/provenance.h"

namespace vpm {

// Sensor of an organised cloud: its pose and all depths, also those without a normal.
struct CloudSensor {
  Camera camera;
  DepthImage depth;
};

struct Cloud {
  // World coordinates; positions are relative to it, so that far scenes lose no digits.
  Vec3 origin;
  std::vector<Vec3f> positions;  // in metres
  std::vector<Vec3f> normals;    // unit vectors, into free space
  std::vector<float> radii;      // sampling radii, m: the disks cover the surface
  // Pixel v * width + u of each point; empty without a sensor.
  std::vector<std::uint32_t> pixels;
  std::optional<CloudSensor> sensor;
  file::Provenance provenance;

  std::size_t size() const { return positions.size(); }
};

// Returns the cloud without its sensor and pixels.
Cloud without_camera(Cloud cloud);
// Returns the cloud without the points at pixels that were removed from its sensor's image.
Cloud without_removed(Cloud cloud);

// Throws Error(refused) if no query could use the cloud, naming the first offending point: vectors
// of different sizes, positions or radii not finite, radii < 0, normals not of unit length
// (tolerance 1e-3), pixels outside the image.
void validate(const Cloud& cloud, const std::string& name);
// Throws Error(refused) if the camera has unsound intrinsics, no pixels, or a rotation that is not
// exact (kRotationExact), as those from pose.h are.
void validate(const Camera& camera, const std::string& name);

// Reads a cloud from a file, from standard input ("-"), or from bytes. Throws Error(refused) if it
// breaks a rule of formats/cloud.md.
Cloud read_cloud(const std::string& path);
Cloud parse_cloud(std::vector<std::byte> bytes, const std::string& name);

// Writes a cloud atomically, or to standard output ("-"). Throws Error(cannot_write).
void write_cloud(const std::string& path, const Cloud& cloud);

}  // namespace vpm
