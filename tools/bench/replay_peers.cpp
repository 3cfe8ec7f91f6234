#include "tools/bench/replay_peers.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tree/LeafManager.h>

#include <algorithm>
#include <cmath>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"

namespace vpm::bench {
namespace {

struct Rectangle {
  int u0 = 0, u1 = -1, v0 = 0, v1 = -1;
};

// Returns the rectangle of the box's corners in the image. The box must lie in front of the camera.
Rectangle pixels_of(const Box& box, const Pose& to_camera, const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  double u0 = HUGE_VAL, u1 = -HUGE_VAL, v0 = HUGE_VAL, v1 = -HUGE_VAL;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p =
        to_camera * Vec3{corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                         corner & 4 ? box.high.z : box.low.z};
    const double u = k.fx * p.x / p.z + k.cx, v = k.fy * p.y / p.z + k.cy;
    u0 = std::min(u0, u), u1 = std::max(u1, u), v0 = std::min(v0, v), v1 = std::max(v1, v);
  }
  const auto within = [](double x, std::uint32_t size) {
    return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(size)));
  };
  return {std::max(within(u0, camera.width), 0),
          std::min(within(u1, camera.width) + 1, static_cast<int>(camera.width) - 1),
          std::max(within(v0, camera.height), 0),
          std::min(within(v1, camera.height) + 1, static_cast<int>(camera.height) - 1)};
}

openvdb::FloatGrid::Ptr distances_of(const Solid& solid, double voxel, int voxels) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  for (const Vec3& v : solid.vertices)
    points.emplace_back(static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
  std::vector<openvdb::Vec3I> triangles;
  for (const Triangle& t : solid.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  // Widths of the band in voxels; the inner one exceeds every distance inside.
  constexpr float kOutside = 3;
  const auto deepest = static_cast<float>(voxels);
  return openvdb::tools::meshToSignedDistanceField<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(voxel), points, triangles, {}, kOutside,
      deepest);
}

}  // namespace

class Voxels {
 public:
  Voxels(const Solid& solid, int voxels) {
    for (const Vec3& v : solid.vertices) box.add(v);
    const Vec3 side = box.size();
    size = std::max({side.x, side.y, side.z}) / voxels;
    grid = distances_of(solid, size, voxels);
    leaves = std::make_unique<Leaves>(grid->tree());
    const openvdb::CoordBBox bounds = grid->evalActiveVoxelBoundingBox();
    dense = std::make_unique<Dense>(bounds);
    openvdb::tools::copyToDense(*grid, *dense);
    first = bounds.min();
    const openvdb::Coord dim = bounds.dim();
    nx = dim.x(), ny = dim.y(), nz = dim.z();
  }

  // Interpolates the distance trilinearly, m; the place is in voxels from the first.
  bool read(float x, float y, float z, float& distance) const {
    const int i = static_cast<int>(x), j = static_cast<int>(y), k = static_cast<int>(z);
    if (!(x >= 0 && y >= 0 && z >= 0 && i + 1 < nx && j + 1 < ny && k + 1 < nz)) return false;
    const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j),
                fz = z - static_cast<float>(k);
    const float* d = dense->data() + i + nx * (j + static_cast<std::ptrdiff_t>(ny) * k);
    const std::ptrdiff_t up = static_cast<std::ptrdiff_t>(nx) * ny;
    const auto along_x = [&](const float* at) { return at[0] + fx * (at[1] - at[0]); };
    const auto plane = [&](const float* at) {
      const float low = along_x(at);
      return low + fy * (along_x(at + nx) - low);
    };
    const float low = plane(d);
    distance = low + fz * (plane(d + up) - low);
    return true;
  }

  using Dense = openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ>;
  using Leaves = openvdb::tree::LeafManager<openvdb::FloatTree>;
  Box box;
  double size = 0;
  openvdb::FloatGrid::Ptr grid;
  std::unique_ptr<Leaves> leaves;
  std::unique_ptr<Dense> dense;
  openvdb::Coord first;
  int nx = 0, ny = 0, nz = 0;
};

PixelCloud make_pixel_cloud(const DepthImage& depth, const Camera& camera) {
  PixelCloud cloud{camera, depth, {}, estimate_normals(depth, camera.intrinsics, {})};
  for (std::uint32_t v = 0; v < depth.height; ++v)
    for (std::uint32_t u = 0; u < depth.width; ++u)
      cloud.points.push_back(
          narrow(unproject(camera.intrinsics, u, v, depth.depth[depth.index(u, v)])));
  return cloud;
}

Peers::Peers(const Solid& solid, int voxels)
    : voxels_(std::make_unique<const Voxels>(solid, voxels)) {}
Peers::~Peers() = default;

std::size_t Peers::bytes(bool of_count) const {
  return of_count ? static_cast<std::size_t>(voxels_->grid->memUsage())
                  : static_cast<std::size_t>(voxels_->dense->memUsage());
}

Wrench Peers::penalty(const PixelCloud& cloud, const Pose& tool_to_camera) const {
  const Voxels& grid = *voxels_;
  const Pose back = inverse(tool_to_camera);
  const Rectangle r = pixels_of(grid.box, tool_to_camera, cloud.camera);
  if (r.v1 < r.v0) return {};
  const auto rows = static_cast<std::size_t>(r.v1 - r.v0) + 1;
  std::vector<Wrench> sums(rows);
  const auto scale = static_cast<float>(1 / grid.size);
  const Rotation& m = back.rotation;
  const Vec3f x_row = narrow(m.row0), y_row = narrow(m.row1), z_row = narrow(m.row2);
  const Vec3f t = narrow(back.translation);
  const auto fi = static_cast<float>(grid.first.x()), fj = static_cast<float>(grid.first.y()),
             fk = static_cast<float>(grid.first.z());
  const auto part = [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::size_t at = (static_cast<std::size_t>(r.v0) + row) * cloud.camera.width;
      for (int u = r.u0; u <= r.u1; ++u) {
        const Vec3f& p = cloud.points[at + static_cast<std::size_t>(u)];
        float d = 0;
        if (p.z == 0 ||
            !grid.read((x_row.x * p.x + x_row.y * p.y + x_row.z * p.z + t.x) * scale - fi,
                       (y_row.x * p.x + y_row.y * p.y + y_row.z * p.z + t.y) * scale - fj,
                       (z_row.x * p.x + z_row.y * p.y + z_row.z * p.z + t.z) * scale - fk, d) ||
            d >= 0)
          continue;
        const Vec3 force =
            -static_cast<double>(d) * widen(cloud.normals[at + static_cast<std::size_t>(u)]);
        sums[row].force += force;
        sums[row].torque += cross(widen(p) - tool_to_camera.translation, force);
      }
    }
  };
  constexpr std::size_t kGrain = 16;
  parallel_for(rows, kGrain, part);
  Wrench sum;
  for (const Wrench& row : sums) sum.force += row.force, sum.torque += row.torque;
  return sum;
}

double Peers::count_voxels(const PixelCloud& cloud, const Pose& tool_to_camera) const {
  const Voxels& grid = *voxels_;
  const Intrinsics& k = cloud.camera.intrinsics;
  std::vector<std::size_t> counts(grid.leaves->leafCount());
  const auto part = [&](std::size_t begin, std::size_t end) {
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      for (auto voxel = grid.leaves->leaf(leaf).cbeginValueOn(); voxel; ++voxel) {
        if (*voxel >= 0) continue;
        const openvdb::Coord at = voxel.getCoord();
        const Vec3 p =
            tool_to_camera * (grid.size * Vec3{double(at.x()), double(at.y()), double(at.z())});
        const double u = k.fx * p.x / p.z + k.cx + 0.5, v = k.fy * p.y / p.z + k.cy + 0.5;
        if (!(u >= 0 && v >= 0 && u < cloud.camera.width && v < cloud.camera.height)) continue;
        const float depth = cloud.depth.depth[cloud.depth.index(static_cast<std::uint32_t>(u),
                                                                static_cast<std::uint32_t>(v))];
        counts[leaf] += depth > 0 && p.z > depth;
      }
    }
  };
  constexpr std::size_t kGrain = 64;
  parallel_for(counts.size(), kGrain, part);
  std::size_t count = 0;
  for (const std::size_t of_leaf : counts) count += of_leaf;
  return grid.size * grid.size * grid.size * static_cast<double>(count);
}

}  // namespace vpm::bench
