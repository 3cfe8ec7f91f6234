// Greedy sphere packing: always the largest sphere that fits into what is left of the solid.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

#include "libvpm/mesh/outer_surface.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Metres. Spheres smaller than this share of the solid's longest side are not looked for.
inline constexpr double kNumericalFloor = 0x1p-18;

struct PackOptions {
  std::size_t spheres = 1000;  // as many are delivered unless another limit comes first
  double coverage = 1;         // stop where the spheres fill this share of the solid's volume
  double inertia_error = 0;    // stop where the spheres' InertiaError is at most this; 0: never
  double min_radius = 0;       // m; no smaller sphere
  double max_radius = std::numeric_limits<double>::infinity();  // m; larger ones are cut to it
  const Enclosure* enclosure = nullptr;                         // of the solid, where it is known
  std::function<void(double fraction)> progress =
      nullptr;  // called between rounds, on the calling thread
};

enum class StopReason {
  spheres,          // as many as asked for
  coverage,         // the coverage asked for is reached
  inertia_error,    // the inertia tensor is as near as asked for
  min_radius,       // no sphere of the smallest radius fits any more
  numerical_floor,  // what is left is below kNumericalFloor of the longest side
};

struct PackResult {
  std::vector<Sphere> spheres;  // largest first; ties by centre
  double coverage = 0;          // volume of the spheres / volume of the solid
  StopReason stop = StopReason::spheres;
  // The solid is so thin that only a part of its room was looked at, spread over it: larger spheres
  // may fit elsewhere.
  bool partly_searched = false;
  // No packing of as many spheres covers more: so many of the largest ball, at most all.
  double coverage_bound = 1;
};

// No two spheres overlap and none protrudes: radii are exact distances less a rounding margin.
// Every centre is a local maximum of the distance to the mesh and to the larger spheres (where
// max_radius does not cut it), but for the first 200 spheres: in tubes, where there is room
// anywhere, they move along until they touch, for at most .2 % of the radius. A sphere is placed
// before another that is more than about one hundredth larger only where a local search has missed
// the larger one.
//
// Inside is what the mesh encloses at least once, and volumes are of that: triangles of a
// self-intersecting mesh bound no sphere where they lie inside of its union.
//
// Deterministic for any number of threads; a solid scaled by 2^k gives spheres scaled by 2^k to the
// bit. A result with fewer spheres is a prefix of one with more if the other options are the same
// (but for solids that hold more than twice as many spheres of one and the same size).
// Throws Error: usage for limits that are not positive numbers, refused for a solid without volume.
PackResult pack(const Solid& solid, const PackOptions& options);

}  // namespace vpm
