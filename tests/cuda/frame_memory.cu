#include <cstring>

#include "libvpm/scene/cuda/cloud_slot.h"
#include "tests/cuda/frame_memory.h"

namespace vpm::testing {
namespace {

template <class T>
std::vector<T> fetched(const T* from, std::size_t count) {
  std::vector<T> values(count);
  cuda::check(cudaMemcpy(values.data(), from, count * sizeof(T), cudaMemcpyDeviceToHost));
  return values;
}

std::size_t tile_count(const DepthSurface& surface, int level) {
  return static_cast<std::size_t>(((surface.height - 1) >> level) + 1) *
         static_cast<std::size_t>(surface.tiles_per_row(level));
}

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

}  // namespace

std::optional<FrameMemory> memory_on_device(const DepthBody& frame) {
  const auto& slot = dynamic_cast<const cuda::CloudSlot&>(*frame.slot());
  if (!slot.is_on_device() || !slot.is_sound()) return std::nullopt;
  cuda::check(cudaDeviceSynchronize());
  const DepthSurface& surface = slot.body().surface();
  const std::size_t pixels = slot.pixels();
  FrameMemory memory{fetched(surface.normals, pixels), fetched(surface.measured, pixels), {}};
  for (int level = 0; level < surface.levels; ++level)
    memory.tiles.push_back(fetched(surface.tiles[level], tile_count(surface, level)));
  return memory;
}

FrameMemory memory_of(const PreparedImage& image) {
  const DepthSurface surface = image.surface();
  const std::size_t pixels = image.pixel_begin().size() - 1;
  FrameMemory memory{{surface.normals, surface.normals + pixels},
                     {surface.measured, surface.measured + pixels},
                     {}};
  for (int level = 0; level < surface.levels; ++level)
    memory.tiles.emplace_back(surface.tiles[level],
                              surface.tiles[level] + tile_count(surface, level));
  return memory;
}

bool same_bits(const FrameMemory& a, const FrameMemory& b) {
  bool same = a.tiles.size() == b.tiles.size() && same_bytes(a.normals, b.normals) &&
              same_bytes(a.measured, b.measured);
  for (std::size_t level = 0; same && level < a.tiles.size(); ++level)
    same = same_bytes(a.tiles[level], b.tiles[level]);
  return same;
}

}  // namespace vpm::testing
