// Prepares a cloud from a depth image with the bits of PreparedCloud(make_cloud(...), points),
// several times as fast: rows go through all steps while they are in the cache, pixels need no
// sorting, and the memory of the last frame is used again.
#pragma once

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/scene/image_steps.h"
#include "libvpm/scene/prepared_cloud.h"

namespace vpm {

class FramePreparation {
 public:
  // Throws Error(invalid_argument) for options out of range.
  explicit FramePreparation(const NormalOptions& options, Denoising points = Denoising::on);

  // Makes `cloud` that of the frame, without new memory if it held a frame of the same size; nobody
  // may use it meanwhile. Throws as make_cloud() and PreparedCloud() do; `cloud` is empty then.
  void prepare(const DepthImage& depth, const Camera& camera, PreparedCloud& cloud);

 private:
  void take_camera(const Camera& camera, PreparedCloud& cloud);
  bool prepare_rows(const DepthImage& depth, const Camera& camera, PreparedCloud& cloud);
  void close_ranks(std::size_t width, PreparedCloud& cloud) const;

  NormalOptions options_;
  Denoising points_;
  NormalImages images_;
  ImageSteps steps_;
  std::vector<double> rays_;               // x / z for each column
  std::vector<std::uint32_t> row_points_;  // number of points in each row
};

}  // namespace vpm
