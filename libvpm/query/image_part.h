// What a query at one pose reads of an image, so that a device need not make the rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "libvpm/query/depth_surface.h"

namespace vpm {

// The balls of a tool that are looked at, by their size, since a look takes tiles as large as its
// ball: none of them is larger than `radius`, nor reaches further from the centre of mass.
struct LooksOfSize {
  double radius = 0, reach = 0;
};

// Sizes by powers of two.
class LookSizes {
 public:
  // A ball, its centre about the centre of mass.
  void add(Vec3 center, double radius) {
    if (!(radius > 0)) return;
    const int exponent = std::ilogb(radius);
    const auto known = std::find_if(sizes_.begin(), sizes_.end(), [&](const LooksOfSize& size) {
      return std::ilogb(size.radius) == exponent;
    });
    LooksOfSize& size = known != sizes_.end() ? *known : sizes_.emplace_back();
    size.radius = std::max(size.radius, radius);
    size.reach = std::max(size.reach, norm(center) + radius);
  }
  std::span<const LooksOfSize> all() const { return sizes_; }

 private:
  std::vector<LooksOfSize> sizes_;
};

namespace image_part {

inline PixelRectangle united(const PixelRectangle& a, const PixelRectangle& b) {
  return {std::min(a.u0, b.u0), std::min(a.v0, b.v0), std::max(a.u1, b.u1), std::max(a.v1, b.v1)};
}

// With a margin, to whole tiles of so many pixels.
inline PixelRectangle widened(const PixelRectangle& p, int margin, int tile,
                              const DepthSurface& image) {
  const auto down = [&](std::int32_t first) { return std::max(first - margin, 0) / tile * tile; };
  const auto up = [&](std::int32_t last, std::int32_t size) {
    return std::min((std::min(last + margin, size) / tile + 1) * tile, size) - 1;
  };
  return {down(p.u0), down(p.v0), up(p.u1, image.width), up(p.v1, image.height)};
}

}  // namespace image_part

// For looks and readings at places in a tool whose centre of mass lies at `center` (camera
// coordinates); every place in `reach` of it is among them. Looks at balls that leave that, and the
// search for the nearest place, may lead out of the part: DepthSurface::beyond tells.
inline PixelRectangle part_read(const DepthSurface& image, Vec3 center, double reach,
                                std::span<const LooksOfSize> looks) {
  const auto pixels = [&](double radius) {
    return rectangle_of_ball(image.k, image.width, image.height, center, radius);
  };
  const PixelRectangle tool = pixels(reach);
  if (tool.u0 > tool.u1 || tool.v0 > tool.v1) return {};
  const PixelRectangle all{0, 0, image.width - 1, image.height - 1};
  if (!(center.z - reach > 0)) return all;
  PixelRectangle part = image_part::widened(tool, DepthSurface::kAcross + 1, 1, image);
  for (const LooksOfSize& look : looks) {
    const double nearest = center.z - look.reach;
    if (!(nearest > 0)) return all;
    const double slope =
        (std::max(std::fabs(center.x), std::fabs(center.y)) + look.reach) / nearest;
    // Of look_at_ball(): its pixels to either side, of which some lie beside the ball's own. Of
    // these it takes tiles no wider than all of them.
    const double aside = std::max(image.k.fx, image.k.fy) * (look.radius / nearest);
    const double across = 2 * aside * (1 + slope) + 2;
    if (!(across < std::max(image.width, image.height))) return all;
    int tile = 1;
    while (2 * tile <= across) tile *= 2;
    const int margin = static_cast<int>(2 * aside * slope) + 1;
    part = image_part::united(part, image_part::widened(pixels(look.reach), margin, tile, image));
  }
  return part;
}

}  // namespace vpm
