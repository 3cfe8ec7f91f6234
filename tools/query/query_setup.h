// Parts of a run that all modes of vpm-query share.
#pragma once

#include <vpm/level_query.h>
#include <vpm/remark.h>
#include <vpm/tool.h>
#include <vpm/view.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "tools/query/arguments.h"
#include "tools/query/collisions.h"

namespace vpm::tools {

// Tools and options that every mode begins with.
struct QuerySetup {
  // Reads the tools. The program and its arguments must outlive this. Throws Error for what the
  // arguments, the tools or the device refuse.
  QuerySetup(const Program& program, const Arguments& arguments);
  // The same for tools that are not those of files, with what they are called.
  QuerySetup(const Program& program, const Arguments& arguments, std::vector<Tool> named,
             const std::vector<std::string>& names);
  QuerySetup(const QuerySetup&) = delete;
  QuerySetup& operator=(const QuerySetup&) = delete;

  const Program& program;
  const Arguments& arguments;
  LevelRequest level;
  std::vector<Tool> tools;  // one per --tool, or link of a robot
  QueryOptions options;
  std::vector<Body> solids;  // one per --solid
  Denoising points;          // how points without a camera are read
  std::optional<View> view;  // empty without --view
  Collisions collisions;     // of all lines of results
};

// Prints what the checks of a setup say.
void say(const Program& program, const Remarks& remarks);

// Notes the level of a tool that the scene's points resolve, if --for-scene chose it.
void note_scale(const Program& program, const LevelQuery& query, std::size_t tool = 0);

// Writes --spheres-out for the pose that the query answered last.
void write_last_spheres(const QuerySetup& setup, const LevelQuery& query, const Pose& last);

// Adds the level of a single tool and the scene's scale, or the level of each tool, to the
// statistics.
void add_levels(nlohmann::json& stats, const LevelQuery& query, std::size_t tools = 1);

// Adds device, threads and options to the statistics of a run. Writes them to --stats and the page
// to --view, if these are given.
void write_stats_and_view(const QuerySetup& setup, nlohmann::json stats);

}  // namespace vpm::tools
