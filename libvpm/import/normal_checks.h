// Judges the normals that other programs gave to points.
#pragma once

#include <string>

#include "libvpm/cloud/cloud.h"
#include "libvpm/import/point_files.h"
#include "libvpm/import/remark.h"

namespace vpm {

// Returns the median of the radii of the cloud's disks, m.
double median_radius(const Cloud& cloud);

// Returns a warning if normals lie off the surfaces that the points form, or else one if they
// contradict those of the points about them. Throws Error(refused), naming `name`, if so many do
// that volumes would be wrong.
Remarks improbable_normals(const Cloud& cloud, const std::string& name);

// True if points with a viewpoint stand in the world's frame, as some programs write them: nearly
// all normals face the viewpoint as a point among them, and nearly none the origin, where the
// sensor would be in the sensor's frame.
bool are_in_world(const PointSet& points, bool are_flipped);

// Returns a warning if nearly all normals face away from the origin, of those points that nothing
// hides from it. Judges points only where the sensor was at the origin, which a file with a
// viewpoint says, or may have been there, where all points lie before a camera at the origin.
Remarks facing_away(const PointSet& points, bool are_flipped);

}  // namespace vpm
