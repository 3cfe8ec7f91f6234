#include <algorithm>
#include <map>
#include <mutex>

#include "libvpm/device/cuda/runtime.h"
#include "libvpm/scene/cuda/device_cloud.h"

namespace vpm::cuda {

namespace {

std::size_t pixels_of(const DepthSurface& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}
std::size_t tile_count(const DepthSurface& image, int level) {
  return static_cast<std::size_t>(((image.height - 1) >> level) + 1) *
         static_cast<std::size_t>(image.tiles_per_row(level));
}

}  // namespace

DeviceCloud::DeviceCloud(const PreparedCloud& cloud) {
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
  const std::size_t pixels = pixels_of(image);
  std::size_t tiles = 0;
  for (int level = 0; level < image.levels; ++level) tiles += tile_count(image, level);
  set_image(image, {memory_.room<Vec3f>(pixels), memory_.room<float>(pixels)},
            memory_.room<InverseDepthRange>(tiles));
  stand_at(camera.to_world);
}

void DeviceCloud::stand_at(const Pose& camera_to_world) {
  to_world_ = camera_to_world;
}

void DeviceCloud::set_image(const DepthSurface& image, const CloudRoom& room,
                            InverseDepthRange* tiles) {
  depth_ = image;
  room_ = room;
  room_.levels = image.levels;
  for (int level = 0; level < image.levels; ++level) {
    depth_.tiles[level] = room_.tiles[level] = tiles;
    tiles += tile_count(image, level);
  }
  depth_.normals = room.pixel_normals;
  depth_.measured = room.measured;
  is_organised_ = true;
}

void DeviceCloud::copy_image(const PreparedCloud& cloud) {
  const DepthSurface image = cloud.depth_surface();
  const std::size_t pixels = pixels_of(image);
  std::vector<InverseDepthRange> tiles;
  for (int level = 0; level < image.levels; ++level)
    tiles.insert(tiles.end(), image.tiles[level], image.tiles[level] + tile_count(image, level));
  set_image(image, {memory_.copy(image.normals, pixels), memory_.copy(image.measured, pixels)},
            memory_.copy(tiles));
  to_world_ = cloud.camera_to_world();
}

void DeviceCloud::copy_points(const PreparedCloud& cloud) {
  const auto copy_tree = [&](PointTree tree, const Vec3f* points) {
    tree.points = points;
    tree.boxes = memory_.copy(tree.boxes, tree.quads());
    return tree;
  };
  to_world_ = {{}, cloud.origin()};
  const DenoisedDisks& denoised = cloud.disks();
  disks_ = cloud.disk_surface();
  disks_.cones.quads = memory_.copy(disks_.cones.quads, disks_.feet.quads());
  disks_.radii = {memory_.copy(disks_.radii.of_points, disks_.feet.count),
                  memory_.copy(disks_.radii.of_nodes, disks_.feet.nodes())};
  disks_.feet = copy_tree(disks_.feet, memory_.copy(denoised.feet));
  disks_.normals = memory_.copy(denoised.normals);
  disks_.second_of = memory_.copy(denoised.second_of);
  disks_.seconds = memory_.copy(denoised.seconds);
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
