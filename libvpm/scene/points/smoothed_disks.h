// Takes the first step of denoising disks (denoised_disks.h): each becomes the mean of those about
// it that face its way, except those whose normals were estimated across a crease.
#pragma once

#include <vector>

#include "libvpm/scene/points/denoised_disks.h"
#include "libvpm/scene/points/disk_windows.h"

namespace vpm {

enum class DiskKind : std::uint8_t {
  stray,    // hardly any disks about it are alike: on no surface of the cloud
  outlier,  // few disks about it are alike, and others face elsewhere
  bent,     // many disks about it face elsewhere: at a crease, or on something small
  smooth,   // few disks about it face elsewhere
  clear,    // few disks about it face elsewhere than their mean
};
inline bool is_smooth(DiskKind kind) {
  return kind >= DiskKind::smooth;
}

// Smooths the disks in `result`, which are as measured, and returns the kind of each. Disks on both
// sides of a plate or slot receive each other's plane as second plane.
std::vector<DiskKind> smooth(const DiskWindows& windows, DenoisedDisks& result);

}  // namespace vpm
