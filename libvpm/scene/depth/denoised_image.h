// Makes the surface of a camera's image from depths and normals, once per frame: closes holes,
// denoises, and builds the pyramid that queries read.
//
// A pixel's normal becomes the mean of its own and those of sixteen pixels around it that show the
// same smooth surface. Its inverse depth becomes that of a paraboloid fitted to its window, unless
// that holds a crease or a step. README.md has the reasons.
#pragma once

#include <vpm/camera.h>

#include <vector>

#include "libvpm/cloud/depth_image.h"
#include "libvpm/cloud/padded_image.h"
#include "libvpm/cloud/row_bands.h"
#include "libvpm/core/vec3.h"
#include "libvpm/scene/depth/denoised_pixel.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {

// Closes the holes of a whole image of inverse depth with a margin.
void close_holes(PaddedImage& inverse);

// Holds the measured image, and its marks.
struct SeenImage {
  // Rows above and below a pixel that decide its mark.
  static constexpr int kReachOfMarks = kDenoisedRadius;

  PaddedImage inverse;  // inverse depth, 1/m, holes closed; -0 where a pixel was removed
  PaddedImage x, y, z;  // normals in camera axes, zero where there is none
  PaddedImage marked;   // `inverse`, negative where the pixel is not clear (denoised_pixel.h)

  void resize(std::uint32_t width, std::uint32_t height);
  void set_normal(int u, int v, Vec3f normal);
  // Marks the pixels of rows [begin, end) that were removed, whose inverse depths are taken
  // already.
  void take_removed(const DepthImage& depth, int begin, int end);
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
  // Unites the pixels to tiles of 2, 4, ... pixels a side. All rows must be read.
  void unite();

  DepthSurface surface(const Intrinsics& k) const;

 private:
  std::size_t first_of_row(int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_);
  }

  int width_ = 0, height_ = 0;
  std::vector<Vec3f> normals_;
  std::vector<float> measured_;
  std::vector<std::vector<InverseDepthRange>> tiles_;  // 2^l pixels a side in tiles_[l]
};

// Makes surfaces on the host by the steps of a frame, whose normals are estimated on the way, and
// of a cloud, which brings its own. Keeps its memory from image to image.
class ImageSteps {
 public:
  // Sets the size; allocates nothing if it is the same.
  void resize(std::uint32_t width, std::uint32_t height) { seen_.resize(width, height); }
  SeenImage& seen() { return seen_; }

  // Makes `image`. take(begin, end) stores the inverse depths of rows [begin, end) in seen();
  // find(begin, end, made) stores the normals of rows and calls made(v) after each, in order. Both
  // are called for bands of rows, from several threads. A row is denoised as soon as all that it
  // depends on is there, while that is in the cache.
  template <class Take, class Find>
  void make(Denoising points, const Take& take, const Find& find, DenoisedImage& image) {
    const int height = seen_.inverse.height;
    image.resize(static_cast<std::uint32_t>(seen_.inverse.width),
                 static_cast<std::uint32_t>(height));
    static_assert(DenoisedImage::kReach <= FollowingRows::kMostReach);
    marking_.start(height, SeenImage::kReachOfMarks);
    denoising_.start(height, DenoisedImage::kReach);
    for_bands(height, take);
    close_holes(seen_.inverse);
    // A row reads marks of other bands too: of two threads the one that comes first to a border has
    // marked its rows before.
    const auto made = [&](int v) {
      if (points == Denoising::on)
        marking_.made(v, [&](int first, int last) { seen_.mark_rows(first, last); });
      denoising_.made(v, [&](int first, int last) { image.read_rows(seen_, points, first, last); });
    };
    for_bands(height, [&](int begin, int end) { find(begin, end, made); });
    image.unite();
  }

 private:
  SeenImage seen_;
  FollowingRows marking_, denoising_;
};

}  // namespace vpm
