// Reads a camera's intrinsics from the files that calibrations and drivers write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "libvpm/cloud/camera.h"
#include "libvpm/import/remark.h"

namespace vpm {

struct IntrinsicsFile {
  Intrinsics intrinsics;
  // Size of the calibrated image, px; 0 if the file does not tell.
  std::uint32_t width = 0, height = 0;
  Remarks remarks;
};

// Parses one of these:
//   text   four numbers fx fy cx cy, or a matrix of 3x3 or 3x4, separated by blanks, commas and
//          line ends
//   JSON   or YAML of which an object has fx, fy, cx, cy (RealSense: ppx, ppy; ORB-SLAM:
//          Camera.fx; nerfstudio: fl_x, fl_y), or a matrix called K, camera_matrix or
//          intrinsic_matrix (ROS camera_info, Open3D, OpenCV); of several objects the one under a
//          key "depth"
// Throws Error(refused), naming `name`, for anything else, Error(unavailable) for YAML in builds
// without it.
IntrinsicsFile parse_intrinsics(std::span<const std::byte> bytes, const std::string& name);

// Returns the first document of a YAML text as JSON values, also as OpenCV writes it (%YAML:1.0,
// !!opencv-matrix); scalars become numbers where they are some, and texts otherwise. Throws
// Error(refused), naming `name`, for what is no YAML, and Error(unavailable) in builds without
// yaml-cpp.
nlohmann::json parse_yaml(std::string_view text, const std::string& name);

}  // namespace vpm
