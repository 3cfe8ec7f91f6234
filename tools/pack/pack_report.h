#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/validation.h"

namespace vpm::tools {

const char* name_of(StopReason reason);

double volume_of(const std::vector<Sphere>& spheres);  // m^3

// What --report says; formats/schemas describe it. Metres, m^3.
nlohmann::json pack_report(const CheckedSolid& checked, const PackResult& result,
                           const Certificate& certificate,
                           const std::optional<Validation>& validation, double seconds);

}  // namespace vpm::tools
