#include <cmath>
#include <map>
#include <mutex>

#include "libvpm/query/cuda/on_device.h"
#include "libvpm/query/measure_refined.h"

namespace vpm::cuda {
namespace {

// Threads that measure one share together: about its number of samples, up to a warp.
std::uint32_t lanes_per_share(const Level& level) {
  std::uint32_t lanes = 1;
  while (lanes < 32 && std::size_t{lanes} * level.sphere_count < level.samples.size()) lanes *= 2;
  return lanes;
}

std::vector<std::uint32_t> blocks_of_samples(const Level& level) {
  std::vector<std::uint32_t> block_of(level.samples.size());
  for (std::uint32_t b = 0; b < level.blocks.size(); ++b) {
    for (std::uint32_t s = level.blocks[b].begin; s < level.blocks[b].end; ++s) block_of[s] = b;
  }
  return block_of;
}

std::vector<Vec3> centers_of(const ToolModel& tool, const Level& level) {
  std::vector<Vec3> centers(level.sphere_count);
  for (std::size_t i = 0; i < centers.size(); ++i)
    centers[i] = tool.spheres[i].center - tool.center_of_mass;
  return centers;
}

}  // namespace

DeviceLevel::DeviceLevel(const ToolModel& tool, const Level& level)
    : spheres_(tool.spheres.data(), level.sphere_count),
      centers_(centers_of(tool, level)),
      reach_(level.share_reach),
      block_begin_(level.block_begin),
      block_of_(blocks_of_samples(level)),
      edge_begin_(level.graph.begin),
      neighbors_(level.graph.neighbors),
      grid_begin_(level.grid.begin),
      grid_spheres_(level.grid.spheres),
      blocks_(level.blocks),
      masses_(block_masses(level)),
      samples_(level.samples) {
  view_.count = level.sphere_count;
  view_.lanes_per_share = lanes_per_share(level);
  view_.spheres = spheres_.get();
  view_.centers = centers_.get();
  view_.reach = reach_.get();
  view_.block_begin = block_begin_.get();
  view_.blocks = blocks_.get();
  view_.masses = masses_.get();
  view_.samples = samples_.get();
  view_.block_of = block_of_.get();
  view_.edge_begin = edge_begin_.get();
  view_.neighbors = neighbors_.get();
  view_.grid = view_of(level.grid);
  view_.grid.begin = grid_begin_.get();
  view_.grid.spheres = grid_spheres_.get();
  view_.center_of_mass = tool.center_of_mass;
  view_.tool_volume = tool.volume;
  view_.tool_reach = tool.reach;
}

DeviceCloud::DeviceCloud(const PreparedCloud& cloud) {
  frame_.is_organised = cloud.is_organised();
  frame_.origin = cloud.origin();
  if (cloud.is_organised())
    copy_image(cloud);
  else
    copy_points(cloud);
}

void DeviceCloud::copy_image(const PreparedCloud& cloud) {
  depth_ = cloud.depth_surface();
  frame_.camera_to_world = cloud.camera_to_world();
  frame_.intrinsics = depth_.k;
  frame_.width = depth_.width;
  frame_.height = depth_.height;

  const std::vector<std::uint32_t>& begin = cloud.pixel_begin();
  const std::size_t pixels = begin.size() - 1;
  const float nowhere = std::nanf("");
  std::vector<Vec3f> positions(pixels, Vec3f{nowhere, nowhere, nowhere}), normals(pixels);
  for (std::size_t p = 0; p < pixels; ++p) {
    if (begin[p] == begin[p + 1]) continue;
    positions[p] = cloud.positions()[begin[p]];
    normals[p] = cloud.normals()[begin[p]];
  }
  positions_ = DeviceArray<Vec3f>(positions);
  normals_ = DeviceArray<Vec3f>(normals);
  points_ = {positions_.get(), normals_.get(), static_cast<std::uint32_t>(pixels), depth_.width,
             nullptr};

  pixel_normals_ = DeviceArray<Vec3f>(depth_.normals, pixels);
  depth_.normals = pixel_normals_.get();
  std::vector<InverseDepthRange> tiles;
  std::size_t begins[DepthSurface::kMaxLevels] = {};
  for (int level = 0; level < depth_.levels; ++level) {
    const auto rows = static_cast<std::size_t>(((depth_.height - 1) >> level) + 1);
    const std::size_t count = rows * static_cast<std::size_t>(depth_.tiles_per_row(level));
    begins[level] = tiles.size();
    tiles.insert(tiles.end(), depth_.tiles[level], depth_.tiles[level] + count);
  }
  tiles_ = DeviceArray<InverseDepthRange>(tiles);
  for (int level = 0; level < depth_.levels; ++level)
    depth_.tiles[level] = tiles_.get() + begins[level];
}

void DeviceCloud::copy_points(const PreparedCloud& cloud) {
  disks_ = cloud.disk_surface();
  positions_ = DeviceArray<Vec3f>(cloud.positions());
  normals_ = DeviceArray<Vec3f>(cloud.normals());
  boxes_ = DeviceArray<PointBox>(disks_.nodes, 2 * std::size_t{disks_.leaves});
  disks_.positions = positions_.get();
  disks_.normals = normals_.get();
  disks_.nodes = boxes_.get();
  points_ = {positions_.get(), normals_.get(), disks_.count, 0, boxes_.get() + disks_.leaves};
}

std::shared_ptr<const DeviceCloud> on_device(const PreparedCloud& cloud) {
  static std::mutex mutex;
  static std::map<std::pair<int, std::uint64_t>, std::weak_ptr<const DeviceCloud>> copies;
  int device = 0;
  check(cudaGetDevice(&device));
  const std::lock_guard lock(mutex);
  std::erase_if(copies, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const DeviceCloud>& known = copies[{device, cloud.serial()}];
  std::shared_ptr<const DeviceCloud> copy = known.lock();
  if (!copy) known = copy = std::make_shared<const DeviceCloud>(cloud);
  return copy;
}

}  // namespace vpm::cuda
