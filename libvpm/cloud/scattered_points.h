// Clouds of points that no camera's grid orders.
#pragma once

#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// A point's disk radius is kRadiusOfSpacing times the distance to its kSpacingNeighbour-th nearest
// neighbour. In a square grid that is 0.7 sqrt(2) = 0.99 spacings, and 0.71 cover the surface; in a
// triangular grid 0.7, and 0.58 cover it. The rest is margin.
inline constexpr int kSpacingNeighbour = 6;
inline constexpr double kRadiusOfSpacing = 0.7;
// Limits a disk to this multiple of the median radius, since a point far from all others is a
// stray.
inline constexpr double kLargestRadius = 10;

// Returns the cloud of the given positions and normals (any length, into free space), transformed
// to the world; its origin is the centre of their bounding box. Drops points with a position or
// normal that is not finite, or a zero normal. Throws Error(refused), naming `name`, if fewer than
// two distinct positions remain.
Cloud cloud_of_scattered_points(const std::vector<Vec3>& positions,
                                const std::vector<Vec3>& normals, const Pose& to_world,
                                const std::string& name);

// Returns the radius of each position's disk, m. Coinciding points count once. Needs two distinct
// positions.
std::vector<float> sampling_radii(const std::vector<Vec3f>& positions);

}  // namespace vpm
