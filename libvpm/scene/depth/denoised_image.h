// Denoises a camera's surface, once per frame.
//
// A pixel's normal becomes the mean of its own and those of sixteen pixels around it that show the
// same smooth surface. Its inverse depth becomes that of a paraboloid fitted to its window, unless
// that holds a crease or a step. README.md has the reasons.
#pragma once

#include <vector>

#include "libvpm/cloud/padded_image.h"
#include "libvpm/core/vec3.h"
#include "libvpm/include/vpm/camera.h"
#include "libvpm/scene/depth/denoised_pixel.h"
#include "libvpm/scene/depth/inverse_depth_pyramid.h"

namespace vpm {

// Holds the measured image, and its marks.
struct SeenImage {
  // Rows above and below a pixel that decide its mark.
  static constexpr int kReachOfMarks = kDenoisedRadius;

  PaddedImage inverse;  // inverse depth, 1/m, holes closed
  PaddedImage x, y, z;  // normals in camera axes, zero where there is none
  PaddedImage marked;   // `inverse`, negative where the pixel is not clear (denoised_pixel.h)

  void resize(std::uint32_t width, std::uint32_t height);
  void set_normal(int u, int v, Vec3f normal);
  // Marks rows [begin, end); threads may mark different ones.
  void mark_rows(int begin, int end);
};

class DenoisedImage {
 public:
  // Rows above and below a pixel that its denoised value depends on, through marks too.
  static constexpr int kReach = kDenoisedReach + SeenImage::kReachOfMarks;

  // Prepares for images of this size, without new memory where it has it.
  void resize(std::uint32_t width, std::uint32_t height);
  // Denoises rows [begin, end), whose neighbours must be marked, or copies them as measured.
  // Threads may take different rows.
  void read_rows(const SeenImage& seen, Denoising points, int begin, int end);
  // Builds the pyramid. All rows must be read.
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
