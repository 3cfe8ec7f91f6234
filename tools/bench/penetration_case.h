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

// Solids of about 0.2 m: cube, tetrahedron, octahedron, torus, twisted-torus. Throws
// Error(invalid_argument) for others.
Solid make_shape(const std::string& name);

// Packed with as many spheres as the largest level has.
ToolModel make_tool(const Solid& solid, const std::vector<std::uint32_t>& levels);

// A packed solid, its truth, and places in it to count.
struct PackedSolid {
  synthetic::TrueSolid solid;
  ToolModel model;
  std::vector<Vec3> places;

  // For errors of parts of a hundred.
  std::span<const Vec3> few_places() const {
    return std::span(places).first(std::min(kFewPlaces, places.size()));
  }
  static constexpr std::size_t kFewPlaces = 8192;
};
// So many resolve a hundredth of a per cent of the tool: a twentieth of the least bound.
inline constexpr std::size_t kCountedPlaces = 524288;
PackedSolid make_packed(const std::string& shape, const std::vector<std::uint32_t>& levels,
                        std::size_t places = kCountedPlaces);

// A rotation along no axis of any solid or scene.
Rotation turned();

// From just clear of the surface to kDeepest of the tool's height behind the first contact; the
// first two poses or more are clear. `poses` >= 3.
inline constexpr double kDeepest = 0.8;
inline constexpr double kClear = 0.05;  // of the tool's height, before the contact
std::vector<Pose> make_path(const synthetic::TrueSolid& tool, const Rotation& rotation,
                            const synthetic::Surface& surface, int poses);

// From the first contact until kFullest of the tool's volume is inside, or to kDeepest where that
// never comes (a thin plate). The tool's origin keeps its place aside of the optical axis.
inline constexpr double kFullest = 0.6;
std::vector<Pose> make_sweep(const synthetic::TrueSolid& tool, const Pose& start,
                             const synthetic::Surface& surface, int poses);

std::vector<synthetic::Penetration> truth_along(const synthetic::TrueSolid& tool,
                                                const std::vector<Pose>& path,
                                                const synthetic::Surface& surface);

}  // namespace vpm::bench
