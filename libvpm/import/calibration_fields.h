// Looks into the objects of a calibration file.
#pragma once

#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>

#include "libvpm/file/text.h"

namespace vpm {

// Finds values of an object by their keys, which programs write with and without capitals and
// underscores. All keys asked for are in lower case and without underscores.
class Fields {
 public:
  struct Field {
    std::string key;  // as it is written
    const nlohmann::json* value;
  };
  using Keys = std::initializer_list<std::string>;

  // The object must outlive this.
  explicit Fields(const nlohmann::json& object) {
    for (const auto& [key, value] : object.items()) {
      std::string plain = file::in_lower_case(key);
      std::erase(plain, '_');
      fields_.emplace(std::move(plain), Field{key, &value});
    }
  }

  // Returns the first of the keys that is there; null if none is.
  const Field* find(const Keys& keys) const {
    for (const std::string& key : keys)
      if (const auto found = fields_.find(key); found != fields_.end()) return &found->second;
    return nullptr;
  }

  // Returns the first of the keys that has a number.
  std::optional<double> number(const Keys& keys) const {
    for (const std::string& key : keys) {
      const Field* const field = find({key});
      if (field && field->value->is_number()) return field->value->get<double>();
    }
    return std::nullopt;
  }

 private:
  std::map<std::string, Field> fields_;
};

}  // namespace vpm
