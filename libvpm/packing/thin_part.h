// Bounds on the room where obstacles lie close together: in a thin part of the solid, between
// faces, and in the gap between a sphere and the faces around it. They keep plates, needles and the
// shell around the ball in a ball from being cut into cells as small as they are thin.
#pragma once

#include "libvpm/model/sphere.h"
#include "libvpm/packing/solid_distance.h"

namespace vpm {

struct ThinPart {
  // Upper bound on spheres centred in the cube; infinite if unknown.
  double bound = HUGE_VAL;
  // True if faces in and around the cube turn from one another by more than 60 degrees. Otherwise
  // no cube inside it can hold a thin part.
  bool faces_meet = true;
};

// Returns the bound for the cube with this centre and half edge, in the unit frame. If all
// triangles in and around the cube lie between two planes, and beyond both is outside, then points
// inside are nearer to the mesh than half the planes' distance. Looks at a few dozen triangles at
// most.
ThinPart thin_part(const SolidDistance& solid, Vec3 center, double half_edge);

// Returns an upper bound on spheres centred in the cube with this centre and half edge that overlap
// neither `sphere` nor the mesh, in the unit frame; infinite if unknown or above `below`. If a
// point in the cube is inside and the ray from the sphere's centre through it leaves the solid
// before it leaves the cube's surroundings, then the distances to sphere and mesh add up to at most
// the largest distance between the sphere and a triangle there. Looks at a few hundred triangles at
// most.
double gap_bound(const SolidDistance& solid, const Sphere& sphere, Vec3 center, double half_edge,
                 double below);

}  // namespace vpm
