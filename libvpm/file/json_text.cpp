#include "libvpm/file/json_text.h"

#include <algorithm>

#include "libvpm/core/error.h"

namespace vpm::file {

nlohmann::json parse_json(std::string_view text,
                          const std::function<void(const std::string& key)>& on_key) {
  using nlohmann::json;
  constexpr int kDeepest = 32;  // values are copied recursively and could fill the stack
  const auto look = [&](int depth, json::parse_event_t event, const json& parsed) {
    if (depth > kDeepest) refuse("nested too deeply");
    if (on_key && depth == 1 && event == json::parse_event_t::key)
      on_key(parsed.get_ref<const std::string&>());
    return true;
  };
  try {
    return json::parse(text, look);
  } catch (const json::parse_error& fault) {
    const auto at = static_cast<std::ptrdiff_t>(std::min(fault.byte, text.size()));
    refuse("not JSON: it cannot be read from line " +
           std::to_string(1 + std::count(text.begin(), text.begin() + at, '\n')) + " on");
  } catch (const json::out_of_range&) {
    refuse("not readable: one of its numbers is beyond what a double holds");
  }
}

}  // namespace vpm::file
