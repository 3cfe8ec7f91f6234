// Reads a file of JSON that people write.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace vpm::file {

// Returns the value of the text, and gives the keys of its outermost object to `on_key`, which may
// throw. Throws Error(refused) whose problem follows "it is": "not JSON: …" with the line.
nlohmann::json parse_json(std::string_view text,
                          const std::function<void(const std::string& key)>& on_key = {});

}  // namespace vpm::file
