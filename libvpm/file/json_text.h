// Reads JSON that people and programs write.
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace vpm::file {

// Returns a callback for one call of nlohmann::json::parse. It throws Error(refused), whose problem
// follows "it is", where an object has a key twice, of which a parser would take one in silence,
// and where values are nested too deeply.
nlohmann::json::parser_callback_t refusing_doubt();

// Returns the value of the text. Throws as refusing_doubt(), and for a text that is not JSON, with
// the line: "not JSON: …".
nlohmann::json parse_json(std::string_view text);

}  // namespace vpm::file
