// What the disks about another one say of the surface there.
#pragma once

#include <cstdint>
#include <span>

#include "libvpm/core/vec3.h"

namespace vpm {

struct Disk {
  Vec3 place, normal;
};

// By the angle between their normals, two disks
inline constexpr double kAlike = 0.9;  // are of one surface: its cosine; 25 degrees, as in an image
inline constexpr double kOpposite = -0.8;  // bound a plate or a slot; 143 degrees

// What one disk gives for the height of the surface at another one is of the same surface up to
// this part of their ball's radius.
inline constexpr double kOneSurface = 0.7;

// Planes to be averaged: each tells how high a place lies above it.
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

// Sums over the disks in a ball about one of them.
struct Neighborhood {
  Vec3 normals;       // of those alike, on the same surface
  double height = 0;  // of the surface at the disk, along its normal, as each of them has it
  std::uint32_t alike = 0, unlike = 0;
  PlaneSum opposite;

  std::uint32_t count() const { return alike + unlike + opposite.count; }
};

struct DiskInBall {
  Disk disk;
  double reach = 0;  // radius of the ball
};

// Of four disks side by side, by vectors: `near` holds all that lie in their balls, and others.
void look_around(std::span<const Disk> near, const DiskInBall (&disks)[4],
                 Neighborhood (&found)[4]);

}  // namespace vpm
