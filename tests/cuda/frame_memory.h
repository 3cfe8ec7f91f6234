// Fetches the data of a depth frame from the device.
#pragma once

#include <optional>
#include <vector>

#include "libvpm/scene/depth_frames.h"

namespace vpm::testing {

struct FrameMemory {
  std::vector<Vec3f> normals;  // per pixel, camera axes
  std::vector<float> measured;
  std::vector<std::vector<InverseDepthRange>> tiles;
};

// Returns nothing if the frame's cloud is not made on the device.
std::optional<FrameMemory> memory_on_device(const DepthBody& frame);
// Returns the data that the frame should have.
FrameMemory memory_of(const PreparedImage& image);

// True if all bytes are the same.
bool same_bits(const FrameMemory& a, const FrameMemory& b);

}  // namespace vpm::testing
