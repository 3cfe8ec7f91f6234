// Defines what a part of the tool adds to a contact, and a contact before it is listed.
#pragma once

#include <vpm/query_types.h>

#include <cstddef>
#include <cstdint>

#include "libvpm/core/host_device.h"
#include "libvpm/measure/classify.h"
#include "libvpm/measure/flood_rules.h"
#include "libvpm/measure/tool_piece.h"

namespace vpm {

// A connected patch of what a tool shares with a body of a scene, or several of one body, in world
// axes and about the tool's centre of mass. Its wrench is that for a stiffness of 1.
struct ContactPatch {
  std::size_t body = 0;  // place in the scene's list
  double volume = 0;     // m^3
  Vec3 centroid;         // world's frame, m
  Vec3 area;             // Contact::normal times Contact::area, m^2
  double depth = 0;      // m
  Wrench wrench;
  std::uint32_t patches = 1;  // that are summed
};

// Returns the mean plane of the surface in a cut cell.
VPM_HD inline ClipPlane mean_plane_of(const CutCell& cut, const Pose& to_surface) {
  const Vec3 foot = cut.center + cut.radius * cut.plane.mean_foot();
  return {{normalized_or_zero(cut.plane.normals()), foot}, to_surface};
}

// Sums the parts of a cell's samples behind its mean plane, and where the plane cuts them. Weights
// are as those of ClippedMoments; weights and moments only tell the ratio of the two, since the
// cell counts by what the surface itself cuts. Real is double, or a vector, whose lanes are sums of
// their own.
template <class Real>
struct CellSectionOf {
  Real weight{};
  PlaceOf<Real> moment{Real{}, Real{}, Real{}};  // with cut samples at their middles
  Real below{};    // how much further behind, against the plane's normal, their parts are
  Real section{};  // rate at which the weight grows as the plane rises, 1/m

  // Adds a sample with its middle at `center`, about the tool's centre of mass; returns whether a
  // part of it is behind the plane.
  template <class Shape>
  [[gnu::always_inline]] VPM_HD MaskOf<Real> add(const Shape& shape, const PlaceOf<Real>& center,
                                                 const Real& sample_weight,
                                                 const ClipPlane& plane) {
    const Real distance = dot(plane.normal, center) + plane.height;
    MaskOf<Real> is_cut{};
    const Real behind = weight_behind(shape, plane.normal, distance, sample_weight, is_cut),
               below_it = sample_weight * shape.moment_of_cut(distance, plane.normal),
               section_of_it = sample_weight * shape.section_of_cut(distance, plane.normal);
    weight += behind;
    moment = moment + behind * center;
    below += is_cut ? below_it : Real{};
    section += is_cut ? section_of_it : Real{};
    return behind > Real{};
  }
  // Adds a block of samples that are all behind it.
  VPM_HD void add(const BlockMass& mass) {
    weight += mass.weight;
    moment += mass.weight * mass.centroid;
  }
  // Returns the centroid of what is behind the plane, about the tool's centre of mass, m. Requires
  // weight > 0.
  VPM_HD Vec3 centroid(const ClipPlane& plane) const {
    return 1 / weight * (moment - below * plane.normal);
  }
};
using CellSection = CellSectionOf<double>;

// Sums what cells give of one contact, in the tool's axes.
struct CellContact {
  ToolSum sum;
  Vec3 moment;       // sum of each cell's part of the tool's volume times its centroid, m
  Vec3 section;      // of each cell's section times its plane's normal, 1/m
  double depth = 0;  // greatest, m

  VPM_HD void add(const ToolSum& part, Vec3 centroid) {
    sum.add(part);
    moment += part.volume.real() * centroid;
  }
  // Notes a sphere of the tool, by how far its centre is from the surface.
  VPM_HD void note_depth(const SurfaceSample& at_center, double radius) {
    if (!at_center.known) return;
    const double reach = radius - at_center.distance;
    depth = reach > depth ? reach : depth;
  }
};

}  // namespace vpm
