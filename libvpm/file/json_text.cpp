#include "libvpm/file/json_text.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm::file {

using nlohmann::json;

json::parser_callback_t refusing_doubt() {
  constexpr int kDeepest = 32;  // values are copied recursively and could fill the stack
  std::vector<std::set<std::string>> keys;  // those so far of the objects that are open
  return [keys](int depth, json::parse_event_t event, const json& parsed) mutable {
    if (depth > kDeepest) refuse("nested too deeply");
    if (event == json::parse_event_t::object_start) keys.emplace_back();
    if (event == json::parse_event_t::object_end) keys.pop_back();
    if (event == json::parse_event_t::key &&
        !keys.back().insert(parsed.get_ref<const std::string&>()).second) {
      refuse("ambiguous: it gives \"" + shown(parsed.get_ref<const std::string&>()) + "\" twice",
             {}, "leave one of them out");
    }
    return true;
  };
}

json parse_json(std::string_view text) {
  try {
    return json::parse(text, refusing_doubt());
  } catch (const json::parse_error& fault) {
    const auto at = static_cast<std::ptrdiff_t>(std::min(fault.byte, text.size()));
    refuse("not JSON: it cannot be read from line " +
           std::to_string(1 + std::count(text.begin(), text.begin() + at, '\n')) + " on");
  } catch (const json::out_of_range&) {
    refuse("not readable: one of its numbers is beyond what a double holds");
  }
}

}  // namespace vpm::file
