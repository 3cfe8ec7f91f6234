#include "libvpm/scene/depth/prepared_image.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <string>

#include "libvpm/core/error.h"

namespace vpm {

bool is_usual(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  const double x = std::max(std::abs(k.cx), std::abs(camera.width - 1 - k.cx)) / k.fx;
  const double y = std::max(std::abs(k.cy), std::abs(camera.height - 1 - k.cy)) / k.fy;
  const double longest = std::sqrt(x * x + y * y + 1);
  constexpr double kLongest = 0x1p10, kWidestPixel = 0x1p10, kError = 0x1p-21;
  return std::size_t{camera.width} * camera.height <= kMaxPoints &&
         std::max(camera.width, camera.height) <= DepthSurface::kMostPixelsASide &&
         longest <= kLongest && 1 / k.fx <= kWidestPixel && 1 / k.fy <= kWidestPixel &&
         std::max(k.fx, k.fy) * kError * longest * (longest + 1) <= kPixelTolerance / 2;
}

PreparedImage::PreparedImage(const Cloud& cloud, Denoising points) : camera_(cloud.sensor->camera) {
  check_for_queries(cloud);
  const DepthImage& depth = cloud.sensor->depth;
  ImageSteps steps;
  steps.resize(depth.width, depth.height);
  order_by_pixel(cloud, steps.seen());
  const auto take = [&](int begin, int end) {
    take_inverse_depth(depth, begin, end, steps.seen().inverse);
    steps.seen().take_removed(depth, begin, end);
  };
  const auto find = [](int begin, int end, const auto& made) {
    for (int v = begin; v < end; ++v) made(v);
  };
  steps.make(points, take, find, image_);
}

void PreparedImage::order_by_pixel(const Cloud& cloud, SeenImage& seen) {
  std::vector<std::uint32_t> order(cloud.size());
  std::iota(order.begin(), order.end(), 0u);
  if (!std::is_sorted(cloud.pixels.begin(), cloud.pixels.end(), std::less_equal<>())) {
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      if (cloud.pixels[a] != cloud.pixels[b]) return cloud.pixels[a] < cloud.pixels[b];
      return order_key(cloud, a) < order_key(cloud, b);
    });
    order.erase(std::unique(order.begin(), order.end(),
                            [&](std::uint32_t a, std::uint32_t b) {
                              return cloud.pixels[a] == cloud.pixels[b] &&
                                     order_key(cloud, a) == order_key(cloud, b);
                            }),
                order.end());
  }
  points_ = OrderedPoints(cloud, order);

  const Pose to_camera = relative_to(camera_.to_world, {{}, origin()});
  const Intrinsics& k = camera_.intrinsics;
  const std::size_t pixels = std::size_t{camera_.width} * camera_.height;
  pixel_begin_.assign(pixels + 1, 0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t pixel = cloud.pixels[order[i]];
    const std::uint32_t u = pixel % camera_.width, v = pixel / camera_.width;
    const auto name = [&] { return std::to_string(u) + "," + std::to_string(v); };
    if (i > 0 && pixel == cloud.pixels[order[i - 1]])
      refuse("the cloud has two different points at pixel " + name());
    const Vec3 at = to_camera * widen(positions()[i]);
    if (!(at.z > 0 && std::abs(k.fx * at.x / at.z + k.cx - u) <= kPixelTolerance &&
          std::abs(k.fy * at.y / at.z + k.cy - v) <= kPixelTolerance)) {
      refuse("point " + std::to_string(order[i]) +
             " of the cloud does not lie on the ray of its pixel " + name());
    }
    pixel_begin_[pixel + 1] = 1;
    seen.set_normal(static_cast<int>(u), static_cast<int>(v),
                    narrow(to_camera.rotation * widen(normals()[i])));
  }
  std::partial_sum(pixel_begin_.begin(), pixel_begin_.end(), pixel_begin_.begin());
}

}  // namespace vpm
