// libvpm_voxels.so: the only part of vpm's libraries that knows of OpenVDB.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <utility>

#include "libvpm/mesh/voxel_library.h"

namespace vpm {
namespace {

class GridReader : public VoxelDistances::Reader {
 public:
  explicit GridReader(const openvdb::FloatGrid& grid) : accessor_(grid.getConstAccessor()) {}
  float at(int x, int y, int z) override { return accessor_.getValue({x, y, z}); }

 private:
  openvdb::FloatGrid::ConstAccessor accessor_;
};

class GridDistances : public VoxelDistances {
 public:
  explicit GridDistances(openvdb::FloatGrid::Ptr grid) : grid_(std::move(grid)) {}
  std::unique_ptr<Reader> reader() const override { return std::make_unique<GridReader>(*grid_); }

 private:
  openvdb::FloatGrid::Ptr grid_;
};

openvdb::FloatGrid::Ptr grid_of(std::span<const VoxelBlock> blocks, float outside) {
  auto grid = openvdb::FloatGrid::create(outside);
  for (const VoxelBlock& block : blocks) {
    const openvdb::Coord origin(block.origin[0], block.origin[1], block.origin[2]);
    if (block.everywhere != 0) {
      if (block.everywhere < 0)
        grid->fill(openvdb::CoordBBox::createCube(origin, VoxelBlock::kEdge), block.everywhere,
                   false);
      continue;
    }
    auto* const leaf = grid->tree().touchLeaf(origin);
    for (openvdb::Index n = 0; n < leaf->SIZE; ++n) {
      leaf->setValueOnly(n, block.values[n]);
      leaf->setActiveState(n, std::abs(block.values[n]) < outside);
    }
  }
  return grid;
}

class OpenVdb : public VoxelLibrary {
 public:
  OpenVdb() { openvdb::initialize(); }

  std::unique_ptr<VoxelDistances> distances(std::span<const Vec3f> points,
                                            std::span<const Triangle> triangles,
                                            float band) const override {
    // These types are those that libopenvdb holds compiled; others take the compiler a minute here.
    std::vector<openvdb::Vec3s> places;
    for (const Vec3f& p : points) places.emplace_back(p.x, p.y, p.z);
    std::vector<openvdb::Vec3I> corners;
    for (const Triangle& t : triangles) corners.emplace_back(t[0], t[1], t[2]);
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(places,
                                                                                          corners);
    openvdb::util::NullInterrupter never;
    return std::make_unique<GridDistances>(openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        never, mesh, *openvdb::math::Transform::createLinearTransform(1.0), band, band));
  }

  VoxelFaces zero_surface(std::span<const VoxelBlock> blocks, float outside) const override {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid_of(blocks, outside), points, triangles, quads, 0.0, 0.0);
    VoxelFaces faces;
    for (const openvdb::Vec3s& p : points) faces.points.push_back({p.x(), p.y(), p.z()});
    for (const openvdb::Vec3I& t : triangles) faces.triangles.push_back({t[0], t[1], t[2]});
    for (const openvdb::Vec4I& q : quads) faces.quads.push_back({q[0], q[1], q[2], q[3]});
    return faces;
  }
};

}  // namespace

// Named as kVoxelFunctions says.
extern "C" __attribute__((visibility("default"))) const VoxelLibrary* vpm_voxel_functions() {
  static const OpenVdb library;
  return &library;
}

}  // namespace vpm
