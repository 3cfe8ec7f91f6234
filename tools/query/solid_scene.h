// Solids of the scene: those of --solid, and what each body gives.
#pragma once

#include <vpm/level_query.h>
#include <vpm/scene.h>
#include <vpm/tool.h>

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "tools/common/program.h"
#include "tools/common/solid_argument.h"

namespace vpm::tools {

// Reads the solids, models or meshes, and prepares them. Throws Error(refused) also for a model
// that keeps no surface.
std::vector<Body> read_solids(const Program& program, const std::vector<std::string>& texts);

// Throws Error(refused), naming the file, for a tool that keeps no surface, which solids need.
void check_surfaces(std::span<const Tool> tools, const std::vector<std::string>& names);

// Says that there are poses of `given` solids, but another number of --solid.
std::string misfit_of_solids(std::size_t given, std::size_t solids);
// Throws Error(refused), naming the file, if a path moves solids, but another number.
void check_moving_solids(const std::string& file, std::size_t moving, std::size_t solids);
inline constexpr const char* kSolidsAdvice = "give one for each, or leave \"solids\" out";

// Returns the list of `bodies` in a line of results.
nlohmann::ordered_json bodies_of(const std::vector<Result>& parts);

}  // namespace vpm::tools
