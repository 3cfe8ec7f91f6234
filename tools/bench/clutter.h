// A cluttered table before a camera, and random poses of a tool in it: a wall alone flatters, since
// a query's time depends on the steps, edges and holes of the image that lie near the tool.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/pose.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::bench {

// Returns what a Kinect sees of 24 blocks and balls on a table .6 to 1 m away: with its noise, with
// a shadow beside each silhouette, where its projector does not reach, and with holes where light
// is lost, as on glass. The same for any number of threads; only the noise depends on its seed.
inline constexpr std::uint64_t kClutterNoiseSeed = 11;
Cloud make_clutter(std::uint64_t noise_seed = kClutterNoiseSeed);

// Returns the surface of that table, as it truly is.
synthetic::SurfacePtr clutter_surface();

// Returns random poses, each about a point of a cloud with a camera, up to 5 cm away from it along
// each axis, with any rotation. The same for the same cloud and number.
std::vector<Pose> poses_in_clutter(const Cloud& cloud, std::size_t count);

}  // namespace vpm::bench
