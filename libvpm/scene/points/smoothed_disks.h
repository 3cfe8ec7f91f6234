// The first part of settling a cloud's disks (denoised_disks.h): each takes the mean of those about
// it that face its way, but not of those whose normals were estimated across a crease.
#pragma once

#include <vector>

#include "libvpm/scene/points/denoised_disks.h"
#include "libvpm/scene/points/disk_windows.h"

namespace vpm {

enum class DiskKind : std::uint8_t {
  stray,    // hardly any are like it: of no surface that the cloud shows
  outlier,  // few are, and others about it face elsewhere
  bent,     // others about it face elsewhere: at a crease, or on what is as small as the window
  smooth,   // few of those about it do
  clear,    // and few face elsewhere than the mean about it does, which knows less of noise
};
inline bool is_smooth(DiskKind kind) {
  return kind >= DiskKind::smooth;
}

// Smooths the disks in `result`, which are as measured, and says of which kind each is. Those that
// face each other from the sides of a plate or a slot learn of each other's planes.
std::vector<DiskKind> smooth(const DiskWindows& windows, DenoisedDisks& result);

}  // namespace vpm
