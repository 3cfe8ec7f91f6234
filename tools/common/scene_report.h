// Reports of the sizes that a cloud's points resolve.
#pragma once

#include <vpm/level_query.h>

#include <nlohmann/json.hpp>
#include <string>

namespace vpm::tools {

// Returns the field "scene" of the reports (formats/schemas), lengths in metres. A plane has no
// largest radius.
nlohmann::json scene_report(const SceneScale& scale);

// Returns for example "spheres from 0.0013 m (points 0.0019 m apart, noise 0 m) to 0.028 m
// (curvature 3.3 1/m)"; a plane gives "to any size (flat)".
std::string words_of(const SceneScale& scale);

}  // namespace vpm::tools
