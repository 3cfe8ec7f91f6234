#pragma once

#include "libvpm/scene/depth/depth_surface.h"

namespace vpm::cuda {

// Points to the device memory for the cloud of an image, by pixel.
struct CloudRoom {
  Vec3f* positions = nullptr;      // about the camera, world axes; NaN without a point
  Vec3f* normals = nullptr;        // world axes
  Vec3f* pixel_normals = nullptr;  // camera axes, as DepthSurface reads them
  float* measured = nullptr;       // inverse depth, 1/m, holes closed
  InverseDepthRange* tiles[DepthSurface::kMaxLevels] = {};
  std::int32_t levels = 0;
};

}  // namespace vpm::cuda
