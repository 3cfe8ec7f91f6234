// Joins clouds.
#pragma once

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/vec3.h"

namespace vpm {

// Adds the points of a cloud to another, whose origin stays; what belongs to a sensor is left out.
inline void append(const Cloud& part, Cloud& whole) {
  const Vec3 offset = part.origin - whole.origin;
  for (const Vec3f& place : part.positions)
    whole.positions.push_back(narrow(widen(place) + offset));
  whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
  whole.radii.insert(whole.radii.end(), part.radii.begin(), part.radii.end());
}

}  // namespace vpm
