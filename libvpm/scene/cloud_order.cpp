#include "libvpm/scene/cloud_order.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/scene/depth/depth_surface.h"

namespace vpm {
namespace {

// Checks the limits that validate() leaves to the code that computes with a cloud.
void check_extent(const Cloud& cloud) {
  if (!is_in_range(cloud.origin) ||
      (cloud.sensor && !is_in_range(cloud.sensor->camera.to_world.translation)))
    refuse("the cloud's origin or its camera is further than 2^100 m from the world's origin");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!is_in_range(widen(cloud.positions[i])))
      refuse("point " + std::to_string(i) +
             " of the cloud is further than 2^100 m from its origin");
  }
  constexpr std::uint64_t kMaxPixels = std::numeric_limits<std::int32_t>::max();
  if (!cloud.sensor) return;
  const auto& [intrinsics, width, height, to_world] = cloud.sensor->camera;
  if (std::uint64_t{width} * height > kMaxPixels)
    refuse("the cloud's image has more than 2^31 - 1 pixels", {},
           "crop it, or take every second one");
  if (std::max(width, height) > DepthSurface::kMostPixelsASide)
    refuse("the cloud's image is more than 65536 pixels wide or high", {}, "crop it");
}

}  // namespace

void check_for_queries(const Cloud& cloud) {
  if (cloud.size() > kMaxPoints) {
    refuse("the cloud has " + std::to_string(cloud.size()) + " points", {},
           "at most " + std::to_string(kMaxPoints) +
               " can be counted exactly: thin it out, or split it");
  }
  validate(cloud, "the cloud");
  check_extent(cloud);
}

OrderedPoints::OrderedPoints(const Cloud& cloud, const std::vector<std::uint32_t>& order)
    : origin(cloud.origin) {
  positions.reserve(order.size());
  normals.reserve(order.size());
  for (const std::uint32_t i : order) {
    positions.push_back(cloud.positions[i]);
    normals.push_back(cloud.normals[i]);
  }
}

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace vpm
