// The disks of a cloud without a camera, as queries read them: freed of most of their noise, each
// knowing of a second plane close by. Once per cloud. README.md has the reasons and what they gain.
#pragma once

#include <span>
#include <vector>

#include "libvpm/scene/points/disk_surface.h"

namespace vpm {

struct DenoisedDisks {
  std::vector<Vec3f> feet, normals;      // of each disk
  std::vector<std::uint32_t> second_of;  // of each disk: index into seconds, or kNoPoint
  std::vector<float> radii;              // of each disk: of sampling
  std::vector<SecondPlane> seconds;
};

// `measured`: the points as they are, with boxes about them; `radii`: their sampling radii. The
// same for any number of threads.
DenoisedDisks settle(const DiskSurface& measured, std::vector<float> radii);

// The points themselves, in the same form.
DenoisedDisks off(const DiskSurface& measured, std::vector<float> radii);

}  // namespace vpm
