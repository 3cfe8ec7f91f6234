#include "tools/query/query_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace vpm::tools {

namespace {

// Returns the value of `level_reason` in formats/schemas/query-result.json.
const char* text_of(LevelReason reason) {
  switch (reason) {
    case LevelReason::none:
      break;
    case LevelReason::max_error:
      return "max-error";
    case LevelReason::scene:
      return "scene";
    case LevelReason::deadline:
      return "deadline";
    case LevelReason::deadline_over_max_error:
      return "deadline over max-error";
    case LevelReason::deadline_over_scene:
      return "deadline over scene";
    case LevelReason::deadline_missed:
      return "deadline missed";
  }
  return "";
}

}  // namespace

namespace {

// Begins the line of a pose, and ends it.
nlohmann::ordered_json line_of(std::size_t pose_index, const std::string& id) {
  nlohmann::ordered_json line;
  line["pose"] = pose_index;
  if (!id.empty()) line["id"] = nlohmann::ordered_json::parse(id);
  return line;
}
void add_level(nlohmann::ordered_json& line, std::uint32_t level, Measure measure,
               LevelReason level_reason) {
  line["level"] = level;
  line["measure"] = measure == Measure::paper ? "paper" : "refined";
  if (level_reason != LevelReason::none) line["level_reason"] = text_of(level_reason);
}

}  // namespace

nlohmann::ordered_json collision_line(std::size_t pose_index, const std::string& id,
                                      const char* collides, std::uint32_t level, Measure measure,
                                      LevelReason level_reason) {
  nlohmann::ordered_json line = line_of(pose_index, id);
  add_level(line, level, measure, level_reason);
  line["collides"] = collides;
  return line;
}

nlohmann::ordered_json as_json(Vec3 v) {
  return {v.x, v.y, v.z};
}

void add_measures(nlohmann::ordered_json& line, const Result& r) {
  line["volume"] = r.volume;
  if (r.volume_interval)
    line["volume_interval"] = {r.volume_interval->low, r.volume_interval->high};
  line["volume_fraction"] = r.volume_fraction;
  if (r.visibility) {
    line["seen_free"] = r.visibility->seen_free;
    line["unseen"] = r.visibility->unseen;
    line["out_of_view"] = r.visibility->out_of_view;
  }
  line["force"] = as_json(r.wrench.force);
  line["torque"] = as_json(r.wrench.torque);
}

nlohmann::ordered_json result_line(std::size_t pose_index, const std::string& id, const Result& r,
                                   std::uint32_t level, Measure measure, LevelReason level_reason,
                                   const std::optional<StepOfReplay>& replay,
                                   std::optional<std::size_t> tool) {
  nlohmann::ordered_json line = line_of(pose_index, id);
  if (tool) line["tool"] = *tool;
  if (replay) {
    line["time"] = replay->time;
    line["frame"] = replay->frame;
  }
  add_measures(line, r);
  line["boundary"] = r.boundary;
  line["inside"] = r.inside;
  if (r.points) line["points"] = *r.points;
  if (r.closure) line["closure"] = *r.closure;
  add_level(line, level, measure, level_reason);
  return line;
}

nlohmann::json query_stats(std::vector<double> seconds, double prepare_seconds,
                           std::optional<double> deadline_us) {
  std::sort(seconds.begin(), seconds.end());
  const auto microseconds = [&](double quantile) {
    if (seconds.empty()) return 0.0;
    const double rank = std::ceil(quantile * static_cast<double>(seconds.size()));
    return 1e6 * seconds[static_cast<std::size_t>(std::max(rank - 1, 0.0))];
  };
  nlohmann::json stats{{"poses", seconds.size()},
                       {"prepare_seconds", prepare_seconds},
                       {"query_us",
                        {{"min", microseconds(0)},
                         {"median", microseconds(0.5)},
                         {"p95", microseconds(0.95)},
                         {"p99", microseconds(0.99)},
                         {"max", microseconds(1)}}}};
  if (deadline_us) {
    const auto kept =
        std::upper_bound(seconds.begin(), seconds.end(), 1e-6 * *deadline_us) - seconds.begin();
    stats["deadline"] = {{"us", *deadline_us},
                         {"kept", static_cast<double>(kept) / static_cast<double>(seconds.size())}};
  }
  return stats;
}

}  // namespace vpm::tools
