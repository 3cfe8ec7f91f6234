// A cluttered table before a camera: a wall alone flatters, since a query's time depends on the
// steps, edges and holes of the image that lie near the tool.
#pragma once

#include <cstdint>

#include "libvpm/cloud/cloud.h"
#include "libvpm/synthetic/surface.h"

namespace vpm::bench {

// Returns what a Kinect sees of 24 blocks and balls on a table .6 to 1 m away: with its noise, with
// a shadow beside each silhouette, where its projector does not reach, and with holes where light
// is lost, as on glass. The same for any number of threads; only the noise depends on its seed.
inline constexpr std::uint64_t kClutterNoiseSeed = 11;
Cloud make_clutter(std::uint64_t noise_seed = kClutterNoiseSeed);

// Returns the surface of that table, as it truly is.
synthetic::SurfacePtr clutter_surface();

}  // namespace vpm::bench
