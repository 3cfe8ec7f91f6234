// Reads a camera's intrinsics from the files that calibrations and drivers write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "libvpm/cloud/camera.h"
#include "libvpm/import/depth_factor.h"
#include "libvpm/import/remark.h"

namespace vpm {

// Part of a calibrated image that a driver cuts out, px.
struct ImageRegion {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;
};

struct IntrinsicsFile {
  Intrinsics intrinsics;
  // Size of the calibrated image, px; 0 if the file does not tell.
  std::uint32_t width = 0, height = 0;
  std::optional<ImageRegion> region;  // if the file tells one
  std::optional<DepthFactor> factor;  // if the file tells one
  Remarks remarks;
};

// Parses one of these, in UTF-8 with or without a byte order mark or in UTF-16 with it:
//   text   four numbers fx fy cx cy, or a matrix of 3x3, 3x4 or 4x4, separated by blanks, commas
//          and line ends; or these with names: lines "fx = 150", "K: 150 0 …" (KITTI), or a line of
//          names over one of numbers
//   JSON   or YAML of which an object has fx, fy, cx, cy (RealSense: ppx, ppy; ORB-SLAM:
//          Camera.fx; nerfstudio: fl_x, fl_y), a matrix called K, camera_matrix, intrinsic_matrix
//          or intrinsics (ROS camera_info, Open3D, OpenCV; M1 of a pair), or a list intrinsics of
//          fx, fy, cx, cy (Kalibr, EuRoC); keys are compared without case and underscores; of
//          several cameras that differ the one under a key "depth", or under the number in the
//          name of the depth image, `image` (BOP's scene_camera.json). Where the lens distorts,
//          ROS' P is taken instead, which holds for the rectified image
//   NPY    one of the matrices, or the four numbers
// Throws Error(refused), naming `name`, for anything else, Error(unavailable) for YAML in builds
// without it.
IntrinsicsFile parse_intrinsics(std::span<const std::byte> bytes, const std::string& name,
                                const std::string& image = {});

// Returns the first document of a YAML text as JSON values, also as OpenCV writes it (%YAML:1.0,
// !!opencv-matrix); scalars become numbers where they are some, and texts otherwise. Throws
// Error(refused), naming `name`, for what is no YAML, and Error(unavailable) in builds without
// yaml-cpp.
nlohmann::json parse_yaml(std::string_view text, const std::string& name);

}  // namespace vpm
