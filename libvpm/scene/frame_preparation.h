// Prepares a depth image for queries with the bits of PreparedImage(make_cloud(...), points),
// several times as fast: rows go through all steps while they are in the cache, pixels need no
// sorting, and the memory of the last frame is used again.
#pragma once

#include <cstddef>
#include <vector>

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/scene/depth/denoised_image.h"
#include "libvpm/scene/depth/prepared_image.h"

namespace vpm {

class FramePreparation {
 public:
  // Throws Error(invalid_argument) for options out of range.
  explicit FramePreparation(const NormalOptions& options, Denoising points = Denoising::on);

  // Makes `image` that of the frame, without new memory if it held a frame of the same size; nobody
  // may use it meanwhile. Throws as make_cloud() and PreparedImage() do; `image` is empty then.
  void prepare(const DepthImage& depth, const Camera& camera, PreparedImage& image);

 private:
  void take_camera(const Camera& camera, PreparedImage& image);
  bool prepare_rows(const DepthImage& depth, const Camera& camera, PreparedImage& image);
  void close_ranks(std::size_t width, PreparedImage& image) const;

  NormalOptions options_;
  Denoising points_;
  NormalImages images_;
  ImageSteps steps_;
  std::vector<double> rays_;               // x / z for each column
  std::vector<std::uint32_t> row_points_;  // number of points in each row
};

}  // namespace vpm
