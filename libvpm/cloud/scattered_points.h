// Clouds of points that no camera's grid orders.
#pragma once

#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// Which of its nearest neighbours tells a point's spacing, and the radius of its disk as a fraction
// of that distance. In a square grid the sixth is sqrt(2) spacings away and disks of 0.71 spacings
// cover the surface; in a triangular grid 1 and 0.58. The rest is a margin.
inline constexpr int kSpacingNeighbour = 6;
inline constexpr double kRadiusOfSpacing = 0.7;
// A point far from all others is a stray: no disk is larger than this multiple of the median one.
inline constexpr double kLargestRadius = 10;

// The cloud of positions and normals (of any length, into free space), carried to the world, about
// the middle of its box. Points whose position or normal is not finite, or whose normal is zero,
// are left out. Radii come from the distance to the kSpacingNeighbour-th nearest other position.
// Throws Error(refused) naming `name` where fewer than two different positions remain.
Cloud cloud_of_scattered_points(const std::vector<Vec3>& positions,
                                const std::vector<Vec3>& normals, const Pose& to_world,
                                const std::string& name);

// Radius for each position; points at the same place count once. Needs two different positions.
std::vector<float> sampling_radii(const std::vector<Vec3f>& positions);

}  // namespace vpm
