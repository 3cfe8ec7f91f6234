// Tells pairs of triangles of different surfaces apart, four at a time.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/solid/triangle_crossing.h"

namespace vpm {

// Names a triangle of each of two surfaces that may cross each other, by its place in a list of its
// surface's.
struct CandidatePair {
  std::uint32_t a, b;
};

// Keeps those pairs of two lists of triangles, whose boxes must overlap, that doubles do not tell
// to be apart, in their order, and fills `signs` with what doubles tell of each of these. Nothing
// that follows from signs depends on how many doubles tell: exact ones decide what they leave open.
void drop_apart(std::span<const PlacedTriangle> a, std::span<const PlacedTriangle> b,
                std::vector<CandidatePair>& pairs, std::vector<PairSigns>& signs);

}  // namespace vpm
