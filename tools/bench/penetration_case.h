// A tool moved along +z into a scene, with the truth at every pose.
#pragma once

#include <string>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "libvpm/synthetic/scenes.h"
#include "libvpm/synthetic/truth.h"

namespace vpm::bench {

// Solids of about 0.2 m: cube, tetrahedron, octahedron, torus. Throws Error(usage) for others.
Solid make_shape(const std::string& name);

// Packed with `spheres` spheres, one level.
ToolModel make_tool(const Solid& solid, std::size_t spheres);

// From just clear of the surface to kDeepest of the tool's height behind the first contact; the
// first two poses or more are clear. `poses` >= 3.
inline constexpr double kDeepest = 0.8;
inline constexpr double kClear = 0.05;  // of the tool's height, before the contact
std::vector<Pose> make_path(const synthetic::TrueSolid& tool, const Rotation& rotation,
                            const synthetic::Surface& surface, int poses);

std::vector<synthetic::Penetration> truth_along(const synthetic::TrueSolid& tool,
                                                const std::vector<Pose>& path,
                                                const synthetic::Surface& surface);

}  // namespace vpm::bench
