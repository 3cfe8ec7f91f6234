#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <mutex>

#include "libvpm/query/cuda/on_device.h"
#include "libvpm/query/measure_refined.h"

namespace vpm::cuda {
namespace {

void add_units(const ToolModel& tool, const Level& level, std::uint32_t i,
               std::vector<Unit>& units) {
  const Vec3 center = tool.spheres[i].center - tool.center_of_mass;
  const std::uint32_t begin = level.block_begin[i], end = level.block_begin[i + 1];
  Unit unit;
  unit.balls[Unit::of_share] = {center, level.share_reach[i]};
  unit.balls[Unit::of_sphere] = {center, tool.spheres[i].radius};
  unit.share = i;
  if (is_compact(level.share_reach[i], tool.reach)) unit.flags |= Unit::is_compact;
  if (begin == end) units.push_back(unit), units.back().flags |= Unit::is_head;
  for (std::uint32_t b = begin; b < end; ++b) {
    const CellBlock& block = level.blocks[b];
    unit.balls[Unit::of_block] = {widen(block.center), block.radius};
    unit.block = b;
    unit.begin = block.begin;
    unit.end = block.end;
    units.push_back(unit);
    units.back().flags |= Unit::has_block | (b == begin ? Unit::is_head : 0U);
  }
}

// Cluster by cluster.
std::vector<Unit> units_of(const ToolModel& tool, const Level& level, const ShareClusters& clusters,
                           std::vector<Chunk>& chunks) {
  std::vector<Unit> units;
  for (const ShareCluster& cluster : clusters.clusters) {
    auto begin = static_cast<std::uint32_t>(units.size());
    for (std::uint32_t k = cluster.begin; k < cluster.end; ++k)
      add_units(tool, level, clusters.shares[k], units);
    const auto end = static_cast<std::uint32_t>(units.size());
    for (; begin < end; begin += Chunk::kUnits)
      chunks.push_back(
          {{cluster.center, cluster.reach}, begin, std::min(begin + Chunk::kUnits, end)});
  }
  return units;
}

std::vector<Edge> edges_of(const SphereGraph& graph) {
  std::vector<Edge> edges;
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      if (graph.neighbors[k] < i) edges.push_back({i, graph.neighbors[k]});
  }
  return edges;
}

// Of each sphere, where the edges begin of which it has the larger index.
std::vector<std::uint32_t> edge_begins(const SphereGraph& graph) {
  std::vector<std::uint32_t> begins{0};
  for (std::uint32_t i = 0; i + 1 < graph.begin.size(); ++i) {
    std::uint32_t count = 0;
    for (std::uint32_t k = graph.begin[i]; k < graph.begin[i + 1]; ++k)
      count += graph.neighbors[k] < i ? 1 : 0;
    begins.push_back(begins.back() + count);
  }
  return begins;
}

std::vector<Vec3> centers_of(const ToolModel& tool, const Level& level) {
  std::vector<Vec3> centers(level.sphere_count);
  for (std::size_t i = 0; i < centers.size(); ++i)
    centers[i] = tool.spheres[i].center - tool.center_of_mass;
  return centers;
}

}  // namespace

double reach_of_spheres(const ToolModel& tool, const Level& level) {
  double reach = 0;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    const Sphere& s = tool.spheres[i];
    reach = std::max(reach, norm(s.center - tool.center_of_mass) + s.radius);
  }
  constexpr double kRounding = 1 + 1e-9;
  return kRounding * reach;
}

DeviceLevel::DeviceLevel(const ToolModel& tool, const Level& level, ToolReach reach,
                         const ShareClusters& clusters)
    : spheres_(tool.spheres.data(), level.sphere_count),
      centers_(centers_of(tool, level)),
      reach_(level.share_reach),
      block_begin_(level.block_begin),
      grid_begin_(level.grid.begin),
      grid_spheres_(level.grid.spheres),
      blocks_(level.blocks),
      block_masses_(block_masses(level)),
      share_masses_(clusters.masses),
      samples_(level.samples),
      edges_(edges_of(level.graph)),
      edge_begin_(edge_begins(level.graph)) {
  std::vector<Chunk> chunks;
  const std::vector<Unit> units = units_of(tool, level, clusters, chunks);
  units_ = DeviceArray<Unit>(units);
  chunks_ = DeviceArray<Chunk>(chunks);
  view_.count = level.sphere_count;
  view_.chunks = chunks_.get();
  view_.chunk_count = static_cast<std::uint32_t>(chunks.size());
  view_.spheres = spheres_.get();
  view_.centers = centers_.get();
  view_.reach = reach_.get();
  view_.block_begin = block_begin_.get();
  view_.blocks = blocks_.get();
  view_.block_masses = block_masses_.get();
  view_.samples = samples_.get();
  view_.units = units_.get();
  view_.share_masses = share_masses_.get();
  view_.edges = edges_.get();
  view_.edge_begin = edge_begin_.get();
  view_.edge_count = static_cast<std::uint32_t>(edges_.size());
  view_.piece_count =
      static_cast<std::uint32_t>(samples_.size() + blocks_.size() + level.sphere_count);
  view_.grid = view_of(level.grid);
  view_.grid.begin = grid_begin_.get();
  view_.grid.spheres = grid_spheres_.get();
  view_.center_of_mass = tool.center_of_mass;
  view_.tool_reach = reach;
  view_.spheres_reach = reach_of_spheres(tool, level);
  for (const Chunk& chunk : chunks) looks_.add(chunk.ball.center, chunk.ball.radius);
  for (const Unit& unit : units) {
    const UnitBall &share = unit.balls[Unit::of_share], &block = unit.balls[Unit::of_block];
    if ((unit.flags & Unit::is_head) != 0) looks_.add(share.center, share.radius);
    looks_.add(block.center, block.radius);
  }
}

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
  image.set_size(static_cast<std::int32_t>(camera.width), static_cast<std::int32_t>(camera.height));
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
  CloudRoom room{positions_.get(), normals_.get(),  pixel_normals_.get(),
                 nullptr,          measured_.get(), {},
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
  const SettledDisks& settled = cloud.disks();
  feet_ = DeviceArray<Vec3f>(settled.feet);
  disk_normals_ = DeviceArray<Vec3f>(settled.normals);
  second_of_ = DeviceArray<std::uint32_t>(settled.second_of);
  seconds_ = DeviceArray<SecondPlane>(settled.seconds);
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
  if (!copy) {
    const OtherWork other;
    known = copy = std::make_shared<const DeviceCloud>(cloud);
  }
  return copy;
}

}  // namespace vpm::cuda
