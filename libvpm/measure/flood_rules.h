// Which shares behind the surface the flood may pass, and which it enters from a cut share. One
// definition for host and device; inside_flood.h says in which order they are asked.
#pragma once

#include "libvpm/measure/contact_plane.h"
#include "libvpm/scene/surface.h"

namespace vpm {

// True if a cut cell, by the squared distance of its sphere's centre and the sphere's index, is
// nearer than the nearest so far. Equal distances go to the smaller index, so the order is total.
VPM_HD constexpr bool is_nearer_cut(double squared, std::uint32_t sphere, double least,
                                    std::uint32_t nearest) {
  return squared < least || (squared == least && sphere < nearest);
}

// Squared distance of a place from the surface, m^2; without end where nothing is known.
VPM_HD inline double squared_gap(const SurfaceSample& on_surface) {
  return on_surface.known ? on_surface.distance * on_surface.distance : HUGE_VAL;
}

// A share may be behind a surface that is not the tool's business: one further away than the tool's
// reach only hides it. Then the plane of the nearest cut share decides: before it, the share is out
// of sight, not inside.
VPM_HD inline bool is_hidden_cell(double gap_squared, double tool_reach) {
  return !(gap_squared <= tool_reach * tool_reach);
}

// Whether the surface that cuts one share is what another lies behind, as far as distance tells:
// where it does not, the cut share's plane does.
VPM_HD inline bool lies_near_sheet(double gap_squared, double cut_reach, double reach) {
  const double near = kSheetReach * (cut_reach + reach);
  return gap_squared <= near * near;
}

}  // namespace vpm
