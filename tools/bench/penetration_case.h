// A tool moved along +z into a scene, with the truth at every pose.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "libvpm/model/tool_model.h"
#include "libvpm/synthetic/surface.h"
#include "libvpm/synthetic/truth.h"

namespace vpm::bench {

// Returns a solid of about 0.2 m: cube, tetrahedron, octahedron, torus or twisted-torus. Throws
// Error(invalid_argument) for other names.
Solid make_shape(const std::string& name);

// Packs the solid with as many spheres as the largest level has, and makes its tool model.
ToolModel make_tool(const Solid& solid, const std::vector<std::uint32_t>& levels);

// A packed solid with its exact truth and sample places inside of it.
struct PackedSolid {
  synthetic::TrueSolid solid;
  ToolModel model;
  std::vector<Vec3> places;

  // Returns a subset of the places that resolves errors of a per cent.
  std::span<const Vec3> few_places() const {
    return std::span(places).first(std::min(kFewPlaces, places.size()));
  }
  static constexpr std::size_t kFewPlaces = 8192;
};
// Number of places that resolves a hundredth of a per cent of the tool, a twentieth of the smallest
// bound.
inline constexpr std::size_t kCountedPlaces = 524288;
PackedSolid make_packed(const std::string& shape, const std::vector<std::uint32_t>& levels,
                        std::size_t places = kCountedPlaces);

// Returns a rotation whose axis is none of any solid or scene.
Rotation turned();

// Returns `poses` >= 3 poses from just clear of the surface to kDeepest of the tool's height behind
// the first contact. At least the first two are clear.
inline constexpr double kDeepest = 0.8;
inline constexpr double kClear = 0.05;  // clearance of the first pose, in the tool's height
std::vector<Pose> make_path(const synthetic::TrueSolid& tool, const Rotation& rotation,
                            const synthetic::Surface& surface, int poses);

// Returns poses from the first contact until kFullest of the tool's volume is inside, or until
// kDeepest if that never happens (a thin plate). The tool's origin keeps its distance from the
// optical axis.
inline constexpr double kFullest = 0.6;
std::vector<Pose> make_sweep(const synthetic::TrueSolid& tool, const Pose& start,
                             const synthetic::Surface& surface, int poses);

std::vector<synthetic::Penetration> truth_along(const synthetic::TrueSolid& tool,
                                                const std::vector<Pose>& path,
                                                const synthetic::Surface& surface);

}  // namespace vpm::bench
