// Denoises the disks of a cloud without a camera, once per cloud, and finds second planes close to
// them. README.md has the reasons.
#pragma once

#include <span>
#include <vector>

#include "libvpm/scene/points/disk_surface.h"

namespace vpm {

struct DenoisedDisks {
  std::vector<Vec3f> feet, normals;      // one per disk
  std::vector<std::uint32_t> second_of;  // per disk: index into seconds, or kNoPoint
  std::vector<float> radii;              // sampling radius per disk, m
  std::vector<SecondPlane> seconds;
};

// Returns the denoised disks of `measured`, the points as they are with boxes about them, which
// have these sampling radii, m. The result does not depend on the number of threads.
DenoisedDisks settle(const DiskSurface& measured, std::vector<float> radii);

// Returns the measured points themselves as disks.
DenoisedDisks off(const DiskSurface& measured, std::vector<float> radii);

}  // namespace vpm
