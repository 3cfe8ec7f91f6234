#include "libvpm/mesh/voxel_repair.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/mesh/surface_distance.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm {
namespace {

constexpr int kBlock = 8;    // edge of OpenVDB's leaves
constexpr int kMargin = 4;   // voxels around the mesh: more than the band
constexpr double kBand = 3;  // voxels; values are cut off there
// In a hole the winding number falls from 1 to 0 over about the width of the hole, and the surface
// goes where it is one half. On triangles it jumps; with this slope their distance decides there.
constexpr double kVoxelsPerWinding = 2 * kBand;
// A block without triangles whose middle and corners are this clearly inside, or outside, is so.
constexpr double kClear = 0.1;

using Block = std::array<float, kBlock * kBlock * kBlock>;

// Signed distances in voxels, of points at low + voxel * (i, j, k).
class Field {
 public:
  Field(const Solid& mesh, Vec3 low, double voxel)
      : low_(low), voxel_(voxel), bvh_(mesh.vertices, mesh.triangles), winding_(bvh_) {}

  Vec3 at(double i, double j, double k) const { return low_ + voxel_ * Vec3{i, j, k}; }

  float value(Vec3 p) const {
    const double distance = bvh_.closest(p, kBand * voxel_).distance / voxel_;
    const double beyond = kVoxelsPerWinding * (winding_.at(p) - 0.5);
    const double size = std::min({distance, std::abs(beyond), kBand});
    return static_cast<float>(beyond > 0 ? -size : size);
  }

  // +kBand or -kBand where the whole block is outside or inside, 0 where it must be looked at.
  float uniform(openvdb::Coord origin) const {
    constexpr double kHalf = 0.5 * (kBlock - 1);
    const Vec3 middle = at(origin.x() + kHalf, origin.y() + kHalf, origin.z() + kHalf);
    const double reach = (std::sqrt(3.0) * kHalf + kBand) * voxel_;
    if (bvh_.closest(middle, reach).triangle != SurfacePoint::kNone) return 0;
    const bool inside = winding_.at(middle) > 0.5;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = at(origin.x() + (corner & 1) * kBlock, origin.y() + (corner >> 1 & 1) * kBlock,
                        origin.z() + (corner >> 2) * kBlock);
      const double clear = winding_.at(p) - 0.5;
      if ((inside ? clear : -clear) < kClear) return 0;
    }
    return static_cast<float>(inside ? -kBand : kBand);
  }

  Block block(openvdb::Coord origin) const {
    Block values{};
    std::size_t n = 0;
    for (int i = 0; i < kBlock; ++i) {
      for (int j = 0; j < kBlock; ++j) {
        for (int k = 0; k < kBlock; ++k)
          values[n++] = value(at(origin.x() + i, origin.y() + j, origin.z() + k));
      }
    }
    return values;
  }

 private:
  Vec3 low_;
  double voxel_;
  TriangleBvh bvh_;
  WindingNumber winding_;
};

openvdb::FloatGrid::Ptr sample(const Field& field, const std::array<int, 3>& blocks) {
  std::vector<openvdb::Coord> origins;
  for (int i = 0; i < blocks[0]; ++i) {
    for (int j = 0; j < blocks[1]; ++j) {
      for (int k = 0; k < blocks[2]; ++k) origins.emplace_back(kBlock * i, kBlock * j, kBlock * k);
    }
  }
  std::vector<float> uniform(origins.size());
  std::vector<Block> values(origins.size());
  parallel_for(origins.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      uniform[b] = field.uniform(origins[b]);
      if (uniform[b] == 0) values[b] = field.block(origins[b]);
    }
  });
  auto grid = openvdb::FloatGrid::create(static_cast<float>(kBand));
  for (std::size_t b = 0; b < origins.size(); ++b) {
    const openvdb::CoordBBox box = openvdb::CoordBBox::createCube(origins[b], kBlock);
    if (uniform[b] != 0) {
      if (uniform[b] < 0) grid->fill(box, uniform[b], false);
      continue;
    }
    auto* const leaf = grid->tree().touchLeaf(origins[b]);
    for (openvdb::Index n = 0; n < leaf->SIZE; ++n)
      leaf->setValueOnly(n, values[b][n]), leaf->setActiveState(n, std::abs(values[b][n]) < kBand);
  }
  return grid;
}

Solid extract(const openvdb::FloatGrid& grid, const Field& field) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(grid, points, triangles, quads, 0.0, 0.0);
  Solid solid;
  for (const openvdb::Vec3s& p : points)
    solid.vertices.push_back(field.at(double{p.x()}, double{p.y()}, double{p.z()}));
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

// As consistent as the mesh allows, facing outward on the whole.
void orient(Solid& mesh) {
  const Topology topology = topology_of(mesh.vertices.size(), mesh.triangles);
  if (!topology.conflicting.empty()) orient_consistently(topology, mesh.triangles);
  if (mass_properties(mesh).volume >= 0) return;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

}  // namespace

Solid repair_by_voxels(const Solid& given, int voxels, VoxelRepair& done) {
  if (voxels < kFewestRepairVoxels || voxels > kMostRepairVoxels) {
    throw Error(ErrorKind::usage, "repair: the voxels along the longest side must lie between " +
                                      std::to_string(kFewestRepairVoxels) + " and " +
                                      std::to_string(kMostRepairVoxels));
  }
  Solid mesh = given;
  orient(mesh);
  Vec3 low = mesh.vertices[mesh.triangles[0][0]], high = low;
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) {
      const Vec3 p = mesh.vertices[corner];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  const Vec3 size = high - low;
  const double h = done.voxel = std::max({size.x, size.y, size.z}) / voxels;
  const Field field(mesh, low - (kMargin - 0.5) * h * Vec3{1, 1, 1}, h);
  const auto blocks = [&](double side) {
    return (static_cast<int>(std::ceil(side / h)) + 2 * kMargin + kBlock - 1) / kBlock;
  };
  openvdb::initialize();
  const auto grid = sample(field, {blocks(size.x), blocks(size.y), blocks(size.z)});
  Solid solid = extract(*grid, field);
  if (solid.triangles.empty()) return solid;
  done.solid_to_mesh = farthest_from_surface(solid, mesh, 0.5 * h);
  done.mesh_to_solid = farthest_from_surface(mesh, solid, 0.5 * h);
  return solid;
}

}  // namespace vpm
