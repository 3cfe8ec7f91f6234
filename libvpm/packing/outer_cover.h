// Spheres that together hold all of a solid, with a proof.
//
// The solid is cut into pieces by cells of its bounding box; a piece is known by balls whose convex
// hull holds it (solid_cells.h). A set of spheres covers the solid if every piece lies wholly in
// one of them. Pieces are gathered into as many groups as spheres are asked for, each in the
// smallest sphere about it that is found.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Returns exactly `count` spheres, largest first, that hold every point of the solid. The same for
// any number of threads. `enclosure` is that of the solid, or null to compute it. Throws
// Error(refused) for a solid without volume.
std::vector<Sphere> cover(const Solid& solid, std::size_t count,
                          const Enclosure* enclosure = nullptr,
                          const std::function<void(double fraction)>& progress = {});

// Proof that spheres hold a solid, which knows nothing of how they were found.
struct CoverCertificate {
  // True if the solid's bounding box was divided into cells, of each of which all that it has of
  // the solid lies wholly in one sphere. This is a bound, not a sample: no point is left out.
  bool holds = false;
  std::size_t cells = 0;  // of the division
  Vec3 open;              // where it does not hold: a place near which a point may lie in no sphere
};

// Divides the bounding box until every cell is outside, or in a sphere. Numbers are taken with the
// tolerance of a packing's certificate, on the safe side: spheres pass that hold the solid with
// that much to spare, as those of cover() do. Cells are divided down to 2^-14 of the longest side.
CoverCertificate certify_cover(const Solid& solid, const std::vector<Sphere>& spheres,
                               const Enclosure* enclosure = nullptr);

// How spheres and a solid overlap, as the fits of others are reported; fractions of the solid's
// volume, measured along 512 × 512 lines through both.
struct CoverShares {
  double covered = 0;     // of the solid's volume, in at least one sphere
  double protruding = 0;  // volume of the spheres' union outside of the solid
};
CoverShares cover_shares(const Solid& solid, const std::vector<Sphere>& spheres,
                         const Enclosure* enclosure = nullptr);

}  // namespace vpm
