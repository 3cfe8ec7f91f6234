// Voronoi cells of the spheres of a packing.
//
// The cell of a sphere is the set of points of the solid that are nearer to its surface than to any
// other sphere's: the additively weighted (Apollonius) diagram, clipped to the solid. It consists
// of the ball, which is exact, and a part of the gap, which is sampled.
#pragma once

#include <span>
#include <vector>

#include "libvpm/graph/gap_segments.h"
#include "libvpm/model/solid.h"

namespace vpm {

// Errors of the sampled gap before it is scaled and shifted to the exact integrals.
struct VoronoiQuality {
  double gap_fraction = 0;  // volume of the gap / volume of the solid, exact
  double volume_error = 0;  // (sampled - exact volume of the gap) / volume of the solid
  // Distance of the cells' common centroid from the solid's / cube root of the volume.
  double centroid_error = 0;
  // |sum of the cells' volumes - volume| / volume, as stored.
  double volume_sum_error = 0;
};

// Cells by sphere, in normalised coordinates.
struct VoronoiCells {
  GapSegments gap;       // centres shifted
  double gap_scale = 0;  // a segment's volume in the cell / volume of its prism
  std::vector<double> volume;
  std::vector<Vec3> centroid;
  // Largest distance of a cell's points from its sphere's centre; at least the sphere's radius.
  std::vector<double> radius;
  VoronoiQuality quality;
};

// Returns the cells. Their volumes sum to `mass.volume`, and their centroids weighted by volume
// give its centre of mass. `spacing` as for find_gap_segments. Throws Error(refused) if the spheres
// hold more than the solid.
VoronoiCells find_voronoi_cells(const Solid& solid, const MassProperties& mass,
                                const SphereBvh& bvh, double spacing);

}  // namespace vpm
