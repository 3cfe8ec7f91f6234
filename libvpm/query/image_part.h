// What a query at one pose reads of an image, so that a device need not make the rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "libvpm/surface/depth_surface.h"

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
    const auto known = std::find(exponents_.begin(), exponents_.end(), exponent);
    const auto k = static_cast<std::size_t>(known - exponents_.begin());
    if (known == exponents_.end()) exponents_.push_back(exponent), sizes_.emplace_back();
    LooksOfSize& size = sizes_[k];
    size.radius = std::max(size.radius, radius);
    size.reach = std::max(size.reach, norm(center) + radius);
  }
  // But for those that another one outdoes in both: what it reads holds what they read.
  std::vector<LooksOfSize> largest() const {
    std::vector<LooksOfSize> sorted = sizes_, kept;
    std::sort(sorted.begin(), sorted.end(), [](const LooksOfSize& a, const LooksOfSize& b) {
      return a.radius != b.radius ? a.radius > b.radius : a.reach > b.reach;
    });
    for (const LooksOfSize& size : sorted)
      if (kept.empty() || size.reach > kept.back().reach) kept.push_back(size);
    return kept;
  }

 private:
  std::vector<int> exponents_;  // of the radii
  std::vector<LooksOfSize> sizes_;
};

// For looks and readings at places in a tool whose centre of mass lies at `center` (camera
// coordinates); every place in `reach` of it is among them. Looks at balls that leave that, and the
// search for the nearest place, may lead out of the part: DepthSurface::beyond tells.
inline PixelRectangle part_read(const DepthSurface& image, Vec3 center, double reach,
                                std::span<const LooksOfSize> looks) {
  const auto pixels = [&](double radius) {
    return rectangle_of_ball(image.k, image.width, image.height, center, radius);
  };
  const PixelRectangle tool = pixels(reach);
  if (is_empty(tool)) return {};
  const PixelRectangle all = whole_image(image.width, image.height);
  if (!(center.z - reach > 0)) return all;
  const auto with_margin = [&](const PixelRectangle& r, int margin, int tile) {
    return widened(r, margin, tile, tile, image.width, image.height);
  };
  PixelRectangle part = with_margin(tool, DepthSurface::kAcross + 1, 1);
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
    part = united(part, with_margin(pixels(look.reach), margin, tile));
  }
  return part;
}

}  // namespace vpm
