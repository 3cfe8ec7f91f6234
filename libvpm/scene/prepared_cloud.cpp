#include "libvpm/scene/prepared_cloud.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <tuple>

#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/scene/depth/denoised_image.h"
#include "libvpm/scene/points/point_tree.h"

namespace vpm {
namespace {

// Returns 0 for -0, so that both sort and merge as one place.
float positive_zero(float x) {
  return x == 0 ? 0.0f : x;
}

auto order_key(const Cloud& cloud, std::uint32_t i) {
  const Vec3f p = cloud.positions[i], n = cloud.normals[i];
  return std::make_tuple(positive_zero(p.x), positive_zero(p.y), positive_zero(p.z),
                         positive_zero(n.x), positive_zero(n.y), positive_zero(n.z),
                         cloud.radii[i]);
}

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

bool is_usual(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  const double x = std::max(std::abs(k.cx), std::abs(camera.width - 1 - k.cx)) / k.fx;
  const double y = std::max(std::abs(k.cy), std::abs(camera.height - 1 - k.cy)) / k.fy;
  const double longest = std::sqrt(x * x + y * y + 1);
  constexpr double kLongest = 0x1p10, kWidestPixel = 0x1p10, kError = 0x1p-21;
  return std::size_t{camera.width} * camera.height <= PreparedCloud::kMaxPoints &&
         std::max(camera.width, camera.height) <= DepthSurface::kMostPixelsASide &&
         longest <= kLongest && 1 / k.fx <= kWidestPixel && 1 / k.fy <= kWidestPixel &&
         std::max(k.fx, k.fy) * kError * longest * (longest + 1) <= kPixelTolerance / 2;
}

std::uint64_t PreparedCloud::next_serial() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

PreparedCloud::PreparedCloud(const Cloud& cloud, Denoising points)
    : serial_(next_serial()), origin_(cloud.origin) {
  if (cloud.size() > kMaxPoints) {
    refuse("the cloud has " + std::to_string(cloud.size()) + " points", {},
           "at most " + std::to_string(kMaxPoints) +
               " can be counted exactly: thin it out, or split it");
  }
  validate(cloud, "the cloud");
  check_extent(cloud);
  if (cloud.sensor) {
    take_image(cloud, points);
  } else {
    std::vector<float> radii = order_in_space(cloud);
    boxes_ = boxes_of(positions_);
    const DiskSurface measured{point_tree(), normals_.data()};
    if (points == Denoising::on) {
      disks_ = settle(measured, std::move(radii));
      foot_boxes_ = boxes_of(disks_.feet);
    } else {
      disks_ = off(measured, std::move(radii));
    }
    largest_radii_ = largest_in_nodes(disks_.radii);
    cones_ = cones_of(disk_surface());
  }
}

void PreparedCloud::take_image(const Cloud& cloud, Denoising points) {
  camera_ = cloud.sensor->camera;
  const DepthImage& depth = cloud.sensor->depth;
  ImageSteps steps;
  steps.resize(depth.width, depth.height);
  order_by_pixel(cloud, steps.seen());
  const auto take = [&](int begin, int end) {
    take_inverse_depth(depth, begin, end, steps.seen().inverse);
  };
  const auto find = [](int begin, int end, const auto& made) {
    for (int v = begin; v < end; ++v) made(v);
  };
  steps.make(points, take, find, image_);
}

void PreparedCloud::order_by_pixel(const Cloud& cloud, SeenImage& seen) {
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
  take_in_order(cloud, order);

  const Pose to_camera = relative_to(camera_->to_world, {{}, origin_});
  const Intrinsics& k = camera_->intrinsics;
  const std::size_t pixels = std::size_t{camera_->width} * camera_->height;
  pixel_begin_.assign(pixels + 1, 0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::uint32_t pixel = cloud.pixels[order[i]];
    const std::uint32_t u = pixel % camera_->width, v = pixel / camera_->width;
    const auto name = [&] { return std::to_string(u) + "," + std::to_string(v); };
    if (i > 0 && pixel == cloud.pixels[order[i - 1]])
      refuse("the cloud has two different points at pixel " + name());
    const Vec3 at = to_camera * widen(positions_[i]);
    if (!(at.z > 0 && std::abs(k.fx * at.x / at.z + k.cx - u) <= kPixelTolerance &&
          std::abs(k.fy * at.y / at.z + k.cy - v) <= kPixelTolerance)) {
      refuse("point " + std::to_string(order[i]) +
             " of the cloud does not lie on the ray of its pixel " + name());
    }
    pixel_begin_[pixel + 1] = 1;
    seen.set_normal(static_cast<int>(u), static_cast<int>(v),
                    narrow(to_camera.rotation * widen(normals_[i])));
  }
  std::partial_sum(pixel_begin_.begin(), pixel_begin_.end(), pixel_begin_.begin());
}

std::vector<float> PreparedCloud::order_in_space(const Cloud& cloud) {
  struct Placed {  // side by side, for the cache
    Vec3f at;
    std::uint32_t index;
  };
  std::vector<Placed> placed;
  placed.reserve(cloud.size());
  for (std::uint32_t i = 0; i < cloud.size(); ++i) placed.push_back({cloud.positions[i], i});
  std::sort(placed.begin(), placed.end(), [&](const Placed& a, const Placed& b) {
    if (a.at.x != b.at.x) return a.at.x < b.at.x;
    if (a.at.y != b.at.y) return a.at.y < b.at.y;
    if (a.at.z != b.at.z) return a.at.z < b.at.z;
    return order_key(cloud, a.index) < order_key(cloud, b.index);
  });
  std::vector<std::uint32_t> order;
  order.reserve(placed.size());
  for (const Placed& p : placed) {
    if (order.empty() || order_key(cloud, p.index) != order_key(cloud, order.back()))
      order.push_back(p.index);
  }
  order_by_leaves(cloud.positions, order);
  take_in_order(cloud, order);
  std::vector<float> radii;
  radii.reserve(order.size());
  for (const std::uint32_t i : order) radii.push_back(cloud.radii[i]);
  return radii;
}

void PreparedCloud::take_in_order(const Cloud& cloud, const std::vector<std::uint32_t>& order) {
  positions_.reserve(order.size());
  normals_.reserve(order.size());
  for (const std::uint32_t i : order) {
    positions_.push_back(cloud.positions[i]);
    normals_.push_back(cloud.normals[i]);
  }
}

PointTree PreparedCloud::point_tree() const {
  static_assert(kMaxPoints <= std::size_t{PointTree::kMostLeaves} * PointTree::kLeafSize);
  return {positions_.data(), boxes_.data(), static_cast<std::uint32_t>(positions_.size()),
          leaves_for(positions_.size())};
}

DiskSurface PreparedCloud::disk_surface() const {
  PointTree feet = point_tree();
  feet.points = disks_.feet.data();
  if (!foot_boxes_.empty()) feet.boxes = foot_boxes_.data();
  return {feet,
          disks_.normals.data(),
          disks_.second_of.data(),
          disks_.seconds.data(),
          {disks_.radii.data(), largest_radii_.data()},
          {cones_.data()}};
}

}  // namespace vpm
