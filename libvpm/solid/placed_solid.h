// A solid of a scene and where it is.
#pragma once

#include <cstddef>
#include <memory>

#include "libvpm/core/pose.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/solid/solid_surface.h"

namespace vpm {

struct PlacedSolid {
  std::shared_ptr<const SolidSurface> surface;  // with depth
  Pose to_world;                                // maps the solid's mesh to the world
  std::size_t place = 0;                        // in the scene's list of bodies
  std::shared_ptr<const ToolModel> model;       // with its spheres; null for a mesh
};

}  // namespace vpm
