// Defines the winding number of a cloud's disks: how often the surface that they sample encloses a
// place, and so on which side the place is, however far from the surface. Distant groups of disks
// count by their moments (Barill, Dickson, Schmidt, Levin, Jacobson 2018, "Fast winding numbers
// for soups and clouds"). For host and device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/solid_angle.h"
#include "libvpm/core/vec3.h"
#include "libvpm/scene/points/point_tree.h"

namespace vpm {

// Describes a disk as a dipole.
struct alignas(16) WindingDisk {
  Vec3f center;   // about the cloud's origin, m
  float rim = 0;  // squared radius, m^2: nearer than that it is no dipole
  Vec3f area;     // its area times its normal, m^2
};

// Describes the disks of a tree node by their moments about a centre, to the second order: of a
// flat group the second one vanishes, of one about an edge it does not.
struct alignas(16) WindingNode {
  Vec3f center;   // mean by area, about the cloud's origin, m
  float far = 0;  // squared distance, m^2, from which on the moments stand for the disks
  Vec3f area;     // sum of the areas times their normals, m^2
  // Symmetric part without trace of the sum of the areas times their offsets times their normals,
  // m^3: xx, xy, xz, yy, yz, zz.
  float moment[6] = {};

  // Returns the solid angle as seen from the origin, the centre being at `to`.
  VPM_HD double angle(Vec3 to, double squared) const {
    const Vec3 turned{moment[0] * to.x + moment[1] * to.y + moment[2] * to.z,
                      moment[1] * to.x + moment[3] * to.y + moment[4] * to.z,
                      moment[2] * to.x + moment[4] * to.y + moment[5] * to.z};
    return dipole_angle(widen(area) - 3 / squared * turned, to, squared);
  }
};

// Holds plain pointers to a cloud's dipoles, for host or device.
struct DiskWinding {
  // Above this number a place may be inside of something that was not seen as a whole. Right behind
  // a wide wall the number is 1/2; it is half of that where all within 60 degrees of one direction
  // is wall, and far above the hundredths by which it errs outside of a closed surface.
  static constexpr double kMayBeInside = 0.25;

  const WindingDisk* disks = nullptr;   // in the order of the tree's points
  const WindingNode* nodes = nullptr;   // of the tree, as its boxes
  std::uint32_t count = 0, leaves = 0;  // as in PointTree; 0: there is no surface
  // True if the disks may enclose some place: not of scans that show one side of everything.
  bool may_enclose = false;
  // True if free space lies amid the disks, as in a scanned room: there the number is -1, and 0 is
  // not outside but behind the walls.
  bool may_surround = false;

  // Returns the winding number at a place about the cloud's origin: 1 inside of a closed surface
  // and 0 outside, to some hundredths; behind an open one what it covers of all directions. On the
  // surface it is the mean of both sides.
  VPM_HD double at(Vec3 x) const {
    std::uint32_t stack[NodeStack::kRoom + 1];
    int size = 0;
    double sum = 0;
    const auto push_children = [&](std::uint32_t node, std::uint32_t first) {
      for (std::uint32_t k = first; k < 4; ++k) stack[size++] = 4 * node + k;
    };
    if (count > 0 && (leaves & PointTree::kEvenLevels) != 0)
      stack[size++] = 1;
    else if (count > 0)
      push_children(0, 2);
    while (size > 0) {
      const std::uint32_t node = stack[--size];
      const WindingNode& all = nodes[node];
      const Vec3 to = widen(all.center) - x;
      const double squared = squared_norm(to);
      if (squared > all.far) {
        sum += all.angle(to, squared);
      } else if (node < leaves) {
        push_children(node, 0);
      } else {
        const std::uint32_t begin = (node - leaves) * PointTree::kLeafSize;
        for (std::uint32_t i = begin; i < begin + PointTree::kLeafSize && i < count; ++i)
          sum += angle_of(disks[i], x);
      }
    }
    return sum / kFullSolidAngle;
  }

 private:
  // Returns the solid angle of a disk. Nearer than its rim it grows no more, and vanishes at its
  // middle, where either side sees half of all directions.
  VPM_HD static double angle_of(const WindingDisk& disk, Vec3 x) {
    const Vec3 to = widen(disk.center) - x;
    const double squared = squared_norm(to), rim = disk.rim;
    return squared > 0 ? dipole_angle(widen(disk.area), to, squared > rim ? squared : rim) : 0;
  }
};

class DiskWindows;

// Holds the dipoles of a cloud. Immutable.
class DiskDipoles {
 public:
  DiskDipoles() = default;
  // Estimates the area of each disk from how many there are about it.
  explicit DiskDipoles(const DiskWindows& windows);

  DiskWinding winding() const {
    return {disks_.data(), nodes_.data(), count_, leaves_, may_enclose_, may_surround_};
  }
  const std::vector<WindingDisk>& disks() const { return disks_; }
  const std::vector<WindingNode>& nodes() const { return nodes_; }
  // Returns the disks of inner faces, ascending: a surface in its whole neighbourhood is inside of
  // another one, as where solids overlap that were each scanned as a whole.
  const std::vector<std::uint32_t>& inner() const { return inner_; }

 private:
  void find_sides(const PointTree& tree);

  std::vector<WindingDisk> disks_;
  std::vector<WindingNode> nodes_;
  std::vector<std::uint32_t> inner_;
  std::uint32_t count_ = 0, leaves_ = 0;
  bool may_enclose_ = false, may_surround_ = false;
};

}  // namespace vpm
