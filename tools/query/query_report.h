// Lines of results and statistics of vpm-query.
#pragma once

#include <vpm/level_query.h>

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/common/program.h"

namespace vpm::tools {

// Time and frame of a step through recorded frames.
struct StepOfReplay {
  double time = 0;    // s since the start of the path
  std::string frame;  // name of the file; "" before the first frame
};

// What a line says of the pose that was asked.
struct AskedPose {
  Pose pose;
  std::string id;            // JSON, as it was given with the pose; empty without one
  std::vector<Pose> solids;  // of each --solid; none: where the options say
};

nlohmann::ordered_json as_json(Vec3 v);
// Adds volume, what is seen, force and torque, which lines tell alike of a tool and of each link.
void add_measures(nlohmann::ordered_json& line, const Result& result);

// Returns one line of results (formats/schemas/query-result.json). Nothing in it depends on the
// device or the clock, unless a deadline chose the level. `level_reason` is left out if
// no option chose the level; `tool` is the tool's index among several, and `id` that of the pose.
nlohmann::ordered_json result_line(std::size_t pose_index, const std::string& id,
                                   const Result& result, std::uint32_t level, Measure measure,
                                   LevelReason level_reason,
                                   const std::optional<StepOfReplay>& replay,
                                   std::optional<std::size_t> tool = std::nullopt);

// Returns the line of a pose of which only collisions are told.
nlohmann::ordered_json collision_line(std::size_t pose_index, const std::string& id,
                                      const char* collides, std::uint32_t level, Measure measure,
                                      LevelReason level_reason);

// Returns the timings of a run (formats/schemas/query-stats.json), and with a deadline the fraction
// of the queries that kept it. Times of poses and of the scene's preparation are in seconds.
nlohmann::json query_stats(std::vector<double> seconds_per_pose, double prepare_seconds,
                           std::optional<double> deadline_us);

}  // namespace vpm::tools
