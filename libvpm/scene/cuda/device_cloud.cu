#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

#include "libvpm/device/cuda/runtime.h"
#include "libvpm/scene/cuda/device_cloud.h"

namespace vpm::cuda {

DeviceCloud::DeviceCloud(const PreparedCloud& cloud) {
  frame_.is_organised = cloud.is_organised();
  frame_.origin = cloud.origin();
  if (cloud.is_organised())
    copy_image(cloud);
  else
    copy_points(cloud);
}

DeviceCloud::DeviceCloud(const Camera& camera) {
  DepthSurface image;
  image.k = camera.intrinsics;
  image.width = static_cast<std::int32_t>(camera.width);
  image.height = static_cast<std::int32_t>(camera.height);
  image.levels = 1;
  while (image.levels < DepthSurface::kMaxLevels &&
         ((std::max(image.width, image.height) - 1) >> (image.levels - 1)) > 0)
    ++image.levels;
  frame_.is_organised = true;
  make_room(image);
  stand_at(camera.to_world);
}

std::uint64_t DeviceCloud::next_serial() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

void DeviceCloud::stand_at(const Pose& camera_to_world) {
  frame_.origin = camera_to_world.translation;
  frame_.camera_to_world = camera_to_world;
}

CloudRoom DeviceCloud::room() const {
  CloudRoom room{positions_.get(), normals_.get(), pixel_normals_.get(), measured_.get(), {},
                 depth_.levels};
  for (int level = 0; level < depth_.levels; ++level)
    room.tiles[level] = tiles_.get() + tile_begin_[level];
  return room;
}

void DeviceCloud::make_room(const DepthSurface& image) {
  depth_ = image;
  frame_.intrinsics = depth_.k;
  frame_.width = depth_.width;
  frame_.height = depth_.height;
  const auto pixels =
      static_cast<std::size_t>(depth_.width) * static_cast<std::size_t>(depth_.height);
  positions_ = DeviceArray<Vec3f>(pixels);
  normals_ = DeviceArray<Vec3f>(pixels);
  pixel_normals_ = DeviceArray<Vec3f>(pixels);
  measured_ = DeviceArray<float>(pixels);
  points_ = {positions_.get(), normals_.get(), static_cast<std::uint32_t>(pixels), depth_.width,
             nullptr};
  std::size_t count = 0;
  for (int level = 0; level < depth_.levels; ++level) {
    tile_begin_[level] = count;
    count += tile_count(level);
  }
  tiles_ = DeviceArray<InverseDepthRange>(count);
  depth_.normals = pixel_normals_.get();
  depth_.measured = measured_.get();
  for (int level = 0; level < depth_.levels; ++level)
    depth_.tiles[level] = tiles_.get() + tile_begin_[level];
}

std::size_t DeviceCloud::tile_count(int level) const {
  const auto rows = static_cast<std::size_t>(((depth_.height - 1) >> level) + 1);
  return rows * static_cast<std::size_t>(depth_.tiles_per_row(level));
}

void DeviceCloud::copy_image(const PreparedCloud& cloud) {
  const DepthSurface image = cloud.depth_surface();
  make_room(image);
  stand_at(cloud.camera_to_world());
  frame_.origin = cloud.origin();

  const std::vector<std::uint32_t>& begin = cloud.pixel_begin();
  const std::size_t pixels = begin.size() - 1;
  const float nowhere = std::nanf("");
  std::vector<Vec3f> positions(pixels, Vec3f{nowhere, nowhere, nowhere}), normals(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    if (begin[p] == begin[p + 1]) continue;
    positions[p] = cloud.positions()[begin[p]];
    normals[p] = cloud.normals()[begin[p]];
  }
  positions_.fill(positions.data());
  normals_.fill(normals.data());
  pixel_normals_.fill(image.normals);
  measured_.fill(image.measured);
  std::vector<InverseDepthRange> tiles;
  for (int level = 0; level < image.levels; ++level)
    tiles.insert(tiles.end(), image.tiles[level], image.tiles[level] + tile_count(level));
  tiles_.fill(tiles.data());
}

void DeviceCloud::copy_points(const PreparedCloud& cloud) {
  const auto copy_tree = [](PointTree tree, const DeviceArray<Vec3f>& points,
                            DeviceArray<BoxQuad>& boxes) {
    boxes = DeviceArray<BoxQuad>(tree.boxes, tree.quads());
    tree.points = points.get();
    tree.boxes = boxes.get();
    return tree;
  };
  positions_ = DeviceArray<Vec3f>(cloud.positions());
  normals_ = DeviceArray<Vec3f>(cloud.normals());
  const PointTree tree = copy_tree(cloud.point_tree(), positions_, boxes_);
  points_ = {positions_.get(), normals_.get(), tree.count, 0, tree};
  disks_ = cloud.disk_surface();
  const DenoisedDisks& denoised = cloud.disks();
  feet_ = DeviceArray<Vec3f>(denoised.feet);
  disk_normals_ = DeviceArray<Vec3f>(denoised.normals);
  second_of_ = DeviceArray<std::uint32_t>(denoised.second_of);
  seconds_ = DeviceArray<SecondPlane>(denoised.seconds);
  cones_ = DeviceArray<ConeQuad>(disks_.cones.quads, disks_.feet.quads());
  radii_ = DeviceArray<float>(disks_.radii.of_points, disks_.feet.count);
  largest_radii_ = DeviceArray<float>(disks_.radii.of_nodes, disks_.feet.nodes());
  disks_.feet = copy_tree(disks_.feet, feet_, foot_boxes_);
  disks_.normals = disk_normals_.get();
  disks_.second_of = second_of_.get();
  disks_.seconds = seconds_.get();
  disks_.cones.quads = cones_.get();
  disks_.radii = {radii_.get(), largest_radii_.get()};
}

std::shared_ptr<const DeviceCloud> on_device(const PreparedCloud& cloud) {
  static std::mutex mutex;
  static std::map<std::pair<int, std::uint64_t>, std::weak_ptr<const DeviceCloud>> copies;
  const std::lock_guard lock(mutex);
  std::erase_if(copies, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const DeviceCloud>& known = copies[{current_device(), cloud.serial()}];
  std::shared_ptr<const DeviceCloud> copy = known.lock();
  if (!copy) known = copy = std::make_shared<const DeviceCloud>(cloud);
  return copy;
}

}  // namespace vpm::cuda
