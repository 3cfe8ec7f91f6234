#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/validation.h"

namespace vpm::tools {

// Returns the reason as the report writes it, e.g. "numerical_floor".
const char* name_of(StopReason reason);

// Returns the sum of the spheres' volumes, m^3.
double volume_of(const std::vector<Sphere>& spheres);

// Returns the content of --report (formats/schemas/pack-report.json); metres, m^3.
nlohmann::json pack_report(const CheckedSolid& checked, const PackResult& result,
                           const Certificate& certificate,
                           const std::optional<Validation>& validation, double seconds);

}  // namespace vpm::tools
