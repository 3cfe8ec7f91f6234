// How much room a part of the solid has whose faces lie close together, seen from afar: what keeps
// plates and needles from being cut into cells as small as they are thin.
#pragma once

#include "libvpm/packing/solid_distance.h"

namespace vpm {

struct ThinPart {
  // No larger sphere is centred in the cube; infinite where this does not tell.
  double bound = HUGE_VAL;
  // Whether faces in and around the cube turn from one another by more than 60 degrees. Where none
  // do, no cube within can hold a thin part.
  bool faces_meet = true;
};

// Of the cube with this centre and half edge, in the unit frame. All triangles in and around it lie
// between two planes, and beyond both is outside: then what is inside is nearer to the mesh than
// half of the planes' distance. Looks at a few dozen triangles at most.
ThinPart thin_part(const SolidDistance& solid, Vec3 center, double half_edge);

}  // namespace vpm
