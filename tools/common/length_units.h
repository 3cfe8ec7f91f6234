// Units of length that options and descriptions name.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace vpm::tools {

struct LengthUnit {
  const char* name;
  double metres;
};

inline constexpr std::array<LengthUnit, 6> kLengthUnits{
    {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}}};

// Returns the metres of a unit by its name; nothing for a name that is none.
inline std::optional<double> metres_of_unit(const std::string& name) {
  for (const LengthUnit& unit : kLengthUnits)
    if (name == unit.name) return unit.metres;
  return std::nullopt;
}

inline std::vector<std::string> names_of_units() {
  std::vector<std::string> names;
  for (const LengthUnit& unit : kLengthUnits) names.emplace_back(unit.name);
  return names;
}

}  // namespace vpm::tools
