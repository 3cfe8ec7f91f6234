// What is written by hand where there is no measure, to be timed beside it.
#pragma once

#include <memory>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/model/solid.h"
#include "libvpm/query/result.h"

namespace vpm::bench {

// A frame as an application holds it: a point and a normal for each pixel, in camera coordinates;
// zero where nothing was measured.
struct PixelCloud {
  Camera camera;
  DepthImage depth;
  std::vector<Vec3f> points, normals;
};
PixelCloud make_pixel_cloud(const DepthImage& depth, const Camera& camera);

// The solid's distances in voxels, kPeerVoxels on its longest side, made by OpenVDB.
inline constexpr int kPeerVoxels = 128;
class Voxels;

class Peers {
 public:
  // What is built once for the tool.
  explicit Peers(const Solid& solid);
  ~Peers();

  // The penalty force of the points that lie in the tool: the distance of each, read from a dense
  // grid, along its normal. Only pixels of the tool's rectangle are looked at. No volume.
  Wrench penalty(const PixelCloud& cloud, const Pose& tool_to_camera) const;

  // The volume of the tool's voxels that lie behind the depth of their pixel, m^3. No force.
  double count_voxels(const PixelCloud& cloud, const Pose& tool_to_camera) const;

 private:
  std::unique_ptr<const Voxels> voxels_;
};

}  // namespace vpm::bench
