// A camera's surface as queries read it: freed of most of its noise. Once per frame.
//
// A pixel's normal becomes the mean of its own and those of eight pixels around it that show the
// same smooth surface; where all of them do, and all its window is one surface, its inverse depth
// becomes that of a paraboloid fitted to the window, among those of the pixels beside it. Beside
// creases and steps depths stay as they were measured. README.md has the reasons and what they gain.
#pragma once

#include <vector>

#include "libvpm/cloud/padded_image.h"
#include "libvpm/core/vec3.h"
#include "libvpm/query/settled_pixel.h"

namespace vpm {

// The normal of each pixel in camera axes, zero where there is none and around the image; an image
// of each coordinate.
struct NormalImage {
  PaddedImage x, y, z;

  void resize(std::uint32_t width, std::uint32_t height);
  void set(int u, int v, Vec3f normal);
};

// What `inverse` must have around it.
inline constexpr int kSettledMargin =
    kSettledAcross > kSettledRadius ? kSettledAcross : kSettledRadius;

// `inverse`: without holes that are to be closed. `settled` and `normals` take what queries read;
// no new memory where they had this size. The same bits for any number of threads.
void settle(const PaddedImage& inverse, const NormalImage& seen, PaddedImage& settled,
            std::vector<Vec3f>& normals);

// The normals as they were estimated, in the same form; and the image by pixel.
void take_normals(const NormalImage& seen, std::vector<Vec3f>& normals);
void take_pixels(const PaddedImage& image, std::vector<float>& pixels);

}  // namespace vpm
