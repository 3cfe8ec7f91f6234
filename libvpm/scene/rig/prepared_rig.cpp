#include "libvpm/scene/rig/prepared_rig.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/frame_slot.h"

namespace vpm {
namespace {

// Returns what orders cameras, and is equal for none that differ but in their images.
auto key_of(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  const auto numbers = [](Vec3 v) { return std::tuple(v.x, v.y, v.z); };
  const Pose& pose = camera.to_world;
  return std::tuple(numbers(pose.translation), numbers(pose.rotation.row0),
                    numbers(pose.rotation.row1), numbers(pose.rotation.row2), k.fx, k.fy, k.cx,
                    k.cy, camera.width, camera.height);
}

// Orders images of equal cameras by their pixels.
int compare_pixels(const DepthSurface& one, const DepthSurface& other) {
  const std::int32_t pixels = one.width * one.height;
  for (std::int32_t i = 0; i < pixels; ++i) {
    const auto key = [i](const DepthSurface& image) {
      const Vec3f n = image.normals[i];
      // Compares depths by their bits: -0 stands for a removed pixel, 0 for a hole.
      return std::tuple(std::bit_cast<std::uint32_t>(image.measured[i]), image.tiles[0][i].high,
                        n.x, n.y, n.z);
    };
    if (key(one) < key(other)) return -1;
    if (key(other) < key(one)) return 1;
  }
  return 0;
}

int compare(const DepthBody& a, const DepthBody& b) {
  const auto one = key_of(a.camera()), other = key_of(b.camera());
  return one < other ? -1 : other < one ? 1 : compare_pixels(a.surface(), b.surface());
}

}  // namespace

std::vector<DepthBody> different_images(std::vector<DepthBody> images) {
  std::sort(images.begin(), images.end(),
            [](const DepthBody& a, const DepthBody& b) { return compare(a, b) < 0; });
  images.erase(
      std::unique(images.begin(), images.end(),
                  [](const DepthBody& a, const DepthBody& b) { return compare(a, b) == 0; }),
      images.end());
  return images;
}

template <class Body>
void PreparedRig::for_each_image(const Body& body) const {
  parallel_for(images_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(images_[i]);
  });
}

PreparedRig::PreparedRig(std::vector<DepthBody> images)
    : images_(different_images(std::move(images))) {
  if (images_.empty()) throw Error(ErrorKind::invalid_argument, "a rig needs a camera");
  constexpr auto kMost = static_cast<std::size_t>(RigSurface::kMostCameras);
  if (images_.size() > kMost)
    throw Error(ErrorKind::invalid_argument,
                "there are " + std::to_string(images_.size()) + " depth images, but " +
                    std::to_string(kMost) + " cameras at most are one body",
                {}, "leave out those that show least");
  for_each_image([](const DepthBody& image) { image.silhouettes(); });
  place_cameras();
  agreement_ = agreement_of(cameras_);
  const auto is_of_device = [](const DepthBody& image) {
    return image.slot() != nullptr && image.slot()->options().device.is_cuda();
  };
  if (std::ranges::any_of(images_, is_of_device)) return;  // the host spreads when it asks
  for_each_image([](const DepthBody& image) { image.spread_silhouettes(); });
  spread_cameras();
}

void PreparedRig::place_cameras() {
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const Pose to_rig = relative_to(to_world(), images_[i].to_world());
    cameras_.push_back({images_[i].surface(), {}, inverse(to_rig), to_rig});
  }
}

const std::vector<RigCamera>& PreparedRig::spread_cameras() const {
  std::call_once(spread_->once, [&] {
    const OneThread alone;  // which takes no other task meanwhile: it might ask for these, too
    spread_->all = cameras_;
    for (std::size_t i = 0; i < images_.size(); ++i)
      spread_->all[i].silhouettes = images_[i].spread_silhouettes().view();
  });
  return spread_->all;
}

std::size_t PreparedRig::point_count() const {
  return std::accumulate(
      images_.begin(), images_.end(), std::size_t{0},
      [](std::size_t sum, const DepthBody& body) { return sum + body.points(); });
}

std::size_t PreparedRig::most_ranges() const {
  return std::accumulate(
      images_.begin(), images_.end(), std::size_t{0},
      [](std::size_t sum, const DepthBody& body) { return sum + body.camera().height; });
}

const PreparedRig::Points& PreparedRig::points() const {
  std::call_once(points_->once, [&] {
    for (const DepthBody& body : images_) {
      const PreparedImage& image = body.prepared();
      const Vec3 offset = image.origin() - origin();
      for (const Vec3f& place : image.positions())
        points_->positions.push_back(narrow(widen(place) + offset));
      points_->normals.insert(points_->normals.end(), image.normals().begin(),
                              image.normals().end());
    }
  });
  return *points_;
}

}  // namespace vpm
