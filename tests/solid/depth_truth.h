// Force of the energy of depth between solids that are made of convex parts, exactly.
#pragma once

#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"

namespace vpm::test {

// All x with n.x <= offset; n has unit length.
struct HalfSpace {
  Vec3 n;
  double offset;
};

// Convex part of a solid. From each place in it one of `faces` is the nearest part of the solid's
// surface; other faces only join it to other parts.
struct ConvexPart {
  Solid region;
  std::vector<HalfSpace> faces;
};
using ConvexParts = std::vector<ConvexPart>;

// Returns a convex solid as one part.
ConvexParts one_part(const Solid& convex);
ConvexParts moved(ConvexParts parts, const Pose& pose);

// What two solids share, and the wrench on the first by E = ∫ (w_b d_b + w_a d_a) dV, with w_b the
// square of b's volume divided by the sum of both squares, and w_a = 1 - w_b.
struct DepthTruth {
  double volume = 0;
  Vec3 centroid, force, torque;  // torque about the centroid
  double extent = 0;  // greatest distance of a corner of what is shared from the centroid
};
DepthTruth depth_truth(const ConvexParts& a, const ConvexParts& b, bool with_force = true);

}  // namespace vpm::test
