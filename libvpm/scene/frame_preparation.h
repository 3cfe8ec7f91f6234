// From a depth image to a prepared cloud without the cloud between them: what PreparedCloud(
// make_cloud(...), points) gives, bit for bit, several times as fast. A frame's rows go through the
// normals to the points that queries read while they are in the cache, pixels are in canonical
// order as they come, and memory is that of the frame before.
#pragma once

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/scene/image_steps.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm {

class FramePreparation {
 public:
  // Throws Error(invalid_argument) for options out of range.
  explicit FramePreparation(const NormalOptions& options, Denoising points = Denoising::on);

  // `cloud` becomes that of the frame and takes no new memory if it held a frame of the same size;
  // nobody may ask it meanwhile. Throws what make_cloud() and PreparedCloud() throw; then `cloud`
  // is empty.
  void prepare(const DepthImage& depth, const Camera& camera, PreparedCloud& cloud);

 private:
  bool prepare_rows(const DepthImage& depth, const Camera& camera, PreparedCloud& cloud);
  void close_ranks(std::size_t width, PreparedCloud& cloud) const;

  NormalOptions options_;
  Denoising points_;
  NormalImages images_;
  ImageSteps steps_;
  std::vector<double> rays_;               // x / z of each column
  std::vector<std::uint32_t> row_points_;  // of each row
};

}  // namespace vpm
