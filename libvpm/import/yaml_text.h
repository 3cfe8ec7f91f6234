// Reads YAML as JSON values.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace vpm {

// Returns the first document of a YAML text, also as OpenCV writes it (%YAML:1.0, !!opencv-matrix);
// scalars become numbers where they are some, and texts otherwise. Throws Error(refused), naming
// `name`, for what is no YAML, and Error(unavailable) in builds without yaml-cpp.
nlohmann::json parse_yaml(std::string_view text, const std::string& name);

}  // namespace vpm
