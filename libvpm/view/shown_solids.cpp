#include "libvpm/view/shown_solids.h"

#include <algorithm>
#include <array>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/solid/placed_solid.h"

namespace vpm::view {
namespace {

constexpr std::array<const char*, 4> kSolidColors{"#7a8fb0", "#8fa37a", "#a3897a", "#9a8aa8"};
constexpr double kOpacity = 0.45;  // the tool shows through

// Returns the surface in the mesh's frame.
Solid mesh_of(const SolidSurface& surface) {
  Solid mesh{surface.tree().vertices(), surface.tree().triangles()};
  for (Vec3& vertex : mesh.vertices) vertex += surface.center_of_mass();
  return mesh;
}

}  // namespace

void ShownSolids::add(const std::string& name, const Body& body) {
  solids_.push_back({shown_name(name), body});
}

std::vector<std::string> ShownSolids::names() const {
  std::vector<std::string> names;
  for (const Named& solid : solids_) names.push_back(solid.name);
  return names;
}

void ShownSolids::add_to(Page& page, const std::vector<std::vector<Pose>>& poses) const {
  for (const auto& step : poses) {
    if (!step.empty() && step.size() != solids_.size())
      throw Error(ErrorKind::invalid_argument, std::to_string(solids_.size()) +
                                                   " solids are shown, but a pose moves " +
                                                   std::to_string(step.size()));
  }
  const bool moves = std::ranges::any_of(poses, [](const auto& step) { return !step.empty(); });
  for (std::size_t k = 0; k < solids_.size(); ++k) {
    const auto& [name, body] = solids_[k];
    const auto& [surface, to_world, place, model] = *HandleAccess::solid_of(body);
    std::vector<Pose> path;
    for (const auto& step : poses) path.push_back(step.empty() ? to_world : step[k]);
    path.resize(moves ? path.size() : 1, to_world);
    const std::size_t number =
        page.add_body(name, surface->center_of_mass(), surface->reach(), path, false);
    const Solid mesh = mesh_of(*surface);
    page.add_mesh({.name = "solid " + name,
                   .color = kSolidColors[k % kSolidColors.size()],
                   .solid = &mesh,
                   .body = number,
                   .opacity = kOpacity});
  }
}

}  // namespace vpm::view
