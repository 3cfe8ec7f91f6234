#include "libvpm/mesh/voxel_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/voxel_library.h"

namespace vpm {
namespace {

constexpr int kBlock = VoxelBlock::kEdge;
constexpr int kMargin = 4;  // voxels around the box; more than the band

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

void sample(const VoxelField& field, const Lattice& lattice, VoxelBlock& block) {
  const auto at = [&](double i, double j, double k) {
    return lattice.at(block.origin[0] + i, block.origin[1] + j, block.origin[2] + k);
  };
  constexpr double kHalf = 0.5 * (kBlock - 1);
  block.everywhere = field.everywhere(at(kHalf, kHalf, kHalf), 0.5 * kBlock * lattice.voxel);
  if (block.everywhere != 0) return;
  std::size_t n = 0;
  for (int i = 0; i < kBlock; ++i) {
    for (int j = 0; j < kBlock; ++j) {
      for (int k = 0; k < kBlock; ++k) block.values[n++] = field.at(at(i, j, k));
    }
  }
}

std::vector<VoxelBlock> sampled(const VoxelField& field, const Lattice& lattice) {
  std::vector<VoxelBlock> blocks;
  for (int i = 0; i < lattice.blocks[0]; ++i) {
    for (int j = 0; j < lattice.blocks[1]; ++j) {
      for (int k = 0; k < lattice.blocks[2]; ++k)
        blocks.push_back({{kBlock * i, kBlock * j, kBlock * k}});
    }
  }
  parallel_for(blocks.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) sample(field, lattice, blocks[b]);
  });
  return blocks;
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
  const VoxelFaces faces = voxel_library().zero_surface(sampled(field, lattice), kVoxelBand);
  Solid solid;
  for (const Vec3f& p : faces.points)
    solid.vertices.push_back(lattice.at(double{p.x}, double{p.y}, double{p.z}));
  solid.triangles = faces.triangles;
  for (const std::array<std::uint32_t, 4>& q : faces.quads) {
    const auto length = [&](std::size_t a, std::size_t b) {
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
