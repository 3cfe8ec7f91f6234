// Sums up the disks about another one.
#pragma once

#include <cstdint>
#include <span>

#include "libvpm/core/vec3.h"

namespace vpm {

struct Disk {
  Vec3 place, normal;
};

// Sorts pairs of disks by the cosine between their normals.
inline constexpr double kAlike = 0.9;      // above: one surface; 25 degrees
inline constexpr double kOpposite = -0.8;  // below: two sides of a plate or slot; 143 degrees

// Bounds the height, as a part of the ball's radius, at which another disk shows the same surface.
inline constexpr double kOneSurface = 0.7;

// Sum of planes to be averaged, with the heights of a place above them.
struct PlaneSum {
  Vec3 normal, place;
  double height = 0;
  std::uint32_t count = 0;

  void add(const Disk& disk, Vec3 above) {
    normal += disk.normal;
    place += disk.place;
    height += dot(disk.normal, above - disk.place);
    ++count;
  }
};

// Sums over the disks in a ball about one disk.
struct Neighborhood {
  Vec3 normals;       // sum over alike disks on the same surface
  double height = 0;  // sum of the heights along the disk's normal at which these show it, m
  std::uint32_t alike = 0, unlike = 0;
  PlaneSum opposite;

  std::uint32_t count() const { return alike + unlike + opposite.count; }
};

struct DiskInBall {
  Disk disk;
  double reach = 0;  // radius of the ball, m
};

// Sums up the disks about four disks at once by vectors. `near` holds all in their balls, and
// others.
void look_around(std::span<const Disk> near, const DiskInBall (&disks)[4],
                 Neighborhood (&found)[4]);

}  // namespace vpm
