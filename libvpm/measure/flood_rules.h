// Names the states of a Voronoi cell during a query, and decides which cells behind the surface the
// inside flood may pass, and which it enters from a cut cell. inside_flood.h holds the traversal.
#pragma once

#include <cstdint>

#include "libvpm/core/fixed_sum.h"
#include "libvpm/core/host_device.h"
#include "libvpm/core/vec3.h"
#include "libvpm/scene/body.h"

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
  closed,    // never passed; free and cut cells too
  reached,   // inside, or hidden
  enclosed,  // not reached, but inside of what the body encloses
  unknown,   // decided when the flood comes
  middle,    // unknown: the surface sample at the middle of its cluster decides
  open,      // passable, its squared gap is known
  planar,    // passable, its gap is that to the plane of its cluster
  near,      // passable, no place of its cluster is further behind the surface than the tool radius
};

// Returns the class of a cell on this side of the surface that needs no measuring: not of one that
// is ambiguous.
VPM_HD constexpr CellClass class_on_side(Side side) {
  return side == Side::behind       ? CellClass::whole
         : side == Side::no_surface ? CellClass::no_surface
                                    : CellClass::free;
}

// The same of a cell on a device, as a word of bits that threads add in any order. Where a camera
// tells what is inside, only `cut` and `counted` are set; the rest serves the flood.
namespace cell_bit {
inline constexpr std::uint32_t cut = 1;      // the surface passes through a piece
inline constexpr std::uint32_t partial = 2;  // pieces are behind it, as far as the sum says
inline constexpr std::uint32_t whole = 4;    // behind the surface
// Behind a surface that may be another one: the plane of the nearest cut cell decides.
inline constexpr std::uint32_t hidden = 8;
inline constexpr std::uint32_t summed = 16;     // the sum of a cut cell is noted
inline constexpr std::uint32_t reached = 32;    // the flood of a block alone has come
inline constexpr std::uint32_t counted = 64;    // in the result: cut as boundary, else inside
inline constexpr std::uint32_t enclosed = 128;  // the body encloses it
}  // namespace cell_bit

// True if a cell with these bits is inside if the flood reaches it.
VPM_HD constexpr bool may_be_inside(std::uint32_t bits) {
  return (bits & cell_bit::cut) == 0 && (bits & (cell_bit::partial | cell_bit::whole)) != 0;
}
// True if the flood may pass a cell with these bits.
VPM_HD constexpr bool is_passable(std::uint32_t bits) {
  return may_be_inside(bits) && (bits & cell_bit::hidden) == 0;
}

// Distance from a cell's centre, in bounding radii of the cell, within which a surface is surely
// the one that cuts the cell.
inline constexpr double kSheetReach = 3;

// Holds the mean plane of the surface inside a cell.
struct ContactPlane {
  // Sums unit normals, and feet relative to the cell's centre in units of its bounding radius, over
  // the samples that are cut. |terms| < 8, so 2^20 samples fit.
  using Sum = FixedSum<40>;
  Sum normal[3], foot[3];
  std::int64_t count = 0;

  VPM_HD void add(Vec3 n, Vec3 relative_foot) {
    normal[0].add(n.x), normal[1].add(n.y), normal[2].add(n.z);
    foot[0].add(relative_foot.x), foot[1].add(relative_foot.y), foot[2].add(relative_foot.z);
    ++count;
  }
  VPM_HD Vec3 normals() const { return {normal[0].real(), normal[1].real(), normal[2].real()}; }
  // Returns the mean foot. Requires count > 0.
  VPM_HD Vec3 mean_foot() const {
    const double per = 1 / static_cast<double>(count);
    return {per * foot[0].real(), per * foot[1].real(), per * foot[2].real()};
  }
  // Returns the height of a place above the plane, negative behind it. Place and height are
  // relative to the cell's centre, in units of its bounding radius.
  VPM_HD double height(Vec3 relative) const {
    return dot(normalized_or_zero(normals()), relative - mean_foot());
  }
  // True if a place lies behind the plane and the surface point that hides it is at most `near` in
  // front of it, so that both belong to one surface. False without a plane. Units as for height().
  VPM_HD bool supports(Vec3 relative, Vec3 hiding, double near) const {
    return count > 0 && height(relative) < 0 && height(hiding) <= near;
  }
};

// Describes a cut cell in the surface's frame, m. Its plane decides about places that are far
// behind the surface or occluded.
struct CutCell {
  ContactPlane plane;
  Vec3 center;
  double radius = 0;

  VPM_HD Vec3 relative(Vec3 x) const { return 1 / radius * (x - center); }
  // True if a place lies behind the plane, so that the flood may go there.
  VPM_HD bool is_behind(Vec3 x) const { return plane.height(relative(x)) < 0; }
  VPM_HD bool supports(Vec3 x, Vec3 hiding, double near) const {
    return plane.supports(relative(x), relative(hiding), near / radius);
  }
};

// True if a cut cell, by the squared distance of its sphere's centre and the sphere's index, is
// nearer than the nearest so far. Equal distances go to the smaller index, so the order is total.
VPM_HD constexpr bool is_nearer_cut(double squared, std::uint32_t sphere, double least,
                                    std::uint32_t nearest) {
  return squared < least || (squared == least && sphere < nearest);
}

// Returns the squared distance to the surface, m^2; infinite where nothing was measured.
VPM_HD inline double squared_gap(const SurfaceSample& on_surface) {
  return on_surface.known ? on_surface.distance * on_surface.distance : HUGE_VAL;
}

// True if a place at this squared distance, m^2, behind a surface may merely be hidden by it: it is
// further away than the tool radius. The plane of the nearest cut cell then decides.
VPM_HD inline bool is_hidden_cell(double gap_squared, double tool_radius) {
  return !(gap_squared <= tool_radius * tool_radius);
}

// True if a cell at this squared distance, m^2, from the surface is behind the same sheet as its
// cut neighbour, by the cells' bounding radii, m. Where false, the cut cell's plane decides.
VPM_HD inline bool lies_near_sheet(double gap_squared, double cut_radius, double radius) {
  const double near = kSheetReach * (cut_radius + radius);
  return gap_squared <= near * near;
}

// True if the flood enters a cell from a cut neighbour: both are near one sheet, or the neighbour's
// plane has the cell behind it, which is_behind() tells where it is needed.
template <class IsBehind>
VPM_HD bool enters(double gap_squared, double cut_radius, double radius,
                   const IsBehind& is_behind) {
  return lies_near_sheet(gap_squared, cut_radius, radius) || is_behind();
}
// True if the flood passes a cell behind the surface: it is no further behind than the tool's
// radius, or the plane of the nearest cut cell has it behind it.
template <class IsBehind>
VPM_HD bool passes(bool is_hidden, const IsBehind& is_behind) {
  return !is_hidden || is_behind();
}

}  // namespace vpm
