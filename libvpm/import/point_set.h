#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

// Points as a file gives them, in its unit and frame. Not finite where nothing was measured.
struct PointSet {
  std::uint32_t width = 0, height = 1;  // a sensor's grid, row by row, if height > 1
  std::vector<Vec3> positions;          // width * height
  std::vector<Vec3> normals;            // as many, or none; of any length
  std::optional<Pose> viewpoint;        // frame of the points to world, if the file tells it
  bool are_float32 = false;             // positions are float32 numbers in the file

  bool organised() const { return height > 1; }
};

// Largest number of points or pixels in a file: 8192 x 8192.
inline constexpr std::uint64_t kMaxPoints = std::uint64_t{1} << 26;

}  // namespace vpm
