#include <algorithm>

#include "libvpm/scene/cuda/cloud_slot.h"
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

// Returns the number of tiles of all levels.
std::size_t tile_count(const DepthSurface& image) {
  std::size_t tiles = 0;
  for (int level = 0; level < image.levels; ++level) tiles += tile_count(image, level);
  return tiles;
}

// Returns the image where its preparation has left it on the current device, else null.
const DeviceDepthBody* made_here(const DepthBody& image) {
  const auto* const slot = dynamic_cast<const CloudSlot*>(image.slot());
  const bool is_here = slot != nullptr && slot->options().device.first() == current_device();
  return is_here && slot->is_on_device() && slot->is_sound() ? &slot->body() : nullptr;
}

}  // namespace

DeviceDepthBody::DeviceDepthBody(const DepthSurface& surface) {
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
  set(image, {memory_.room<Vec3f>(pixels), memory_.room<float>(pixels)},
      memory_.room<InverseDepthRange>(tile_count(image)));
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

FetchedImage::FetchedImage(const DeviceDepthBody& image)
    : image_(image.surface()),
      normals_(pixels_of(image_)),
      measured_(pixels_of(image_)),
      tiles_(tile_count(image_)),
      surface_(image_) {
  surface_.normals = normals_.host();
  surface_.measured = measured_.host();
  for (int level = 0; level < image_.levels; ++level)
    surface_.tiles[level] = tiles_.host() + (image_.tiles[level] - image_.tiles[0]);
}

void FetchedImage::fetch(cudaStream_t stream) {
  const auto copy = [&](const auto* from, const auto& to) {
    check(
        cudaMemcpyAsync(to.host(), from, to.size() * sizeof *from, cudaMemcpyDeviceToHost, stream));
  };
  copy(image_.normals, normals_);
  copy(image_.measured, measured_);
  copy(image_.tiles[0], tiles_);
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
  for (std::size_t i = 0; i < count; ++i) {
    const DepthBody& image = rig.images()[i];
    if (const DeviceDepthBody* const here = made_here(image)) {
      made_here_.push_back(image);  // which keeps its memory; the rig has waited for it
      cameras[i].image = here->surface();
    } else {
      cameras[i].image = copies_.emplace_back(image.surface()).surface();
    }
    const ImageSilhouettes& found = image.silhouettes();
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
