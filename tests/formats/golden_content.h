// Content of the golden files: small, and known from analysis.
#pragma once

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"

namespace vpm::golden {

Packing cube_packing();               // a cube of 0.2 m with the 8 spheres of its octants
ToolModel cube_model();               // cube_packing with levels of 4 and 8 spheres
ToolModel calibrated_cube_model();    // the same with a calibration
ToolModel cube_model_with_faces();    // cube_model with shapes of the octants' samples
ToolModel cube_model_with_surface();  // cube_model with the cube's triangles
Cloud wall_cloud();       // a wall at 1 m seen by a camera of 4 x 3 pixels, one of them blind
Cloud scattered_cloud();  // three points without a sensor, far from the origin

}  // namespace vpm::golden
