#include "libvpm/packing/validation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/core/parallel.h"
#include "libvpm/core/pose.h"
#include "libvpm/mesh/shells.h"
#include "libvpm/mesh/topology.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/voxel_library.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm {
namespace {

constexpr float kBand = 3;  // voxels on both sides of the surface that carry distances
constexpr int kMargin = 4;  // voxels around the box; more than the band
// Float distances err by up to this, in voxels; a sphere that touches the surface has not crossed
// it.
constexpr double kRounding = 1e-4;
// Distance to the surface, in voxels, below which sides may be disputed: OpenVDB fills gaps of up
// to twice this width.
constexpr double kDisputed = 1.5;

// Lattice rotated against the mesh. Faces along the axes, of which CAD parts are full, would fall
// between two layers of centres or on one, and counts would err alike everywhere. Coordinates in
// voxels; voxel (i, j, k) has its centre at (i, j, k).
struct Lattice {
  Rotation turn = rotation_from_quaternion({0.117, 0.083, 0.151, 0.978});
  Vec3 low;  // after the rotation
  double voxel = 0;
  int nx = 0, ny = 0, nz = 0;

  Vec3 to_index(Vec3 p) const {
    constexpr double kShift = kMargin;
    return (turn * p - low) / voxel + Vec3{kShift, kShift, kShift};
  }
  Vec3 center(double x, double y, double z) const {
    constexpr double kShift = kMargin;
    return transpose(turn) * (low + voxel * Vec3{x - kShift, y - kShift, z - kShift});
  }
};

Lattice lattice_of(const Solid& solid, int voxels) {
  if (solid.vertices.empty()) refuse("the solid has no vertices", "validation");
  Lattice lattice;
  const Vec3 first = solid.vertices.front();
  Box box{first, first}, turned{lattice.turn * first, lattice.turn * first};
  for (const Vec3& p : solid.vertices) {
    box.add(p);
    turned.add(lattice.turn * p);
  }
  lattice.voxel = std::max({box.size().x, box.size().y, box.size().z}) / voxels;
  if (!(lattice.voxel > 0)) refuse("the solid has no extent", "validation");
  lattice.low = turned.low;
  const auto count = [&](double side) {
    return static_cast<int>(std::ceil(side / lattice.voxel)) + 2 * kMargin;
  };
  lattice.nx = count(turned.size().x);
  lattice.ny = count(turned.size().y);
  lattice.nz = count(turned.size().z);
  return lattice;
}

// Shells of equal depth and orientation, voxelised together. OpenVDB fills whatever cannot be
// reached from outside, so shells within others need grids of their own.
struct ShellGroup {
  std::vector<Triangle> triangles;
  int sign = 1;  // -1 for cavities
  std::unique_ptr<VoxelDistances> distances;
};

std::vector<ShellGroup> voxelise(const Solid& solid, const Lattice& lattice) {
  const Topology topology = topology_of(solid.vertices.size(), solid.triangles);
  std::size_t shell_count = 0;
  const std::vector<std::uint32_t> shell = shells_of(topology, shell_count);
  const std::vector<ShellPlace> places =
      place_shells(solid.vertices, shell, shell_count, solid.triangles);
  std::map<std::pair<std::size_t, bool>, ShellGroup> by_place;
  for (std::size_t t = 0; t < solid.triangles.size(); ++t) {
    const ShellPlace& place = places[shell[t]];
    ShellGroup& group = by_place[{place.depth, place.outward}];
    group.sign = place.outward ? 1 : -1;
    group.triangles.push_back(solid.triangles[t]);
  }
  std::vector<Vec3f> points;  // in voxels, exact to a part of kRounding
  for (const Vec3& vertex : solid.vertices) points.push_back(narrow(lattice.to_index(vertex)));
  std::vector<ShellGroup> groups;
  for (auto& [place, group] : by_place) {
    group.distances = voxel_library().distances(points, group.triangles, kBand);
    groups.push_back(std::move(group));
  }
  return groups;
}

// Looks up voxels of one layer.
class Probe {
 public:
  explicit Probe(const std::vector<ShellGroup>& groups) : groups_(groups) {
    for (const ShellGroup& group : groups) readers_.push_back(group.distances->reader());
  }
  // Returns the distance to the surface in voxels, at most kBand; negative inside the solid.
  double distance(int x, int y, int z) {
    int enclosed = 0;
    double nearest = static_cast<double>(kBand);
    for (std::size_t k = 0; k < groups_.size(); ++k) {
      const double distance = static_cast<double>(readers_[k]->at(x, y, z));
      if (distance < 0) enclosed += groups_[k].sign;
      nearest = std::min(nearest, std::abs(distance));
    }
    return enclosed > 0 ? -nearest : nearest;
  }

 private:
  const std::vector<ShellGroup>& groups_;
  std::vector<std::unique_ptr<VoxelDistances::Reader>> readers_;
};

// Counts of one layer of voxels.
struct Layer {
  std::size_t solid_voxels = 0, covered = 0, cut_by_mesh = 0, cut_by_spheres = 0, protruding = 0,
              overlapping = 0, disputed = 0;
  double farthest_out = 0;  // in voxels
  double deepest_overlap = 0;
};

class Count {
 public:
  Count(const Solid& solid, const std::vector<ShellGroup>& groups, const Lattice& lattice,
        const std::vector<Sphere>& spheres)
      : groups_(groups), lattice_(lattice), bvh_(solid.vertices, solid.triangles), winding_(bvh_) {
    for (const Sphere& s : spheres)
      spheres_.push_back({lattice.to_index(s.center), s.radius / lattice.voxel});
  }

  Layer layer(int z) const {
    Layer result;
    std::vector<std::uint32_t> owner(
        static_cast<std::size_t>(lattice_.nx) * static_cast<std::size_t>(lattice_.ny), kNone);
    for (std::uint32_t k = 0; k < spheres_.size(); ++k) paint(k, z, owner, result);
    Probe probe(groups_);
    for (int y = 0; y < lattice_.ny; y += kSquare) {
      for (int x = 0; x < lattice_.nx; x += kSquare) count_square(x, y, z, probe, owner, result);
    }
    return result;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  static constexpr int kSquare =
      8;  // voxels along the edge of a square of a layer that is asked once for the mesh

  // Counts the voxels of the square of layer z whose lowest voxel is (x, y).
  void count_square(int x0, int y0, int z, Probe& probe, const std::vector<std::uint32_t>& owner,
                    Layer& result) const {
    const bool has_mesh = is_near_mesh(x0, y0, z);
    for (int y = y0; y < std::min(y0 + kSquare, lattice_.ny); ++y) {
      for (int x = x0; x < std::min(x0 + kSquare, lattice_.nx); ++x) {
        const double distance = probe.distance(x, y, z);
        const bool inside = distance < 0;
        if (inside) ++result.solid_voxels;
        if (std::abs(distance) < 0.5) ++result.cut_by_mesh;
        result.disputed += has_mesh && is_disputed(lattice_.center(x, y, z), distance);
        if (owner[at(x, y)] == kNone) continue;
        if (inside) ++result.covered;
        if (distance <= kRounding) continue;
        ++result.protruding;
        result.farthest_out = std::max(result.farthest_out, distance);
      }
    }
  }

  // Returns false only if every voxel centre of the square is farther than kDisputed from the mesh,
  // so that no two tests of the inside can disagree there.
  bool is_near_mesh(int x0, int y0, int z) const {
    constexpr double kReach =
        0.5 * (kSquare - 1);  // from the square's middle to its outer voxels, along an axis
    const Vec3 middle = lattice_.center(x0 + kReach, y0 + kReach, z);
    constexpr double kSlack = 0.5;  // OpenVDB changes distances by less when it smooths
    constexpr double kFarthest = std::numbers::sqrt2 * kReach + kDisputed + kSlack;
    return bvh_.closest(middle, kFarthest * lattice_.voxel).triangle != SurfacePoint::kNone;
  }

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(lattice_.nx) +
           static_cast<std::size_t>(x);
  }

  // True if OpenVDB filled the voxel, so that its distance is not that from the mesh.
  bool is_disputed(Vec3 x, double distance) const {
    const bool inside = distance < 0;
    const bool is_near =
        std::abs(distance) < kDisputed ||
        (inside && bvh_.closest(x, kDisputed * lattice_.voxel).triangle != SurfacePoint::kNone);
    return is_near && inside != winding_.inside(x);
  }

  // Marks the voxel centres of the layer that lie in sphere k.
  void paint(std::uint32_t k, int z, std::vector<std::uint32_t>& owner, Layer& result) const {
    const Sphere& s = spheres_[k];
    const double dz = z - s.center.z, disk2 = s.radius * s.radius - dz * dz;
    if (!(disk2 > 0)) return;
    const double disk = std::sqrt(disk2);
    const int y_begin = clamped(std::ceil(s.center.y - disk), lattice_.ny),
              y_end = clamped(std::floor(s.center.y + disk) + 1, lattice_.ny);
    for (int y = y_begin; y < y_end; ++y) {
      const double dy = y - s.center.y, half2 = disk2 - dy * dy;
      if (!(half2 >= 0)) continue;
      const double half = std::sqrt(half2);
      const int x_begin = clamped(std::ceil(s.center.x - half), lattice_.nx),
                x_end = clamped(std::floor(s.center.x + half) + 1, lattice_.nx);
      if (x_end > x_begin)
        result.cut_by_spheres += 2;  // where the row enters and leaves the sphere
      for (int x = x_begin; x < x_end; ++x) claim(k, owner[at(x, y)], result);
    }
  }

  void claim(std::uint32_t k, std::uint32_t& owner, Layer& result) const {
    if (owner == kNone) {
      owner = k;
      return;
    }
    const Sphere &a = spheres_[owner], &b = spheres_[k];
    const double overlap = a.radius + b.radius - norm(a.center - b.center);
    if (overlap <= kRounding) return;
    ++result.overlapping;
    result.deepest_overlap = std::max(result.deepest_overlap, overlap);
  }

  static int clamped(double value, int count) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(count)));
  }

  const std::vector<ShellGroup>& groups_;
  const Lattice& lattice_;
  TriangleBvh bvh_;
  WindingNumber winding_;
  std::vector<Sphere> spheres_;  // in voxels
};

Layer sum_of(const std::vector<Layer>& layers) {
  Layer sum;
  for (const Layer& layer : layers) {
    sum.solid_voxels += layer.solid_voxels;
    sum.covered += layer.covered;
    sum.cut_by_mesh += layer.cut_by_mesh;
    sum.cut_by_spheres += layer.cut_by_spheres;
    sum.protruding += layer.protruding;
    sum.overlapping += layer.overlapping;
    sum.disputed += layer.disputed;
    sum.farthest_out = std::max(sum.farthest_out, layer.farthest_out);
    sum.deepest_overlap = std::max(sum.deepest_overlap, layer.deepest_overlap);
  }
  return sum;
}

}  // namespace

Validation validate_packing(const Solid& solid, const std::vector<Sphere>& spheres, int voxels) {
  const Lattice lattice = lattice_of(solid, voxels);
  const std::vector<ShellGroup> groups = voxelise(solid, lattice);
  const Count count(solid, groups, lattice, spheres);
  std::vector<Layer> layers(static_cast<std::size_t>(lattice.nz));
  parallel_for(layers.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t z = begin; z < end; ++z) layers[z] = count.layer(static_cast<int>(z));
  });
  const Layer sum = sum_of(layers);

  Validation result;
  const double h = lattice.voxel;
  result.voxel = h;
  const auto solid_voxels = static_cast<double>(std::max<std::size_t>(sum.solid_voxels, 1));
  result.volume_mesh = solid_voxels * h * h * h;
  result.coverage = static_cast<double>(sum.covered) / solid_voxels;
  // A voxel with a fraction f inside is counted right on average, with variance f (1 - f); its mean
  // over f is 1/6.
  const double standard_error =
      std::sqrt(static_cast<double>(sum.cut_by_mesh + sum.cut_by_spheres) / 6);
  result.coverage_error = (3 * standard_error + static_cast<double>(sum.disputed)) / solid_voxels;
  result.max_protrusion = sum.farthest_out * h;
  result.max_overlap = sum.deepest_overlap * h;
  result.protruding_voxels = sum.protruding;
  result.overlapping_voxels = sum.overlapping;
  result.disputed_voxels = sum.disputed;
  result.detection_limit = std::sqrt(3.0) * h;
  return result;
}

}  // namespace vpm
