#include <algorithm>
#include <cmath>
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
  const std::size_t pixels = pixels_of(image);
  std::size_t tiles = 0;
  for (int level = 0; level < image.levels; ++level) tiles += tile_count(image, level);
  set_image(image,
            {memory_.room<Vec3f>(pixels), memory_.room<Vec3f>(pixels), memory_.room<Vec3f>(pixels),
             memory_.room<float>(pixels)},
            memory_.room<InverseDepthRange>(tiles));
  stand_at(camera.to_world);
}

void DeviceCloud::stand_at(const Pose& camera_to_world) {
  frame_.origin = camera_to_world.translation;
  frame_.camera_to_world = camera_to_world;
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
  frame_.is_organised = true;
  frame_.intrinsics = image.k;
  frame_.width = image.width;
  frame_.height = image.height;
  points_ = {room.positions, room.normals, static_cast<std::uint32_t>(pixels_of(image)),
             image.width, nullptr};
}

void DeviceCloud::copy_image(const PreparedCloud& cloud) {
  const DepthSurface image = cloud.depth_surface();
  const std::vector<std::uint32_t>& begin = cloud.pixel_begin();
  const std::size_t pixels = begin.size() - 1;
  const float nowhere = std::nanf("");
  std::vector<Vec3f> positions(pixels, Vec3f{nowhere, nowhere, nowhere}), normals(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    if (begin[p] == begin[p + 1]) continue;
    positions[p] = cloud.positions()[begin[p]];
    normals[p] = cloud.normals()[begin[p]];
  }
  std::vector<InverseDepthRange> tiles;
  for (int level = 0; level < image.levels; ++level)
    tiles.insert(tiles.end(), image.tiles[level], image.tiles[level] + tile_count(image, level));
  set_image(image,
            {memory_.copy(positions), memory_.copy(normals), memory_.copy(image.normals, pixels),
             memory_.copy(image.measured, pixels)},
            memory_.copy(tiles));
  frame_.camera_to_world = cloud.camera_to_world();
}

void DeviceCloud::copy_points(const PreparedCloud& cloud) {
  const auto copy_tree = [&](PointTree tree, const Vec3f* points) {
    tree.points = points;
    tree.boxes = memory_.copy(tree.boxes, tree.quads());
    return tree;
  };
  const Vec3f* const positions = memory_.copy(cloud.positions());
  const PointTree tree = copy_tree(cloud.point_tree(), positions);
  points_ = {positions, memory_.copy(cloud.normals()), tree.count, 0, tree};
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
