// Bound on the room in a thin part of the solid, whose faces lie close together. It keeps plates
// and needles from being cut into cells as small as they are thin.
#pragma once

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

}  // namespace vpm
