// From depths and normals to the surface that queries read: the steps, each once, of a frame, whose
// normals are estimated on the way, and of a cloud, which brings its own.
#pragma once

#include "libvpm/cloud/row_bands.h"
#include "libvpm/scene/depth/denoised_image.h"
#include "libvpm/scene/depth/hole_closing.h"

namespace vpm {

// Makes surfaces on the host; keeps its memory from image to image.
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
    image.finish();
  }

 private:
  SeenImage seen_;
  FollowingRows marking_, denoising_;
};

}  // namespace vpm
