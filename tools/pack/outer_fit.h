// Spheres that hold a solid, as --outer finds and reports them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/packing/outer_cover.h"
#include "tools/pack/arguments.h"

namespace vpm::tools {

struct OuterFit {
  std::vector<Sphere> spheres;  // without --inflate
  CoverCertificate certificate;
};

// Returns `count` spheres that hold the solid. Throws Error(refused), naming `name`, if that cannot
// be proven.
OuterFit outer_fit(const std::string& name, const CheckedSolid& checked, std::size_t count,
                   const Program& program);

// Returns how the spheres, with --inflate, fit the solid, under the names that others use:
// fractions of its volume, and m.
nlohmann::json quality_of(const CheckedSolid& checked, const std::vector<Sphere>& spheres);

}  // namespace vpm::tools
