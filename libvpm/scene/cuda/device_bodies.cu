#include <algorithm>
#include <cstring>

#include "libvpm/scene/cuda/cloud_slot.h"
#include "libvpm/scene/cuda/device_bodies.h"
#include "libvpm/scene/cuda/rig_silhouettes.h"

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

// Lays out arrays of several types in memory that begins at an address.
class Layout {
 public:
  explicit Layout(const std::byte* begin) : begin_(reinterpret_cast<std::uintptr_t>(begin)) {}

  template <class T>
  T* room(std::size_t count) {
    constexpr std::size_t kAlignment = 16;
    static_assert(alignof(T) <= kAlignment);
    T* const at = reinterpret_cast<T*>(begin_ + bytes_);
    bytes_ += (count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    return at;
  }
  // Also keeps the values, to be copied there.
  template <class T>
  T* copy(const std::vector<T>& values) {
    const std::size_t first = bytes_;
    T* const at = room<T>(values.size());
    values_.resize(bytes_);
    if (!values.empty()) std::memcpy(&values_[first], values.data(), values.size() * sizeof(T));
    return at;
  }

  std::size_t bytes() const { return bytes_; }
  const std::vector<std::byte>& values() const { return values_; }

 private:
  std::uintptr_t begin_;
  std::size_t bytes_ = 0;
  std::vector<std::byte> values_;
};

// Lays out what `lay(layout)` asks for in memory of the device, and returns that with the values.
template <class Lay>
DeviceArray<std::byte> laid_out(const Lay& lay) {
  Layout counted(nullptr);
  lay(counted);
  DeviceArray<std::byte> memory(counted.bytes());
  Layout layout(memory.get());
  lay(layout);
  if (!layout.values().empty())
    check(cudaMemcpy(memory.get(), layout.values().data(), layout.values().size(),
                     cudaMemcpyHostToDevice));
  return memory;
}

void give_room(const DepthSurface& surface, bool has_fits, Layout& layout, SpreadImage& image) {
  const std::size_t pixels = pixels_of(surface);
  const auto tiles = [](std::int32_t side) { return ((side - 1) >> Silhouettes::kTileShift) + 1; };
  image.width = surface.width, image.height = surface.height;
  image.columns = tiles(image.width) + 1, image.rows = tiles(image.height) + 1;
  image.keys = SilhouetteKeys(surface.k.fx / surface.k.fy);
  image.numbers = layout.room<std::uint32_t>(pixels);
  image.nearest = layout.room<std::uint32_t>(pixels);
  image.hole_numbers = has_fits ? layout.room<std::uint32_t>(pixels) : nullptr;
  image.sums = layout.room<std::uint32_t>(static_cast<std::size_t>(image.columns) *
                                          static_cast<std::size_t>(image.rows));
  image.down = layout.room<std::int8_t>(pixels);
}

// Copies the silhouettes of an image, and returns them as kernels take them.
Silhouettes copied(const ImageSilhouettes& found, Layout& layout, SpreadImage& image) {
  const ImageHoles& holes = found.holes();
  image.pixels = layout.copy(found.pixels());
  image.pixel_count = static_cast<std::uint32_t>(found.pixels().size());
  Silhouettes silhouettes{image.pixels, image.nearest, image.sums, image.columns, {}};
  if (holes.fits().empty()) return silhouettes;
  image.holes = layout.copy(holes.numbered());
  image.hole_count = static_cast<std::uint32_t>(holes.numbered().size());
  silhouettes.holes = {layout.copy(holes.fits()), image.hole_numbers, layout.copy(holes.greatest()),
                       holes.view().columns};
  return silhouettes;
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

DeviceRigBody::DeviceRigBody(const PreparedRig& rig) {
  std::vector<RigCamera> cameras = rig.cameras();
  SpreadImages spread;
  spread.count = static_cast<unsigned>(cameras.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const DepthBody& image = rig.images()[i];
    if (const DeviceDepthBody* const here = made_here(image)) {
      made_here_.push_back(image);  // which keeps its memory; the rig has waited for it
      cameras[i].image = here->surface();
    } else {
      cameras[i].image = copies_.emplace_back(image.surface()).surface();
    }
  }
  const auto found = [&](std::size_t i) -> const ImageSilhouettes& {
    return rig.images()[i].silhouettes();
  };
  room_ = laid_out([&](Layout& layout) {
    for (std::size_t i = 0; i < cameras.size(); ++i)
      give_room(cameras[i].image, !found(i).holes().fits().empty(), layout, spread.of[i]);
  });
  copied_ = laid_out([&](Layout& layout) {
    for (std::size_t i = 0; i < cameras.size(); ++i)
      cameras[i].silhouettes = copied(found(i), layout, spread.of[i]);
    const RigCamera* const all = layout.copy(cameras);
    surface_ = rig.surface_of(all, layout.copy(rig.agreement().of_pairs));
  });
  spread_on_device(spread, cudaStreamLegacy);
  finish_transfers();
}

}  // namespace vpm::cuda
