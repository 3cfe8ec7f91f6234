// What queries read of a depth frame, fetched from the device.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/scene/depth_frames.h"

namespace vpm::testing {

struct FrameMemory {
  std::vector<Vec3f> positions, normals, pixel_normals;  // by pixel; positions NaN without a point
  std::vector<float> measured;
  std::vector<std::vector<InverseDepthRange>> tiles;
};

// Nothing where the frame's cloud is not made on the device.
std::optional<FrameMemory> memory_on_device(const DepthFrame& frame);
// What it should hold.
FrameMemory memory_of(const PreparedCloud& cloud);

// The bytes are the same, but for those of NaN.
bool same_bits(const FrameMemory& a, const FrameMemory& b);

}  // namespace vpm::testing
