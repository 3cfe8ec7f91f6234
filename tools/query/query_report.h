#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/query/query.h"
#include "tools/common/tool.h"

namespace vpm::tools {

// Where a line belongs in a replay.
struct StepOfReplay {
  double time = 0;    // s since the start of the path
  std::string frame;  // name of the file; "": none yet
};

// One line of JSON. Names of files need not be UTF-8.
std::string to_line(const nlohmann::ordered_json& line);

// One line of results: formats/schemas/query-result.json. Nothing in it depends on the device or
// the clock, unless a deadline chose the level. `level_reason`: how the level was chosen; "" leaves
// it out. `tool`: its place among several.
std::string result_line(std::size_t pose_index, const Result& result, const Level& level,
                        Measure measure, const std::string& level_reason,
                        const std::optional<StepOfReplay>& replay,
                        std::optional<std::size_t> tool = std::nullopt);

// Timings of a run: formats/schemas/query-stats.json. With a deadline also the part of the queries
// that kept it.
nlohmann::json query_stats(std::vector<double> seconds_per_pose, double prepare_seconds,
                           std::optional<double> deadline_us);

// Says that rotations of `what` have been normalised, if that is worth a note.
void note_deviation(const Tool& tool, const std::string& what, double deviation);

}  // namespace vpm::tools
