#include "tools/query/solid_scene.h"

#include <vpm/error.h>
#include <vpm/solid.h>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/model/tool_model.h"

namespace vpm::tools {
std::vector<Body> read_solids(const Program& program, const std::vector<std::string>& texts) {
  std::vector<Body> solids;
  for (const std::string& text : texts) {
    const auto [name, at] = solid_from_text(text, "--solid");
    solids.emplace_back(solid_of_file(program, name), at);
  }
  return solids;
}

void check_surfaces(std::span<const Tool> tools, const std::vector<std::string>& names) {
  for (std::size_t k = 0; k < tools.size(); ++k)
    if (HandleAccess::held(tools[k]).surface.triangles.empty())
      refuse("the tool model keeps no surface, by which solids are measured", names[k],
             "make it again by vpm-graph, without --no-surface");
}

std::string misfit_of_solids(std::size_t given, std::size_t solids) {
  return "\"solids\" has " + std::to_string(given) + (given == 1 ? " pose" : " poses") +
         ", but --solid is given " + std::to_string(solids) + (solids == 1 ? " time" : " times");
}

void check_moving_solids(const std::string& file, std::size_t moving, std::size_t solids) {
  if (moving > 0 && moving != solids) refuse(misfit_of_solids(moving, solids), file, kSolidsAdvice);
}

nlohmann::ordered_json bodies_of(const std::vector<Result>& parts) {
  nlohmann::ordered_json bodies = nlohmann::ordered_json::array();
  for (const Result& part : parts) {
    const auto& [force, torque] = part.wrench;
    bodies.push_back({{"body", bodies.size()},
                      {"volume", part.volume},
                      {"force", {force.x, force.y, force.z}},
                      {"torque", {torque.x, torque.y, torque.z}}});
  }
  return bodies;
}

}  // namespace vpm::tools
