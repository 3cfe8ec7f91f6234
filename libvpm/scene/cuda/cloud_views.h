// Defines a cloud as kernels take it: plain pointers and numbers.
#pragma once

#include <cstdint>

#include "libvpm/cloud/camera.h"
#include "libvpm/scene/points/point_tree.h"

namespace vpm::cuda {

// Points to the points of a cloud, about its origin: for an image by pixel (NaN where there is
// none), else in the order of the leaves of their tree.
struct PointsView {
  const Vec3f* positions = nullptr;
  const Vec3f* normals = nullptr;
  std::uint32_t count = 0;
  std::int32_t width = 0;  // the image's, or 0
  PointTree tree;          // only without an image
};

// Holds the parts of a cloud that poses are combined with.
struct CloudFrame {
  bool is_organised = false;
  Vec3 origin;
  Pose camera_to_world;
  Intrinsics intrinsics;
  std::int32_t width = 0, height = 0;
};

}  // namespace vpm::cuda
