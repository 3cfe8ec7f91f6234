// Writes all of a file's content as JSON, the form of formats/golden/v1/*.json.
#pragma once

#include <nlohmann/json.hpp>

#include "libvpm/cloud/cloud.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"

namespace vpm::golden {

nlohmann::json dump(const Packing& packing);
nlohmann::json dump(const ToolModel& model);
nlohmann::json dump(const Cloud& cloud);

}  // namespace vpm::golden
