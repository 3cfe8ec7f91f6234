// Named scene: a surface facing the camera; motions along +z touch it first at (0, 0, 1).
#pragma once

#include <string>
#include <vector>

#include "libvpm/synthetic/render.h"

namespace vpm::synthetic {

struct Scene {
  std::string name;
  SurfacePtr surface;
  Camera camera;
};

// Returns a scene by name:
// wall           the plane z = 1
// inverted-ball  everything outside a ball of radius 0.3 m whose deepest point is (0, 0, 1)
// tilted-wall    a plane 30 degrees off the optical axis
// ball           a ball of radius 0.25 m whose top is (0, 0, 1)
// groove         a V of 90 degrees, 0.15 m deep, in the wall
// step           the wall, 0.05 m nearer left of x = -0.03 m
// plate          a plate 4 mm thick and 0.4 m wide, half a metre before a wall
// block          a free-standing cube of 0.2 m before a wall
// Throws Error(invalid_argument), listing the scenes, for any other name.
Scene make_scene(const std::string& name);
const std::vector<std::string>& scene_names();

}  // namespace vpm::synthetic
