// Short ways into the JSON of glTF files, which may hold anything.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace vpm {

// Returns the member, empty where there is none or it is of another kind.
inline const nlohmann::json& member(const nlohmann::json& object, const char* key) {
  static const nlohmann::json none;
  if (!object.is_object()) return none;
  const auto found = object.find(key);
  return found != object.end() ? *found : none;
}

// Returns the element that an index of the file names, empty where there is none.
inline const nlohmann::json& element(const nlohmann::json& list, const nlohmann::json& index) {
  static const nlohmann::json none;
  if (!list.is_array() || !index.is_number_unsigned()) return none;
  const auto at = index.get<std::uint64_t>();
  return at < list.size() ? list[at] : none;
}

inline std::string text_of(const nlohmann::json& value) {
  return value.is_string() ? value.get<std::string>() : "";
}

// Returns the number, 0 where there is none.
inline std::uint64_t count_of(const nlohmann::json& value) {
  return value.is_number_unsigned() ? value.get<std::uint64_t>() : 0;
}

}  // namespace vpm
