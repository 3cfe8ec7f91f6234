// Hand-written alternatives to the measure, to be timed beside it.
#pragma once

#include <vpm/query_types.h>

#include <memory>
#include <vector>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/model/solid.h"

namespace vpm::bench {

// A frame as applications hold it: a point and a normal for each pixel, in camera coordinates, or
// zeros where nothing was measured.
struct PixelCloud {
  Camera camera;
  DepthImage depth;
  std::vector<Vec3f> points, normals;
};
PixelCloud make_pixel_cloud(const DepthImage& depth, const Camera& camera);

// Usual number of voxels along the solid's longest side in its distance grid, made by OpenVDB.
inline constexpr int kPeerVoxels = 128;
class Voxels;

class Peers {
 public:
  // Builds the tool's grids, once.
  explicit Peers(const Solid& solid, int voxels = kPeerVoxels);
  ~Peers();

  // Returns the penalty force of the points that lie in the tool: the sum of each point's distance,
  // read from a dense grid, along its normal. Looks at the pixels of the tool's rectangle only.
  // Gives no volume.
  Wrench penalty(const PixelCloud& cloud, const Pose& tool_to_camera) const;

  // Returns the volume of the tool's voxels that lie behind the depth of their pixel, m^3. Gives no
  // force.
  double count_voxels(const PixelCloud& cloud, const Pose& tool_to_camera) const;

  // Returns the memory of the grid that is read: OpenVDB's, which is counted, or the dense one.
  std::size_t bytes(bool of_count) const;

 private:
  std::unique_ptr<const Voxels> voxels_;
};

}  // namespace vpm::bench
