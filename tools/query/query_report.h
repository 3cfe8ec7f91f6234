#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/query/query.h"

namespace vpm::tools {

// One line of results: formats/schemas/query-result.json. Nothing in it depends on the device or
// the clock, unless a deadline chose the level. `level_reason`: how the level was chosen; "" leaves
// it out.
std::string result_line(std::size_t pose_index, const Result& result, const Level& level,
                        Measure measure, const std::string& level_reason);

// Timings of a run: formats/schemas/query-stats.json. With a deadline also the part of the queries
// that kept it.
nlohmann::json query_stats(std::vector<double> seconds_per_pose, double prepare_seconds,
                           std::optional<double> deadline_us);

}  // namespace vpm::tools
