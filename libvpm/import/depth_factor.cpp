#include "libvpm/import/depth_factor.h"

#include <cmath>

#include "libvpm/import/depth_files.h"

namespace vpm {
namespace {

// Returns the factor of a number whose key says only that it is some scale of depths. A metre has
// at least a hundred units in files of integers; in BOP's, a unit is 0.01 mm or more.
DepthFactor factor_of_scale(const std::string& told, double value) {
  constexpr double kFewestPerMetre = 100, kSmallestInMillimetres = 0.01;
  if (value >= kFewestPerMetre) return {told, "", value};
  if (value >= kSmallestInMillimetres) return {told, "millimetres per unit", 1000 / value};
  return {told, "metres per unit", 1 / value};
}

}  // namespace

std::optional<DepthFactor> depth_factor_in(const Fields& fields) {
  constexpr double kFewestOfScale =
      100;  // a smaller "scale" is that of a scene or of an image's size
  for (const char* key : {"rgbd.depthmapfactor", "depthmapfactor", "depthfactor", "depthscale",
                          "pngdepthscale", "integerdepthscale", "depthunitscalefactor", "scale"}) {
    const std::string name = key;
    const Fields::Field* const field = fields.find({name});
    const double value = fields.number({name}).value_or(0);
    if (!(value > 0) || (name == "scale" && value < kFewestOfScale)) continue;
    const std::string told = file::shown(field->key, 40) + " " + number_text(value);
    // ORB-SLAM divides by its factor.
    const bool divides = name.ends_with("depthmapfactor") || name == "depthfactor";
    const DepthFactor factor =
        divides ? DepthFactor{told, "", value} : factor_of_scale(told, value);
    if (std::isfinite(factor.units_per_metre)) return factor;
  }
  return std::nullopt;
}

Remarks unused_factor(const std::optional<DepthFactor>& factor,
                      const std::optional<double>& units_per_metre) {
  if (!factor) return {};
  const double told = factor->units_per_metre;
  const auto is_told = [&](double value) { return std::abs(value - told) <= 1e-6 * told; };
  if (units_per_metre ? is_told(*units_per_metre) : is_told(1000) || is_told(1)) return {};
  const std::string what = "it tells a depth factor, " + factor->told;
  if (units_per_metre)
    return {{false, what + ", which is not used: " + number_text(*units_per_metre) +
                        " units per metre were given"}};
  const std::string& reading = factor->reading;
  return {{true, what + ", which is not used; " +
                     (reading.empty() ? "" : "if it is in " + reading + ", ") +
                     "give `depth_scale` " + number_text(told)}};
}

}  // namespace vpm
