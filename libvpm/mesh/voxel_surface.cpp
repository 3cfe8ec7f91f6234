#include "libvpm/mesh/voxel_surface.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libvpm/core/parallel.h"

namespace vpm {
namespace {

constexpr int kBlock = 8;   // edge of OpenVDB's leaves
constexpr int kMargin = 4;  // voxels around the box; more than the band

using Block = std::array<float, kBlock * kBlock * kBlock>;

// Lattice of voxels; voxel (i, j, k) has its centre at low + voxel * (i, j, k).
struct Lattice {
  Vec3 low;
  double voxel = 0;
  std::array<int, 3> blocks{};

  explicit Lattice(const VoxelBox& box)
      : low(box.low - (kMargin - 0.5) * box.voxel * Vec3{1, 1, 1}), voxel(box.voxel) {
    const Vec3 size = box.high - box.low;
    const auto count = [&](double side) {
      return (static_cast<int>(std::ceil(side / voxel)) + 2 * kMargin + kBlock - 1) / kBlock;
    };
    blocks = {count(size.x), count(size.y), count(size.z)};
  }

  Vec3 at(double i, double j, double k) const { return low + voxel * Vec3{i, j, k}; }
};

float everywhere_in_block(const VoxelField& field, const Lattice& lattice, openvdb::Coord origin) {
  constexpr double kHalf = 0.5 * (kBlock - 1);
  return field.everywhere(lattice.at(origin.x() + kHalf, origin.y() + kHalf, origin.z() + kHalf),
                          0.5 * kBlock * lattice.voxel);
}

Block values_of_block(const VoxelField& field, const Lattice& lattice, openvdb::Coord origin) {
  Block values{};
  std::size_t n = 0;
  for (int i = 0; i < kBlock; ++i) {
    for (int j = 0; j < kBlock; ++j) {
      for (int k = 0; k < kBlock; ++k)
        values[n++] = field.at(lattice.at(origin.x() + i, origin.y() + j, origin.z() + k));
    }
  }
  return values;
}

openvdb::FloatGrid::Ptr sample(const VoxelField& field, const Lattice& lattice) {
  std::vector<openvdb::Coord> origins;
  for (int i = 0; i < lattice.blocks[0]; ++i) {
    for (int j = 0; j < lattice.blocks[1]; ++j) {
      for (int k = 0; k < lattice.blocks[2]; ++k)
        origins.emplace_back(kBlock * i, kBlock * j, kBlock * k);
    }
  }
  std::vector<float> everywhere(origins.size());
  std::vector<Block> values(origins.size());
  parallel_for(origins.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      everywhere[b] = everywhere_in_block(field, lattice, origins[b]);
      if (everywhere[b] == 0) values[b] = values_of_block(field, lattice, origins[b]);
    }
  });
  auto grid = openvdb::FloatGrid::create(kVoxelBand);
  for (std::size_t b = 0; b < origins.size(); ++b) {
    const openvdb::CoordBBox box = openvdb::CoordBBox::createCube(origins[b], kBlock);
    if (everywhere[b] != 0) {
      if (everywhere[b] < 0) grid->fill(box, everywhere[b], false);
      continue;
    }
    auto* const leaf = grid->tree().touchLeaf(origins[b]);
    for (openvdb::Index n = 0; n < leaf->SIZE; ++n) {
      leaf->setValueOnly(n, values[b][n]);
      leaf->setActiveState(n, std::abs(values[b][n]) < kVoxelBand);
    }
  }
  return grid;
}

}  // namespace

VoxelBox box_of_mesh(const Solid& mesh, int voxels_along_longest_side) {
  VoxelBox box;
  box.low = box.high = mesh.vertices[mesh.triangles[0][0]];
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) {
      const Vec3 p = mesh.vertices[corner];
      box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
      box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
    }
  }
  const Vec3 size = box.high - box.low;
  box.voxel = std::max({size.x, size.y, size.z}) / voxels_along_longest_side;
  return box;
}

Solid voxel_surface(const VoxelField& field, const VoxelBox& box) {
  const Lattice lattice(box);
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*sample(field, lattice), points, triangles, quads, 0.0, 0.0);
  Solid solid;
  for (const openvdb::Vec3s& p : points)
    solid.vertices.push_back(lattice.at(double{p.x()}, double{p.y()}, double{p.z()}));
  for (const openvdb::Vec3I& t : triangles) solid.triangles.push_back({t[0], t[1], t[2]});
  for (const openvdb::Vec4I& q : quads) {
    const auto length = [&](int a, int b) {
      return squared_norm(solid.vertices[q[a]] - solid.vertices[q[b]]);
    };
    if (length(0, 2) <= length(1, 3)) {
      solid.triangles.push_back({q[0], q[1], q[2]});
      solid.triangles.push_back({q[0], q[2], q[3]});
    } else {
      solid.triangles.push_back({q[0], q[1], q[3]});
      solid.triangles.push_back({q[1], q[2], q[3]});
    }
  }
  return solid;
}

}  // namespace vpm
