// What a cloud's points resolve, as the tools say it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "libvpm/query/scene_scale.h"

namespace vpm::tools {

// "scene" of reports: formats/schemas. Metres; no largest radius for a plane.
nlohmann::json scene_report(const SceneScale& scale);

// "spheres from 0.0013 m (points 0.0019 m apart, noise 0 m) to 0.028 m (curvature 3.3 1/m)", or "to
// any size (flat)"
std::string words_of(const SceneScale& scale);

}  // namespace vpm::tools
