// Clouds of the files and images that sensors and other programs write. Library vpm::solid.
#pragma once

#include <vpm/camera.h>
#include <vpm/error.h>
#include <vpm/remark.h>
#include <vpm/scene.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpm {

// Errors and remarks name these in backquotes.
struct ImportParameters {
  std::optional<Intrinsics> intrinsics = {};  // depth images need it; organised PCD tells its own
  // Pose in the world of the camera, or points' frame. If unset: a PCD's VIEWPOINT, or identity.
  std::optional<Pose> camera_pose = {};
  CameraAxes axes = CameraAxes::opencv;  // axes of that frame, and of points

  // Units of the file per metre: 1000 for millimetres. If unset: 1000 for images of integers, or 1.
  std::optional<double> depth_scale = {};
  // Undoes codings of 16-bit values: "swapped" bytes, "big-endian" (the order that PGM's standard
  // tells; otherwise it is looked at), "rotated" by three bits (SUN3D, APC), "disparity" of a raw
  // Kinect, or several with commas.
  std::string decode = {};
  // Values of the file that mean "not measured", beside 0 and, with `usual_invalid`, 65535, 65504,
  // 1e10 and the largest float.
  std::vector<double> invalid = {};
  bool usual_invalid = true;
  struct Range {
    double nearest = 0, farthest = std::numeric_limits<double>::infinity();  // m
  } range = {};              // other depths count as not measured
  bool along_ray = false;    // values are distances along the ray, not along the optical axis
  std::string channel = {};  // depth channel of an OpenEXR image; if empty, its name tells

  bool flip = false;  // turns the normals of points that have some and no camera
  // Turns those of them, after `flip`, that face away from a place, "x,y,z" in the world's frame,
  // or with "neighbours" those that disagree with the normals about them; if empty, none.
  std::string orient = {};
  NormalOptions normals = {};
};

// Returns the cloud of a PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD or PLY file, told by its content;
// "-" is standard input. Depth images and organised PCD get normals from their depth; other PCD and
// PLY must have normals that point into free space. Appends to `remarks`, unless null, what the
// file lets doubt, such as depths in another unit. Throws Error(refused) naming the file and the
// defect for what is damaged, unknown, without normals or without any point;
// Error(invalid_argument) for a depth image without intrinsics and for parameters out of range;
// Error(unavailable) for OpenEXR and TIFF in builds without them. Thread-safe.
VPM_API PointCloud import_cloud(const std::string& path, const ImportParameters& parameters = {},
                                Remarks* remarks = nullptr);

// Returns the cloud of a depth image in memory, as import_cloud() does of a file that holds the
// same width * height values, row by row from the top: counts of 16 bits, 1000 to the metre unless
// `depth_scale` says otherwise, or metres in float. Throws Error(invalid_argument) if there are not
// so many values; otherwise as import_cloud(). Thread-safe.
VPM_API PointCloud import_depth(std::span<const std::uint16_t> values, std::uint32_t width,
                                std::uint32_t height, const ImportParameters& parameters,
                                Remarks* remarks = nullptr);
VPM_API PointCloud import_depth(std::span<const float> values, std::uint32_t width,
                                std::uint32_t height, const ImportParameters& parameters,
                                Remarks* remarks = nullptr);

}  // namespace vpm
