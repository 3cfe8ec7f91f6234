// A camera's surface as queries read it: freed of most of its noise. Once per frame.
//
// A pixel's normal becomes the mean of its own and those of sixteen pixels around it that show the
// same smooth surface, and no crease beside it; where its own window is one surface, its inverse
// depth becomes that of a paraboloid fitted to the window, among those of the pixels beside it.
// Beside creases and steps depths stay as they were measured. README.md has the reasons and what
// they gain.
#pragma once

#include <vector>

#include "libvpm/cloud/padded_image.h"
#include "libvpm/core/vec3.h"
#include "libvpm/include/vpm/camera.h"
#include "libvpm/scene/depth/denoised_pixel.h"
#include "libvpm/scene/depth/inverse_depth_pyramid.h"

namespace vpm {

// What was seen at each pixel.
struct SeenImage {
  // Rows above and below its own by which a pixel is marked.
  static constexpr int kReachOfMarks = kDenoisedRadius;

  PaddedImage inverse;  // depths, without holes that are to be closed
  PaddedImage x, y, z;  // normal in camera axes, zero where there is none
  PaddedImage marked;   // the first one, negative where the pixel is not clear (denoised_pixel.h)

  void resize(std::uint32_t width, std::uint32_t height);
  void set_normal(int u, int v, Vec3f normal);
  // Of rows [begin, end); threads may mark different ones.
  void mark_rows(int begin, int end);
};

class DenoisedImage {
 public:
  // Rows above and below its own that decide what a pixel is settled to, by their marks too.
  static constexpr int kReach = kDenoisedReach + SeenImage::kReachOfMarks;

  // For images of this size; no new memory where it has it.
  void resize(std::uint32_t width, std::uint32_t height);
  // Reads rows [begin, end), whose neighbours are marked where they are to be settled; threads may
  // read different ones.
  void read_rows(const SeenImage& seen, Denoising points, int begin, int end);
  // After all rows.
  void finish() { tiles_.unite(); }

  DepthSurface surface(const Intrinsics& k) const;

 private:
  std::size_t first_of_row(int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_);
  }

  int width_ = 0, height_ = 0;
  std::vector<Vec3f> normals_;
  std::vector<float> measured_;
  InverseDepthPyramid tiles_;
};

}  // namespace vpm
