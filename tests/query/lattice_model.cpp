#include "tests/query/lattice_model.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "libvpm/cloud/normals.h"
#include "libvpm/synthetic/render.h"

namespace vpm::testing {
namespace {

std::uint32_t lattice_index(std::uint32_t n, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return (z * n + y) * n + x;
}

void connect_neighbors(std::uint32_t n, SphereGraph& graph) {
  graph.begin = {0};
  for (std::uint32_t z = 0; z < n; ++z) {
    for (std::uint32_t y = 0; y < n; ++y) {
      for (std::uint32_t x = 0; x < n; ++x) {
        if (z > 0) graph.neighbors.push_back(lattice_index(n, x, y, z - 1));
        if (y > 0) graph.neighbors.push_back(lattice_index(n, x, y - 1, z));
        if (x > 0) graph.neighbors.push_back(lattice_index(n, x - 1, y, z));
        if (x + 1 < n) graph.neighbors.push_back(lattice_index(n, x + 1, y, z));
        if (y + 1 < n) graph.neighbors.push_back(lattice_index(n, x, y + 1, z));
        if (z + 1 < n) graph.neighbors.push_back(lattice_index(n, x, y, z + 1));
        graph.begin.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
      }
    }
  }
}

// Puts one leaf level below a root.
void wrap(std::uint32_t count, double radius, Hierarchy& hierarchy) {
  hierarchy.leaves.resize(count);
  std::iota(hierarchy.leaves.begin(), hierarchy.leaves.end(), 0u);
  const Sphere all{{}, radius};
  constexpr std::uint32_t kChildren = 4;
  hierarchy.nodes.push_back({all, 1, 1 + kChildren, 0, 0});
  for (std::uint32_t k = 0; k < kChildren; ++k) {
    hierarchy.nodes.push_back({all, count * k / kChildren, count * (k + 1) / kChildren, 1, 0});
  }
}

// Returns the shape of a sample that is a small cube with this edge at the place `at`, counted from
// a corner of a large cube of `count` samples per edge; none in the large cube's inside.
std::optional<SampleFace> face_of(Vec3 at, double count, double edge) {
  const auto outward = [&](double k) { return k == 0 ? -1.0 : k == count - 1 ? 1.0 : 0.0; };
  const Vec3 out{outward(at.x), outward(at.y), outward(at.z)};
  if (out == Vec3{}) return std::nullopt;
  const Vec3 axis = out.x != 0   ? Vec3{out.x, 0, 0}
                    : out.y != 0 ? Vec3{0, out.y, 0}
                                 : Vec3{0, 0, out.z};
  const bool is_at_edge = squared_norm(out) > 1;
  const auto half = static_cast<float>(edge / 2),
             along = static_cast<float>(std::sqrt(5.0 / 12) * edge);
  return SampleFace{
      0, narrow(axis), half, count == 1 ? half : along, along, is_at_edge ? half : along};
}

}  // namespace

ToolModel lattice_cube(double edge, std::uint32_t n, std::uint32_t m) {
  ToolModel model;
  model.volume = edge * edge * edge;
  model.radius = std::sqrt(3.0) * edge / 2;
  model.levels.resize(1);
  Level& level = model.levels[0];
  level.sphere_count = n * n * n;
  const double share = edge / n, piece = share / m;
  const double per_edge = 1.0 / (n * m), weight = per_edge * per_edge * per_edge;
  level.grid = {{-edge / 2, -edge / 2, -edge / 2}, share, n, n, n, {}, {}};
  level.block_begin = {0};
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    const std::uint32_t row = i / n % n, layer = i / (n * n);
    const Vec3 cell{double(i % n), double(row), double(layer)};
    const Vec3 center = share * (cell + Vec3{0.5, 0.5, 0.5}) - Vec3{edge / 2, edge / 2, edge / 2};
    model.spheres.push_back({center, share / 2});
    level.grid.begin.push_back(i);
    level.grid.spheres.push_back(i);
    level.cell_volume.push_back(share * share * share);
    level.cell_centroid.push_back(center);
    level.cell_radius.push_back(std::sqrt(3.0) * share / 2 * (1 + 1e-6));
    const std::uint32_t begin = static_cast<std::uint32_t>(level.samples.size());
    std::vector<std::pair<CellSample, std::optional<SampleFace>>> pieces;
    for (std::uint32_t s = 0; s < m * m * m; ++s) {
      const std::uint32_t part_row = s / m % m, part_layer = s / (m * m);
      const Vec3 at{double(s % m), double(part_row), double(part_layer)};
      const Vec3 sample =
          center + piece * (at + Vec3{0.5, 0.5, 0.5}) - Vec3{share / 2, share / 2, share / 2};
      const double mean_squared_distance = piece * piece / 4;
      pieces.push_back(
          {{narrow(sample), static_cast<float>(std::sqrt(5.0 / 3 * mean_squared_distance)), weight},
           face_of(m * cell + at, n * m, piece)});
    }
    std::stable_partition(pieces.begin(), pieces.end(), [](const auto& p) { return !p.second; });
    for (auto& [sample, face] : pieces) {
      if (face) {
        face->sample = static_cast<std::uint32_t>(level.samples.size());
        level.faces.push_back(*face);
      }
      level.samples.push_back(sample);
    }
    level.blocks.push_back({narrow(center), static_cast<float>(level.cell_radius.back()), begin,
                            static_cast<std::uint32_t>(level.samples.size())});
    level.block_begin.push_back(static_cast<std::uint32_t>(level.blocks.size()));
  }
  level.grid.begin.push_back(level.sphere_count);
  connect_neighbors(n, level.graph);
  wrap(level.sphere_count, model.radius, level.hierarchy);
  return model;
}

std::vector<Vec3> places_in_cube(double edge, int per_edge) {
  std::vector<Vec3> places;
  for (int k = 0; k < per_edge * per_edge * per_edge; ++k) {
    const auto at = [&](int n) { return edge * ((n % per_edge + 0.5) / per_edge - 0.5); };
    places.push_back({at(k), at(k / per_edge), at(k / (per_edge * per_edge))});
  }
  return places;
}

Cloud see(const synthetic::Scene& scene) {
  const DepthImage depth = synthetic::render(*scene.surface, scene.camera);
  std::vector<Vec3f> normals(depth.depth.size());
  for (std::uint32_t v = 0; v < depth.height; ++v) {
    for (std::uint32_t u = 0; u < depth.width; ++u) {
      const std::size_t i = depth.index(u, v);
      if (!is_measured(depth.depth[i])) continue;
      const Vec3 at = unproject(scene.camera.intrinsics, u, v, depth.depth[i]);
      normals[i] = narrow(transpose(scene.camera.to_world.rotation) *
                          scene.surface->gradient(scene.camera.to_world * at));
    }
  }
  return assemble_cloud(depth, scene.camera, normals);
}

Cloud wall_with_hole() {
  Camera camera;
  camera.intrinsics = {150, 150, 79.5, 59.5};
  camera.width = 160, camera.height = 120;
  DepthImage image;
  image.width = camera.width, image.height = camera.height;
  image.depth.resize(std::size_t{image.width} * image.height, 1.0F);
  std::vector<Vec3f> normals(image.depth.size(), {0, 0, -1});
  for (std::uint32_t v = kHoleDown.begin; v < kHoleDown.end; ++v) {
    for (std::uint32_t u = kHoleAcross.begin; u < kHoleAcross.end; ++u) {
      image.depth[image.index(u, v)] = 0;
      normals[image.index(u, v)] = {};
    }
  }
  return assemble_cloud(image, camera, normals);
}

Rotation generic_rotation() {
  Quaternion q{0.31, -0.57, 0.21, 0.73};
  const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
  return rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length});
}

SmallImage small_noisy_image(const char* scene) {
  Camera camera = synthetic::default_camera();
  camera.intrinsics = {130, 131, 79.5, 60};
  camera.width = 160, camera.height = 121;
  return {camera,
          synthetic::render_with_kinect_noise(*synthetic::make_scene(scene).surface, camera, 1)};
}

Cloud permuted(const Cloud& cloud) {
  constexpr std::size_t kPrime = 7919;  // coprime to any image size in these tests
  Cloud other = cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t from = (i * kPrime + 13) % cloud.size();
    other.positions[i] = cloud.positions[from];
    other.normals[i] = cloud.normals[from];
    other.radii[i] = cloud.radii[from];
    if (!cloud.pixels.empty()) other.pixels[i] = cloud.pixels[from];
  }
  return other;
}

Cloud doubled(const Cloud& cloud) {
  Cloud twice = cloud;
  const auto append = [](auto& all) {
    all.insert(all.end(), all.begin(), all.begin() + std::ptrdiff_t(all.size()));
  };
  twice.positions.reserve(2 * cloud.size()), twice.normals.reserve(2 * cloud.size());
  twice.radii.reserve(2 * cloud.size()), twice.pixels.reserve(2 * cloud.size());
  append(twice.positions), append(twice.normals), append(twice.radii), append(twice.pixels);
  return twice;
}

}  // namespace vpm::testing
