// Decides which cells behind the surface the inside flood may pass, and which it enters from a cut
// cell. inside_flood.h holds the traversal.
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

// Returns the squared distance to the surface, m^2; infinite where nothing was measured.
VPM_HD inline double squared_gap(const SurfaceSample& on_surface) {
  return on_surface.known ? on_surface.distance * on_surface.distance : HUGE_VAL;
}

// True if a place at this squared distance, m^2, behind a surface may merely be hidden by it: it is
// further away than the tool's radius. The plane of the nearest cut cell then decides.
VPM_HD inline bool is_hidden_cell(double gap_squared, double tool_reach) {
  return !(gap_squared <= tool_reach * tool_reach);
}

// True if a cell at this squared distance, m^2, from the surface is behind the same sheet as its
// cut neighbour, by the cells' bounding radii, m. Where false, the cut cell's plane decides.
VPM_HD inline bool lies_near_sheet(double gap_squared, double cut_reach, double reach) {
  const double near = kSheetReach * (cut_reach + reach);
  return gap_squared <= near * near;
}

}  // namespace vpm
