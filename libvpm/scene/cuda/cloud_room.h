#pragma once

#include "libvpm/scene/depth/depth_surface.h"

namespace vpm::cuda {

// Memory for what is made of an image, by pixel.
struct CloudRoom {
  Vec3f* positions = nullptr;      // about the camera, world axes; NaN where there is no point
  Vec3f* normals = nullptr;        // world axes
  Vec3f* pixel_normals = nullptr;  // camera axes, as DepthSurface reads them
  float* measured = nullptr;       // inverse depth without holes that are to be closed
  InverseDepthRange* tiles[DepthSurface::kMaxLevels] = {};
  std::int32_t levels = 0;
};

}  // namespace vpm::cuda
