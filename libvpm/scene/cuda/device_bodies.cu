#include <algorithm>

#include "libvpm/scene/cuda/device_bodies.h"

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

DeviceDepthBody::DeviceDepthBody(const PreparedImage& image) {
  const DepthSurface surface = image.surface();
  const std::size_t pixels = pixels_of(surface);
  std::vector<InverseDepthRange> tiles;
  for (int level = 0; level < surface.levels; ++level)
    tiles.insert(tiles.end(), surface.tiles[level],
                 surface.tiles[level] + tile_count(surface, level));
  set(surface, {memory_.copy(surface.normals, pixels), memory_.copy(surface.measured, pixels)},
      memory_.copy(tiles));
}

DeviceDepthBody::DeviceDepthBody(const Camera& camera) {
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
  set(image, {memory_.room<Vec3f>(pixels), memory_.room<float>(pixels)},
      memory_.room<InverseDepthRange>(tiles));
}

void DeviceDepthBody::set(const DepthSurface& image, const ImageRoom& room,
                          InverseDepthRange* tiles) {
  surface_ = image;
  room_ = room;
  room_.levels = image.levels;
  for (int level = 0; level < image.levels; ++level) {
    surface_.tiles[level] = room_.tiles[level] = tiles;
    tiles += tile_count(image, level);
  }
  surface_.normals = room.normals;
  surface_.measured = room.measured;
}

DevicePointsBody::DevicePointsBody(const PreparedPoints& points) : surface_(points.surface()) {
  const DenoisedDisks& denoised = points.disks();
  PointTree& feet = surface_.feet;
  surface_.cones.quads = memory_.copy(surface_.cones.quads, feet.quads());
  surface_.radii = {memory_.copy(surface_.radii.of_points, feet.count),
                    memory_.copy(surface_.radii.of_nodes, feet.nodes())};
  feet.points = memory_.copy(denoised.feet);
  feet.boxes = memory_.copy(feet.boxes, feet.quads());
  surface_.normals = memory_.copy(denoised.normals);
  surface_.second_of = memory_.copy(denoised.second_of);
  surface_.seconds = memory_.copy(denoised.seconds);
  surface_.winding.disks = memory_.copy(points.dipoles().disks());
  surface_.winding.nodes = memory_.copy(points.dipoles().nodes());
  surface_.measured = nullptr;
}

DeviceRigBody::DeviceRigBody(const PreparedRig& rig) : surface_(rig.surface()) {
  const auto count = static_cast<std::size_t>(surface_.count);
  std::vector<RigCamera> cameras(surface_.cameras, surface_.cameras + count);
  images_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const ImageSilhouettes& found = rig.images()[i].silhouettes();
    cameras[i].image = images_.emplace_back(rig.images()[i].prepared()).surface();
    cameras[i].silhouettes = {memory_.copy(found.pixels()),
                              memory_.copy(found.nearest()),
                              memory_.copy(found.sums()),
                              cameras[i].silhouettes.columns,
                              {}};
    if (!found.holes().fits().empty())
      cameras[i].silhouettes.holes = {
          memory_.copy(found.holes().fits()), memory_.copy(found.holes().numbers()),
          memory_.copy(found.holes().greatest()), found.holes().view().columns};
  }
  surface_.cameras = memory_.copy(cameras);
  surface_.agreement = memory_.copy(rig.agreement().of_pairs);
}

}  // namespace vpm::cuda
