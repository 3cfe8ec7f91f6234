// The volume share of every sphere: all points of the solid whose nearest sphere surface is its
// own.
#pragma once

#include <span>
#include <vector>

#include "libvpm/graph/gap_segments.h"
#include "libvpm/model/solid.h"

namespace vpm {

// How well the sampled gap agrees with the exact integrals before it is scaled and shifted to them.
struct ShareQuality {
  double gap_fraction = 0;  // of the solid's volume, exact
  double volume_error = 0;  // (sampled gap - exact gap) / volume of the solid
  double centroid_error =
      0;  // distance of the centroids of shares and solid / cube root of the volume
  double share_sum_error = 0;  // |sum of the shares - volume| / volume, as stored
};

// Normalised coordinates. A share is its ball, exactly, and its part of the gap.
struct Shares {
  GapSegments gap;                       // segments by sphere; centres shifted
  std::vector<std::uint32_t> gap_begin;  // spheres + 1
  double gap_scale = 0;                  // a segment's volume in the share / volume of its prism
  std::vector<double> volume;
  std::vector<Vec3> centroid;
  std::vector<double> reach;  // of the share's points from the sphere's centre, >= the radius
  ShareQuality quality;
};

// The volumes sum to `mass.volume`, the centroids weighted by them to its centre of mass.
// `spacing` as for find_gap_segments. Throws Error(refused) where the spheres hold more than the
// solid.
Shares find_shares(const Solid& solid, const MassProperties& mass, const SphereBvh& bvh,
                   double spacing);

}  // namespace vpm
