// Reads a camera's intrinsics from the files that calibrations and drivers write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "libvpm/cloud/camera.h"
#include "libvpm/import/remark.h"

namespace vpm {

struct IntrinsicsFile {
  Intrinsics intrinsics;
  std::uint32_t width = 0, height = 0;  // of the calibrated image, px; 0 if the file does not tell
  Remarks remarks;
};

// Parses one of these:
//   text   four numbers fx fy cx cy, or a matrix of 3x3 or 3x4; blanks, commas and line ends
//   separate JSON   or YAML of which an object has fx, fy, cx, cy (RealSense: ppx, ppy; ORB-SLAM:
//   Camera.fx; nerfstudio: fl_x, fl_y),
//          or a matrix called K, camera_matrix or intrinsic_matrix (ROS camera_info, Open3D,
//          OpenCV); of several objects the one under a key "depth"
// Throws Error(refused), naming `name`, for anything else, Error(unavailable) for YAML in builds
// without it.
IntrinsicsFile parse_intrinsics(std::span<const std::byte> bytes, const std::string& name);

}  // namespace vpm
