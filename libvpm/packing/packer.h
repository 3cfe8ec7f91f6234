// Greedy sphere packing: always the largest sphere that fits into the rest of the solid.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Smallest radius searched for, relative to the solid's longest side.
inline constexpr double kNumericalFloor = 0x1p-18;

// Part of the solid's volume that spheres fill when the rest is no longer packed in the order of
// size, but in rough order.
inline constexpr double kNearlyFull = 0.99;

struct PackOptions {
  std::size_t spheres = 1000;  // number delivered, unless another limit comes first
  double coverage = 1;         // stop when spheres fill this fraction of the solid
  double inertia_error = 0;    // stop when InertiaError is at most this; 0: never
  double min_radius = 0;       // m; no smaller sphere is placed
  double max_radius = std::numeric_limits<double>::infinity();  // m; larger ones are cut to it
  const Enclosure* enclosure = nullptr;  // enclosure of the solid, or null to compute it
  // Called between rounds on the calling thread.
  std::function<void(double fraction)> progress = nullptr;
};

enum class StopReason {
  spheres,          // the requested number is reached
  coverage,         // the requested coverage is reached
  inertia_error,    // the requested inertia error is reached
  min_radius,       // no sphere of the smallest radius fits any more
  numerical_floor,  // the rest is below kNumericalFloor of the longest side
};

struct PackResult {
  std::vector<Sphere> spheres;  // largest first, then by centre
  double coverage = 0;          // volume of the spheres / volume of the solid
  StopReason stop = StopReason::spheres;
  // True if there is so much narrow room that only a part of it, spread over the solid, was
  // searched, and spheres more than 1 % larger than the smallest delivered may fit elsewhere. False
  // where the spheres fill kNearlyFull of the solid: then they would add next to nothing.
  bool partly_searched = false;
  // Upper bound of the coverage of any packing of as many spheres: that many of the largest ball,
  // at most 1.
  double coverage_bound = 1;
};

// Packs the solid. No two spheres overlap and none protrudes: radii are exact distances less a
// rounding margin. Each centre is a local maximum of the distance to the mesh and to larger
// spheres, unless max_radius cuts it. The first 200 spheres deviate from that by up to 0.2 % of the
// radius: in tubes, where there is room anywhere, they move along until they touch. A sphere
// precedes one that is more than about 1 % larger only if a local search missed the larger one.
// Once the spheres fill kNearlyFull of the solid, as one does a ball's, the others are many of
// nearly equal size that add next to nothing: they come in the order of about 10 %, none is moved
// into contact, and there may be room for more of their size.
//
// Inside is what the mesh encloses at least once, and volumes refer to that: triangles of a
// self-intersecting mesh are no obstacle in the interior of its union.
//
// Deterministic for any number of threads; a solid scaled by 2^k gives spheres scaled by 2^k to the
// bit. A result with fewer spheres is a prefix of one with more under the same other options,
// except for solids that hold more than twice as many spheres of equal size, and from kNearlyFull
// on. Throws
// Error(invalid_argument) for limits that are not positive numbers, Error(refused) for a solid
// without volume.
PackResult pack(const Solid& solid, const PackOptions& options);

}  // namespace vpm
