#include "libvpm/mesh/voxel_repair.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/mesh/shells.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/voxel_surface.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm {
namespace {

constexpr double kBand = double{kVoxelBand};
// Slope of the field in voxels per winding number. In a hole the number falls from 1 to 0 over
// about the hole's width, and the surface goes where it is one half. On triangles it jumps; with
// this slope their distance decides there.
constexpr double kVoxelsPerWinding = 2 * kBand;
// Distance of the winding number from one half at which the centre and corners of a block without
// triangles decide for the whole block.
constexpr double kClear = 0.1;

float cut_off(double voxels) {
  return static_cast<float>(std::clamp(voxels, -kBand, kBand));
}

double half_diagonal(double half_edge) {
  return std::sqrt(3.0) * half_edge;
}

class WindingField : public VoxelField {
 public:
  WindingField(const Solid& mesh, double voxel)
      : voxel_(voxel), bvh_(mesh.vertices, mesh.triangles), winding_(bvh_) {}

  float at(Vec3 p) const override {
    const double distance = bvh_.closest(p, kBand * voxel_).distance / voxel_;
    const double beyond = kVoxelsPerWinding * (winding_.at(p) - 0.5);
    const double size = std::min({distance, std::abs(beyond), kBand});
    return static_cast<float>(beyond > 0 ? -size : size);
  }

  float everywhere(Vec3 middle, double half_edge) const override {
    const double search_radius = half_diagonal(half_edge) + kBand * voxel_;
    if (bvh_.closest(middle, search_radius).triangle != SurfacePoint::kNone) return 0;
    const bool inside = winding_.at(middle) > 0.5;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 towards{corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0};
      const double clear = winding_.at(middle + half_edge * towards) - 0.5;
      if ((inside ? clear : -clear) < kClear) return 0;
    }
    return inside ? -kVoxelBand : kVoxelBand;
  }

 private:
  double voxel_;
  TriangleBvh bvh_;
  WindingNumber winding_;
};

// Field whose inside is nearer to the mesh than `radius`, on either side.
class CoatField : public VoxelField {
 public:
  CoatField(const Solid& mesh, double voxel, double radius)
      : voxel_(voxel), radius_(radius), bvh_(mesh.vertices, mesh.triangles) {}

  float at(Vec3 p) const override {
    return cut_off((bvh_.closest(p, radius_ + kBand * voxel_).distance - radius_) / voxel_);
  }

  float everywhere(Vec3 middle, double half_edge) const override {
    const double half = half_diagonal(half_edge), beyond = half + radius_ + kBand * voxel_;
    const double distance = bvh_.closest(middle, beyond).distance;
    if (distance >= beyond) return kVoxelBand;
    return distance + half <= radius_ - kBand * voxel_ ? -kVoxelBand : 0;
  }

 private:
  double voxel_, radius_;
  TriangleBvh bvh_;
};

// Field whose inside lies deeper than `radius` within a closed surface.
class CoreField : public VoxelField {
 public:
  CoreField(const Solid& coat, double voxel, double radius)
      : voxel_(voxel), radius_(radius), bvh_(coat.vertices, coat.triangles), winding_(bvh_) {}

  float at(Vec3 p) const override {
    if (!winding_.inside(p)) return kVoxelBand;
    return cut_off((radius_ - bvh_.closest(p, radius_ + kBand * voxel_).distance) / voxel_);
  }

  float everywhere(Vec3 middle, double half_edge) const override {
    const double half = half_diagonal(half_edge), beyond = half + radius_ + kBand * voxel_;
    const double distance = bvh_.closest(middle, beyond).distance;
    if (distance > half && !winding_.inside(middle)) return kVoxelBand;
    if (distance >= beyond) return -kVoxelBand;
    return distance + half <= radius_ - kBand * voxel_ ? kVoxelBand : 0;
  }

 private:
  double voxel_, radius_;
  TriangleBvh bvh_;
  WindingNumber winding_;
};

// Returns the outermost shells, which stop the flood from outside.
Solid outermost_shells(const Solid& surface) {
  const Topology topology = topology_of(surface.vertices.size(), surface.triangles);
  std::size_t count = 0;
  const std::vector<std::uint32_t> shell = shells_of(topology, count);
  const std::vector<ShellPlace> places =
      place_shells(surface.vertices, shell, count, surface.triangles);
  Solid outer{surface.vertices, {}};
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (places[shell[t]].depth == 0) outer.triangles.push_back(surface.triangles[t]);
  return outer;
}

void check_resolution(int voxels) {
  if (voxels >= kMinRepairVoxels && voxels <= kMaxRepairVoxels) return;
  throw Error(ErrorKind::invalid_argument,
              "the voxels along the longest side must lie between " +
                  std::to_string(kMinRepairVoxels) + " and " + std::to_string(kMaxRepairVoxels),
              "repair");
}

void compare(const Solid& solid, const Solid& mesh, VoxelRepair& done) {
  if (solid.triangles.empty()) return;
  done.solid_to_mesh = farthest_from_surface(solid, mesh, 0.5 * done.voxel);
  done.mesh_to_solid = farthest_from_surface(mesh, solid, 0.5 * done.voxel);
}

}  // namespace

bool orient_outward(Solid& mesh) {
  const Topology topology = topology_of(mesh.vertices.size(), mesh.triangles);
  if (!topology.conflicting.empty() &&
      orient_consistently(topology, mesh.triangles) == kNotOrientable)
    return false;
  if (mass_properties(mesh).volume >= 0) return true;
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return true;
}

Solid repair_by_winding_number(const Solid& mesh, int voxels, VoxelRepair& done) {
  check_resolution(voxels);
  const VoxelBox box = box_of_mesh(mesh, voxels);
  done.voxel = box.voxel;
  Solid solid = voxel_surface(WindingField(mesh, box.voxel), box);
  compare(solid, mesh, done);
  return solid;
}

Solid repair_by_flood(const Solid& mesh, int voxels, double width, VoxelRepair& done) {
  check_resolution(voxels);
  VoxelBox box = box_of_mesh(mesh, voxels);
  done.voxel = box.voxel;
  done.max_hole = width;
  const double radius = 0.5 * width;
  if (!(width >= kNarrowestFlood * box.voxel)) {
    throw Error(ErrorKind::invalid_argument, "a flood closes holes of at least two voxels",
                "repair", "give a wider hole or more voxels");
  }
  // The coat is the surface of the centres of balls that touch the mesh from outside.
  const Vec3 around = radius * Vec3{1, 1, 1};
  const VoxelBox wide{box.low - around, box.high + around, box.voxel};
  const Solid coat = outermost_shells(voxel_surface(CoatField(mesh, box.voxel, radius), wide));
  Solid solid = voxel_surface(CoreField(coat, box.voxel, radius), box);
  compare(solid, mesh, done);
  return solid;
}

}  // namespace vpm
