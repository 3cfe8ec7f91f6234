// How much of a tool lies behind a depth image: a brute-force count of its places.
#pragma once

#include <span>

#include "libvpm/cloud/camera.h"
#include "libvpm/cloud/depth_image.h"
#include "libvpm/core/pose.h"

namespace vpm::bench {

// Parts of the places. It takes the shadow of an object for its inside, as Shadows::solid does.
struct ProjectiveCount {
  double behind = 0;  // the depth of the nearest pixel
  double shadow = 0;  // of those: further than the tool's reach behind it
};

// `places` are the tool's, spread evenly over it; those before a pixel without depth, or before
// none, are not behind.
ProjectiveCount count_behind(std::span<const Vec3> places, double reach, const Pose& pose,
                             const DepthImage& depth, const Camera& camera);

}  // namespace vpm::bench
