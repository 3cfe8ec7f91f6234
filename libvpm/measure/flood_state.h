// The states of a Voronoi cell during a query, by one set of names: as values where one thread owns
// a cell (CPU), as bits where many threads add to it (device).
#pragma once

#include <cstdint>

#include "libvpm/core/host_device.h"

namespace vpm {

// How the surface meets a cell.
enum class CellClass : std::uint8_t {
  free,        // counts for nothing
  cut,         // the surface passes through it: its result counts
  partial,     // behind the surface as far as its result says; counts if the flood reaches it
  uniform,     // behind the plane of its cluster, along whose normal it is pushed, if reached
  whole,       // behind the surface; counts if reached
  no_surface,  // no surface near; its centre decides when the flood comes
};

// Says if the flood has reached a cell, and before that, if it may pass.
enum class FloodState : std::uint8_t {
  closed,   // never passed; free and cut cells too
  reached,  // inside, or hidden
  unknown,  // decided when the flood comes
  middle,   // unknown: the surface sample at the middle of its cluster decides
  open,     // passable, its squared gap is known
  planar,   // passable, its gap is that to the plane of its cluster
  near,  // passable, no place of its cluster is further behind the surface than the tool's radius
};

// The same of a cell on a device, as a word of bits that threads add in any order. Where a camera
// tells what is inside, only `cut`, `counts_points` and `counted` are set; the rest serves the
// flood.
namespace cell_bit {
inline constexpr std::uint32_t cut = 1;      // the surface passes through a piece
inline constexpr std::uint32_t partial = 2;  // pieces are behind it, as far as the sum says
inline constexpr std::uint32_t whole = 4;    // behind the surface
// Behind a surface that may be another one: the plane of the nearest cut cell decides.
inline constexpr std::uint32_t hidden = 8;
inline constexpr std::uint32_t summed = 16;         // the sum of a cut cell is noted
inline constexpr std::uint32_t counts_points = 32;  // the surface may pass the sphere
inline constexpr std::uint32_t reached = 64;        // the flood of a block alone has come
inline constexpr std::uint32_t counted = 128;       // in the result: cut as boundary, else inside
}  // namespace cell_bit

// True if a cell with these bits is inside if the flood reaches it.
VPM_HD constexpr bool may_be_inside(std::uint32_t bits) {
  return (bits & cell_bit::cut) == 0 && (bits & (cell_bit::partial | cell_bit::whole)) != 0;
}
// True if the flood may pass a cell with these bits.
VPM_HD constexpr bool is_passable(std::uint32_t bits) {
  return may_be_inside(bits) && (bits & cell_bit::hidden) == 0;
}

}  // namespace vpm
