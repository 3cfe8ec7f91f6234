#include "tests/formats/golden_content.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace vpm::golden {
namespace {

constexpr double kHalf = 0.1;      // half of the cube's side
constexpr double kQuarter = 0.05;  // distance of octant centres from the axes' planes

// Returns a corner of the cube: bit 0 of `octant` is the sign of x, bit 1 of y, bit 2 of z.
Vec3 corner(std::uint32_t octant, double size) {
  return {(octant & 1) != 0 ? size : -size, (octant & 2) != 0 ? size : -size,
          (octant & 4) != 0 ? size : -size};
}

nlohmann::json provenance() {
  return {{"tool", "vpm-make-golden"}, {"version", "0.1.0"}, {"parameters", {{"side", 0.2}}}};
}

// Joins spheres whose octants share a face, where they touch.
SphereGraph octant_graph(std::uint32_t count) {
  SphereGraph graph;
  for (std::uint32_t i = 0; i < count; ++i) {
    graph.begin.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
    for (std::uint32_t j = 0; j < count; ++j) {
      const std::uint32_t difference = i ^ j;
      if (difference == 1 || difference == 2 || difference == 4) graph.neighbors.push_back(j);
    }
  }
  graph.begin.push_back(static_cast<std::uint32_t>(graph.neighbors.size()));
  return graph;
}

// Returns a root over one node per layer of four spheres.
Hierarchy layered_hierarchy(std::uint32_t count) {
  const double root_two = std::sqrt(2.0);
  const std::uint32_t layers = count / 4;
  Hierarchy tree;
  tree.nodes.push_back({{{0, 0, layers == 1 ? -kQuarter : 0.0},
                         kQuarter * (layers == 1 ? 1 + root_two : 1 + std::sqrt(3.0))},
                        1,
                        1 + layers,
                        0,
                        0});
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    tree.nodes.push_back({{{0, 0, layer == 0 ? -kQuarter : kQuarter}, kQuarter * (1 + root_two)},
                          4 * layer,
                          4 * layer + 4,
                          1,
                          0});
  }
  for (std::uint32_t i = 0; i < count; ++i) tree.leaves.push_back(i);
  return tree;
}

// Returns one grid cell, one block and one sample per sphere. With four spheres each cell is a
// column of the cube, with eight an octant.
Level octant_level(std::uint32_t count) {
  const bool columns = count == 4;
  Level level;
  level.epsilon = kQuarter / 10;
  level.components_before = 1;
  level.sphere_count = count;
  level.graph = octant_graph(count);
  level.hierarchy = layered_hierarchy(count);
  level.grid = {corner(0, kHalf), kHalf, 2, 2, columns ? 1U : 2U, {}, {}};
  const double half_height = columns ? kHalf : kQuarter;
  // The mean squared distance of a box from its centre is a third of its squared half diagonal.
  const double half_diagonal = std::sqrt(2 * kQuarter * kQuarter + half_height * half_height);
  for (std::uint32_t i = 0; i < count; ++i) {
    Vec3 centroid = corner(i, kQuarter);
    if (columns) centroid.z = 0;
    level.cell_volume.push_back(0.008 / count);
    level.cell_centroid.push_back(centroid);
    level.cell_radius.push_back(
        columns ? std::sqrt(2 * kQuarter * kQuarter + 9 * kQuarter * kQuarter) : half_diagonal);
    level.blocks.push_back({narrow(centroid), static_cast<float>(half_diagonal), i, i + 1});
    level.samples.push_back(
        {narrow(centroid), static_cast<float>(half_diagonal * std::sqrt(5.0) / 3), 1.0 / count});
    level.grid.spheres.push_back(i);
  }
  for (std::uint32_t i = 0; i <= count; ++i) {
    level.grid.begin.push_back(i);
    level.block_begin.push_back(i);
  }
  return level;
}

}  // namespace

Packing cube_packing() {
  Packing packing;
  for (std::uint32_t i = 0; i < 8; ++i) {
    packing.spheres.push_back({corner(i, kQuarter), kQuarter});
    packing.solid.vertices.push_back(corner(i, kHalf));
  }
  packing.solid.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  packing.provenance = provenance();
  return packing;
}

ToolModel cube_model() {
  const Packing packing = cube_packing();
  ToolModel model;
  model.volume = 0.008;
  model.radius = kHalf * std::sqrt(3.0);
  model.solid_hash = content_hash(packing.solid);
  model.spheres = packing.spheres;
  model.levels = {octant_level(4), octant_level(8)};
  model.provenance = provenance();
  return model;
}

ToolModel calibrated_cube_model() {
  ToolModel model = cube_model();
  model.calibration = {{0.01, 0.03, 0.05}, {0.005, 0.0125, 0.02}};
  return model;
}

ToolModel cube_model_with_surface() {
  ToolModel model = cube_model();
  model.surface = cube_packing().solid;
  return model;
}

ToolModel cube_model_with_faces() {
  ToolModel model = cube_model();
  const float along = static_cast<float>(2 * kQuarter * std::sqrt(5.0 / 12)), half = kQuarter;
  for (std::uint32_t i = 0; i < 8; ++i)
    model.levels[1].faces.push_back(
        {i, {(i & 1) != 0 ? 1.0F : -1.0F, 0, 0}, half, along, along, half});
  return model;
}

Cloud wall_cloud() {
  CloudSensor sensor;
  sensor.camera.intrinsics = {4, 4, 1.5, 1};
  sensor.camera.width = sensor.depth.width = 4;
  sensor.camera.height = sensor.depth.height = 3;
  sensor.camera.to_world.rotation = {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}};  // looks along x
  sensor.camera.to_world.translation = {10, 20, 30};
  sensor.depth.depth.assign(12, 1.0F);
  sensor.depth.depth[5] = 0;

  Cloud cloud;
  cloud.origin = sensor.camera.to_world.translation;
  for (std::uint32_t pixel = 0; pixel < 12; ++pixel) {
    if (pixel == 5) continue;
    const Vec3 seen = unproject(sensor.camera.intrinsics, pixel % 4, pixel / 4, 1);
    cloud.positions.push_back(narrow(sensor.camera.to_world.rotation * seen));
    cloud.normals.push_back({-1, 0, 0});
    cloud.radii.push_back(0.125F);  // half a pixel at 1 m
    cloud.pixels.push_back(pixel);
  }
  cloud.sensor = sensor;
  cloud.provenance = provenance();
  return cloud;
}

Cloud scattered_cloud() {
  Cloud cloud;
  cloud.origin = {1e7, -1e7, 0.1};
  cloud.positions = {{0, 0, 0}, {1, 0, 0.5F}, {-1, 0.25F, 0}};
  cloud.normals = {{0, 0, 1}, {0.6F, 0, 0.8F}, {0, -1, 0}};
  cloud.radii = {0.5F, 0.25F, 0};
  cloud.provenance = provenance();
  return cloud;
}

}  // namespace vpm::golden
