#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libvpm/query/query.h"

namespace vpm::tools {

// One line of results: formats/schemas/query-result.schema.json. Nothing in it depends on the
// device or the clock.
std::string result_line(std::size_t pose_index, const Result& result, const Level& level,
                        Measure measure);

// Timings of a run: formats/schemas/query-stats.schema.json.
nlohmann::json query_stats(std::vector<double> seconds_per_pose, double prepare_seconds);

}  // namespace vpm::tools
